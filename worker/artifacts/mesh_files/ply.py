"""Binary PLY: vertices with numbers at them, faces, and comments."""

from pathlib import Path

import numpy as np

from worker.artifacts.mesh_files.content import Content

_PROPERTY = {"float32": "float", "uint8": "uchar"}
_FACE = np.dtype([("count", "u1"), ("corners", "<i4", 3)])


def write_ply(path: Path, content: Content) -> None:
    """Vertices in mm, float32; every field a vertex property under its own name."""
    mesh, fields = content.mesh, content.fields
    columns = [(axis, "<f4") for axis in "xyz"]
    columns += [(one.name, one.values.dtype.newbyteorder("<").str) for one in fields]
    vertices = np.zeros(len(mesh.vertices_mm), dtype=columns)
    for index, axis in enumerate("xyz"):
        vertices[axis] = mesh.vertices_mm[:, index]
    for one in fields:
        vertices[one.name] = one.values
    faces = np.zeros(len(mesh.faces), dtype=_FACE)
    faces["count"], faces["corners"] = 3, mesh.faces
    facts = " ".join(f"{key}={value}" for key, value in content.facts().items())
    lines = [
        "ply",
        "format binary_little_endian 1.0",
        f"comment neuralmri {facts}",
        *(f"comment {one.described}" for one in fields),
        f"element vertex {len(vertices)}",
        *(f"property float {axis}" for axis in "xyz"),
        *(f"property {_PROPERTY[one.values.dtype.name]} {one.name}" for one in fields),
        f"element face {len(faces)}",
        "property list uchar int vertex_indices",
        "end_header",
    ]
    header = ("\n".join(lines) + "\n").encode("ascii")
    path.write_bytes(header + vertices.tobytes() + faces.tobytes())
