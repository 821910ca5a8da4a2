"""What smoothing could not mend, moved as its surroundings move.

About the faults the displacement from the affine copy of the mesh at rest is no longer that which
the surface asks for, but the harmonic one that joins the displacement around. With ever more rings
the mesh comes nearer to that copy, which is about as sound as the mesh at rest.
"""

from scipy import sparse
from scipy.sparse.linalg import splu

from worker.arrays import Points
from worker.surface_mesh import SurfaceMesh
from worker.tracking.faults import at_fault
from worker.tracking.patch import Patch

_RINGS = (1, 2, 3, 4, 6, 8, 11, 15)
"""About the triangles at fault, until there are none."""

_RIDGE = 1e-9
"""Beside an edge's weight of one: a part of the mesh with nothing around goes where its copy is."""


def interpolated(mesh: SurfaceMesh, copy_mm: Points, whole: Patch) -> SurfaceMesh:
    """The mesh with as few triangles turned over, folded or passing through others as can be had.

    copy_mm: The affine copy of the mesh at rest, (n, 3). whole: all of the mesh.
    """
    faulty = at_fault(mesh, whole.pairs)
    best, fewest = mesh, faulty.sum()
    if not fewest:
        return mesh
    laplacian = (sparse.diags(whole.degrees + _RIDGE) - whole.neighbours).tocsr()
    for rings in _RINGS:
        inside = whole.around(mesh.faces[faulty].ravel(), rings)
        displaced = mesh.vertices_mm - copy_mm
        around = -laplacian[inside][:, ~inside] @ displaced[~inside]
        displaced[inside] = splu(laplacian[inside][:, inside].tocsc()).solve(around)
        moved = SurfaceMesh(copy_mm + displaced, mesh.faces)
        left = at_fault(moved, whole.pairs)
        if left.sum() < fewest:
            best, fewest = moved, left.sum()
        if not fewest:
            break
        faulty |= left
    return best
