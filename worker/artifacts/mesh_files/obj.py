"""Wavefront OBJ: vertices and faces as text, and comments."""

from pathlib import Path

import numpy as np

from worker.artifacts.mesh_files.content import Content
from worker.artifacts.mesh_files.number_lines import number_lines

_DECIMALS = 6


def write_obj(path: Path, content: Content) -> None:
    """Vertices in mm, to the nanometre."""
    # In whole nanometres there is one zero only.
    vertices_nm = np.rint(content.mesh.vertices_mm * 10**_DECIMALS).astype(np.int64)
    lines = ["# neuralmri", *(f"# {key}: {value}" for key, value in content.facts().items())]
    header = "\n".join([*lines, f"o {content.name}", ""]).encode("ascii")
    vertices = number_lines("v", vertices_nm, _DECIMALS)
    path.write_bytes(header + vertices + number_lines("f", content.mesh.faces + 1))
