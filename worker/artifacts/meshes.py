"""A surface as a file: STL, OBJ, PLY, VTP or GLB. The bytes depend on what is passed in only.

STL, OBJ, PLY and VTP hold millimetres in the study's own axes and say so inside the file. glTF is
by its standard in metres with Y up, so a GLB holds the same millimetre vertices under a node whose
matrix turns them into metres with the head up (+Y), the patient facing +Z.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import trimesh
from trimesh.exchange.gltf import export_glb
from trimesh.exchange.ply import export_ply

from schemas.vocabulary import Axes, MeshFormat
from worker.arrays import Scalars
from worker.surface_mesh import SurfaceMesh

_STL_HEADER_BYTES = 80
_STL_FACET = np.dtype(
    [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")],
)
_OBJ_DECIMALS = 6

MEDIA_TYPES = {
    MeshFormat.STL: "model/stl",
    MeshFormat.OBJ: "model/obj",
    MeshFormat.PLY: "application/ply",
    MeshFormat.VTP: "application/vnd.vtk.polydata+xml",
    MeshFormat.GLB: "model/gltf-binary",
}

_TO_GLTF_M = {
    # x left, y back, z up -> X left, Y up, Z front
    Axes.LPS: np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]]) * 1e-3,
    # x right, y front, z up -> X left, Y up, Z front
    Axes.RAS: np.array([[-1, 0, 0], [0, 0, 1], [0, 1, 0]]) * 1e-3,
}


@dataclass(frozen=True, eq=False)
class _Content:
    mesh: SurfaceMesh
    name: str
    axes: Axes
    at_vertices: Mapping[str, Scalars]


def write_mesh(
    path: Path,
    mesh: SurfaceMesh,
    name: str,
    axes: Axes,
    at_vertices: Mapping[str, Scalars] | None = None,
) -> None:
    """Write `mesh` to `path`; the file name's ending is the format.

    Args:
        path: Its suffix is one of `MeshFormat`.
        mesh: Vertices in mm, patient axes.
        name: What the surface is called inside the file, e.g. `ED_lv_endo`.
        axes: The axes that the vertices are in.
        at_vertices: By name, one number for each vertex, (n,), written as float32: a vertex
            property of a PLY, a point data array of a VTP. The other formats have no place for it.
    """
    write = _WRITERS[MeshFormat(path.suffix.removeprefix("."))]
    write(path, _Content(mesh, name, axes, at_vertices or {}))


def _stl(path: Path, content: _Content) -> None:
    """Binary STL. The header must not start with 'solid', which means an ASCII file."""
    header = f"neuralmri binary STL, units=mm axes={content.axes} name={content.name}".encode(
        "ascii"
    )
    facets = np.zeros(len(content.mesh.faces), dtype=_STL_FACET)
    facets["corners"] = content.mesh.triangles_mm
    # Normals follow the corners as stored, so that a reader who recomputes them agrees.
    corners = facets["corners"].astype(np.float64)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    facets["normal"] = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0)
    count = np.array(len(facets), dtype="<u4")
    header = header[:_STL_HEADER_BYTES].ljust(_STL_HEADER_BYTES)
    path.write_bytes(header + count.tobytes() + facets.tobytes())


def _obj(path: Path, content: _Content) -> None:
    # Adding zero turns a rounded -0.0 into 0.0: one number, one spelling.
    vertices_mm = np.round(content.mesh.vertices_mm, _OBJ_DECIMALS) + 0.0
    lines = ["# neuralmri", "# units: mm", f"# axes: {content.axes}", f"o {content.name}"]
    lines += [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in vertices_mm.tolist()]
    lines += [f"f {a} {b} {c}" for a, b, c in (content.mesh.faces + 1).tolist()]
    path.write_text("\n".join(lines) + "\n", encoding="ascii", newline="\n")


def _ply(path: Path, content: _Content) -> None:
    """Binary PLY, with the comments that the library leaves no way to pass."""
    surface = _as_trimesh(content.mesh)
    for name, values in content.at_vertices.items():
        surface.vertex_attributes[name] = values.astype("<f4")
    exported: bytes = export_ply(surface)
    magic, form, rest = exported.split(b"\n", 2)
    comment = f"comment neuralmri units=mm axes={content.axes} name={content.name}".encode("ascii")
    path.write_bytes(b"\n".join([magic, form, comment, rest]))


def _vtp(path: Path, content: _Content) -> None:
    # Here, since VTK takes half a second to load, and no other format needs it.
    import pyvista

    surface = pyvista.PolyData.from_regular_faces(content.mesh.vertices_mm, content.mesh.faces)
    surface.field_data["units"] = ["mm"]
    surface.field_data["axes"] = [str(content.axes)]
    surface.field_data["name"] = [content.name]
    for name, values in content.at_vertices.items():
        surface.point_data[name] = values.astype(np.float32)
    surface.save(path)


def _glb(path: Path, content: _Content) -> None:
    to_gltf = np.eye(4)
    to_gltf[:3, :3] = _TO_GLTF_M[content.axes]
    scene = trimesh.Scene()
    scene.add_geometry(
        _as_trimesh(content.mesh),
        node_name=content.name,
        geom_name=content.name,
        transform=to_gltf,
    )
    path.write_bytes(export_glb(scene))


def _as_trimesh(mesh: SurfaceMesh) -> trimesh.Trimesh:
    """The same vertices and faces in the same order, nothing merged."""
    return trimesh.Trimesh(mesh.vertices_mm, mesh.faces, process=False)


_WRITERS: dict[MeshFormat, Callable[[Path, _Content], None]] = {
    MeshFormat.STL: _stl,
    MeshFormat.OBJ: _obj,
    MeshFormat.PLY: _ply,
    MeshFormat.VTP: _vtp,
    MeshFormat.GLB: _glb,
}
