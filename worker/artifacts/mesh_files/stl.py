"""Binary STL: triangles and an 80-byte header."""

from pathlib import Path

import numpy as np

from worker.artifacts.mesh_files.content import Content

_HEADER_BYTES = 80
_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def write_stl(path: Path, content: Content) -> None:
    """Corners in mm, float32, with the facets' normals."""
    facets = np.zeros(len(content.mesh.faces), dtype=_FACET)
    facets["corners"] = content.mesh.triangles_mm
    # Normals follow the corners as stored, so that a reader who recomputes them agrees.
    corners = facets["corners"].astype(np.float64)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    facets["normal"] = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0)
    count = np.array(len(facets), dtype="<u4")
    path.write_bytes(_header(content) + count.tobytes() + facets.tobytes())


def _header(content: Content) -> bytes:
    """Must not start with 'solid', which means an ASCII file. What does not fit is cut from the
    name, and there from the frame's label: the name ends in the structure.
    """
    facts = content.facts()
    name = facts.pop("name")
    said = " ".join(["neuralmri", *(f"{key}={value}" for key, value in facts.items()), ""])
    room = max(_HEADER_BYTES - len(said), 0)
    header = (said + name[max(len(name) - room, 0) :]).encode("ascii")
    return header[:_HEADER_BYTES].ljust(_HEADER_BYTES)
