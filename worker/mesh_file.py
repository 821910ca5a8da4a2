"""Reading a surface from a mesh file, whatever it is called."""

import sys
from io import BytesIO
from pathlib import Path

import numpy as np
import trimesh

from intake.mesh_faults import refuse_triangles, unreadable_mesh
from intake.mesh_header import check_mesh_file
from schemas.problem import InputError, ProblemType
from worker.evaluation.size import signed_volume_ml
from worker.evaluation.topology import is_watertight
from worker.surface_mesh import SurfaceMesh

_BROKEN = (
    ArithmeticError,
    AttributeError,
    EOFError,
    LookupError,
    NameError,
    TypeError,
    ValueError,
)
"""What trimesh's readers raise on bytes that are not what the header says."""

_FARTHEST_MM = 1e9
"""Products of coordinates below this are far from overflowing."""


def read_surface(
    path: Path, name: str | None = None, max_triangles: int = sys.maxsize
) -> SurfaceMesh:
    """The surface in an STL, OBJ or PLY file, told by its content; lengths taken as mm.

    Doubled vertices are merged, polygons divided, and a closed surface that faces inward is turned
    outward. Nothing beside the file is looked at, materials that it names included.

    Args:
        path: The file.
        name: What the caller knows it by, for what is raised; its file name when left out.
        max_triangles: How many it may have.

    Raises:
        InputError: `INVALID_REQUEST` at `name` for a file that is missing, of another format,
            broken or without triangles; `TOO_LARGE` (413).
    """
    name = name or path.name
    if not path.is_file():
        raise InputError(
            ProblemType.INVALID_REQUEST, f"there is no file {path}. Remedy: check the path."
        )
    with path.open("rb") as file:
        form = check_mesh_file(file, name, max_triangles)
    try:
        # From bytes, so that trimesh knows no folder to look for materials in.
        content = BytesIO(path.read_bytes())
        # trimesh computes with the file's own normals, which nobody judges and nobody uses.
        with np.errstate(all="ignore"):
            loaded = trimesh.load_mesh(content, form.value, skip_materials=True, process=False)
        _check_values(loaded, name)
        loaded.merge_vertices(merge_tex=True, merge_norm=True)
    except _BROKEN as error:
        raise unreadable_mesh(name, f"cannot be read ({error})", "export it again") from error
    vertices = np.asarray(loaded.vertices, dtype=np.float64)
    faces = np.asarray(loaded.faces, dtype=np.int64)
    # Merging may leave triangles with two corners in one place: no area, and no part of a surface.
    faces = faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)]
    if not len(faces):
        raise unreadable_mesh(
            name, "has no triangles with an area", "export the surface, not points or lines"
        )
    refuse_triangles(name, len(faces), max_triangles)
    mesh = SurfaceMesh(vertices, faces)
    if is_watertight(mesh) and signed_volume_ml(mesh) < 0.0:
        return SurfaceMesh(vertices, faces[:, ::-1])
    return mesh


def _check_values(loaded: trimesh.Trimesh, name: str) -> None:
    """Refuse what trimesh lets pass and could not merge."""
    vertices, faces = np.asarray(loaded.vertices), np.asarray(loaded.faces)
    if not len(faces):
        raise unreadable_mesh(name, "has no triangles", "export the surface, not points or lines")
    if faces.ndim != 2 or faces.shape[1] != 3:
        raise unreadable_mesh(name, "has faces that are no triangles", "triangulate it")
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise unreadable_mesh(name, "has triangles whose corners it lacks", "export it again")
    if not (np.abs(vertices) < _FARTHEST_MM).all():
        raise unreadable_mesh(
            name, "has coordinates that are no numbers, or beyond all bounds", "export it again"
        )
