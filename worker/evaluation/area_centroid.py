"""The middle of a surface, whether it is closed or not."""

from worker.arrays import Vector
from worker.evaluation.size import triangle_areas_mm2
from worker.surface_mesh import SurfaceMesh


def area_centroid_mm(mesh: SurfaceMesh) -> Vector:
    """Centroid of the area of a mesh that has some, (3,) mm: dense triangles weigh no more."""
    areas = triangle_areas_mm2(mesh)
    centroid: Vector = areas @ mesh.triangles_mm.mean(axis=1) / areas.sum()
    return centroid
