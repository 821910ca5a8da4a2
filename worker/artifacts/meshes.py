"""A surface as a file: STL, OBJ, PLY, VTP or GLB. The bytes depend on what is passed in only.

STL, OBJ, PLY and VTP hold millimetres in the study's own axes and say so inside the file. glTF is
by its standard in metres with Y up, so a GLB holds the same millimetre vertices under a node whose
matrix turns them into metres with the head up (+Y), the patient facing +Z.
"""

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from jaxtyping import Real

from schemas.problem import InternalError, ProblemType
from schemas.vocabulary import Axes, MeshFormat
from worker.artifacts.mesh_files.content import Content
from worker.artifacts.mesh_files.glb import write_glb
from worker.artifacts.mesh_files.obj import write_obj
from worker.artifacts.mesh_files.ply import write_ply
from worker.artifacts.mesh_files.stl import write_stl
from worker.artifacts.mesh_files.vertex_field import vertex_field
from worker.artifacts.mesh_files.vtp import write_vtp
from worker.surface_mesh import SurfaceMesh

_WRITERS: Mapping[MeshFormat, Callable[[Path, Content], None]] = {
    MeshFormat.STL: write_stl,
    MeshFormat.OBJ: write_obj,
    MeshFormat.PLY: write_ply,
    MeshFormat.VTP: write_vtp,
    MeshFormat.GLB: write_glb,
}


def write_mesh(
    path: Path,
    mesh: SurfaceMesh,
    name: str,
    axes: Axes,
    at_vertices: Mapping[str, Real[np.ndarray, " n"]] | None = None,
    *,
    job_id: str | None = None,
) -> None:
    """Write `mesh` to `path`; the file name's ending is the format.

    Units, axes, name and job id are inside the file: in the header of an STL (80 bytes; a name too
    long for it loses its beginning), in comments of an OBJ or PLY, in field data of a VTP, and in
    the extras of a GLB's asset and node.

    Args:
        path: Its suffix is one of `MeshFormat`.
        mesh: Vertices in mm, patient axes.
        name: What the surface is called inside the file, e.g. `ED_lv_endo`. A GLB has the colour of
            the structure that it ends in.
        axes: The axes that the vertices are in.
        at_vertices: By a name of `worker.artifacts.measured.FIELDS`, one number for each vertex,
            (n,): a vertex property of a PLY, a point data array of a VTP, float32 or for labels
            uint8, with unit and meaning beside it. The other formats have no place for it.
        job_id: Of the job that made the surface; left out where none did.

    Raises:
        InternalError: a vertex or a number at one is not finite, or a field is not in FIELDS, does
            not fit the vertices, or is a label and no whole number.
    """
    if not np.isfinite(mesh.vertices_mm).all():
        raise InternalError(
            ProblemType.INTERNAL, f"{name} has vertices that are no numbers; mesh the field anew."
        )
    fields = [
        vertex_field(key, values, len(mesh.vertices_mm))
        for key, values in (at_vertices or {}).items()
    ]
    write = _WRITERS[MeshFormat(path.suffix.removeprefix("."))]
    write(path, Content(mesh, name, axes, job_id, fields))
