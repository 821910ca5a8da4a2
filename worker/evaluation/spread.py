"""How far surfaces that should be one are spread about it."""

from collections.abc import Sequence

import igl
import numpy as np

from schemas.problem import InternalError, ProblemType
from worker.arrays import Points, Scalars
from worker.evaluation.distance import nearest_on_surface
from worker.evaluation.surface_normals import vertex_normals
from worker.evaluation.topology import is_watertight
from worker.surface_mesh import SurfaceMesh


def vertex_deviation_mm(mesh: SurfaceMesh, members: Sequence[SurfaceMesh]) -> Scalars:
    """Standard deviation of where surfaces lie along the normal at each vertex of one, (n,) mm.

    The surfaces are `mesh` itself, at zero, and `members`; all in one frame, closed ones outward.
    The sum of squares is divided by the number of members: they are a few of all the surfaces that
    there could be, and one other surface at a distance d tells of a deviation of d / sqrt(2).
    Raises InternalError without members, or for one without faces.
    """
    if not members:
        raise InternalError(
            ProblemType.INTERNAL, "One surface alone has no spread; set `ensemble` to 1 or more."
        )
    normals = vertex_normals(mesh)
    places = [np.zeros(len(normals)), *(_outside_by_mm(mesh, normals, one) for one in members)]
    deviation: Scalars = np.std(places, axis=0, ddof=1)
    return deviation


def _outside_by_mm(mesh: SurfaceMesh, normals: Points, member: SurfaceMesh) -> Scalars:
    """How far a member lies outside of `mesh` at each vertex, negative where it lies inside.

    Of a closed member the exact signed distance (pseudonormals: Baerentzen and Aanaes 2005). Of an
    open one the part along the normal of the way to its nearest point: where it ends earlier at
    the base, the way to its rim tells nothing of the wall.
    """
    if not is_watertight(member):
        nearest, _ = nearest_on_surface(mesh.vertices_mm, member)
        along: Scalars = np.einsum("nd,nd->n", nearest - mesh.vertices_mm, normals)
        return along
    signed, *_ = igl.signed_distance(
        np.ascontiguousarray(mesh.vertices_mm, dtype=np.float64),
        np.ascontiguousarray(member.vertices_mm, dtype=np.float64),
        np.ascontiguousarray(member.faces, dtype=np.int64),
        sign_type=igl.SIGNED_DISTANCE_TYPE_PSEUDONORMAL,
    )
    return -signed
