"""Wavefront OBJ: vertices and faces as text, and comments."""

from pathlib import Path

import numpy as np

from worker.artifacts.mesh_files.content import Content

_DECIMALS = 6


def write_obj(path: Path, content: Content) -> None:
    """Vertices in mm, to the nanometre."""
    # Adding zero turns a rounded -0.0 into 0.0: one number, one spelling.
    vertices_mm = np.round(content.mesh.vertices_mm, _DECIMALS) + 0.0
    lines = ["# neuralmri", *(f"# {key}: {value}" for key, value in content.facts().items())]
    lines += [f"o {content.name}"]
    lines += [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in vertices_mm.tolist()]
    lines += [f"f {a} {b} {c}" for a, b, c in (content.mesh.faces + 1).tolist()]
    path.write_text("\n".join(lines) + "\n", encoding="ascii", newline="\n")
