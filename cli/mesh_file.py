"""Reading a surface from a file the caller names."""

from pathlib import Path
from typing import TYPE_CHECKING

from schemas.problem import InputError, ProblemType

if TYPE_CHECKING:
    from worker.surface_mesh import SurfaceMesh

_FORMATS = frozenset({".stl", ".obj", ".ply"})

_BROKEN = (ValueError, LookupError, TypeError, AttributeError, EOFError)
"""What trimesh's readers raise on bytes that are not what the suffix says."""


def read_surface(path: Path) -> "SurfaceMesh":
    """The surface in an STL, OBJ or PLY file, its doubled vertices merged; lengths taken as mm.

    A closed surface that faces inward is turned outward. Raises InputError, naming the remedy,
    when the file is missing, of another format, broken or without triangles.
    """
    import numpy as np
    import trimesh

    from worker.evaluation.size import signed_volume_ml
    from worker.evaluation.topology import is_watertight
    from worker.surface_mesh import SurfaceMesh

    if not path.is_file():
        raise _refused(f"There is no file {path}; check the path.")
    if path.suffix.lower() not in _FORMATS:
        raise _refused(f"{path.name} is no STL, OBJ or PLY file; convert it to one of them.")
    try:
        loaded = trimesh.load_mesh(path)
        loaded.merge_vertices(merge_tex=True, merge_norm=True)
    except _BROKEN as error:
        raise _refused(f"{path.name} cannot be read ({error}); export it again.") from error
    vertices = np.asarray(loaded.vertices, dtype=np.float64)
    faces = np.asarray(loaded.faces, dtype=np.int64)
    # Merging may leave triangles with two corners in one place: no area, and no part of a surface.
    faces = faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)]
    if not len(faces):
        raise _refused(f"{path.name} has no triangles; export the surface, not points or lines.")
    if not np.isfinite(vertices).all():
        raise _refused(f"{path.name} has coordinates that are no numbers; export it again.")
    mesh = SurfaceMesh(vertices, faces)
    if is_watertight(mesh) and signed_volume_ml(mesh) < 0.0:
        return SurfaceMesh(vertices, faces[:, ::-1])
    return mesh


def _refused(detail: str) -> InputError:
    return InputError(ProblemType.INVALID_REQUEST, detail)
