"""The closed surfaces of a cycle in one file of vertices by frame, as a model fit leaves them."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from trimesh import Trimesh

from schemas.vocabulary import Structure
from worker.surface_mesh import SurfaceMesh

_MATERIALS = {
    Structure.LV_ENDO: ("LV_ENDOCARDIAL", "AORTA_VALVE", "MITRAL_VALVE"),
    Structure.LV_EPI: (
        "LV_EPICARDIAL", "AORTA_VALVE", "AORTA_VALVE_CUT", "MITRAL_VALVE", "MITRAL_VALVE_CUT",
        "RV_SEPTUM", "THRU_WALL",
    ),
    Structure.RV_ENDO: ("RV_FREEWALL", "PULMONARY_VALVE", "RV_SEPTUM", "TRICUSPID_VALVE"),
}  # fmt: skip
"""Pieces that make each surface closed."""


def fitted_cycle(path: Path) -> list[Mapping[Structure, SurfaceMesh]]:
    """The surfaces of every frame, facing outward, mm.

    path: an .npz with `vertices` (frames, n, 3) in mm, `faces` (m, 3) and `materials` (m,).
    """
    with np.load(path) as held:
        vertices, faces, materials = held["vertices"], held["faces"], held["materials"]
    pieces = {}
    for structure, names in _MATERIALS.items():
        chosen = faces[np.isin(materials, names)]
        shell = Trimesh(vertices[0].astype(float), chosen, process=False)
        shell.fix_normals()
        used, renumbered = np.unique(np.asarray(shell.faces), return_inverse=True)
        pieces[structure] = used, renumbered.reshape(-1, 3)
    return [
        {s: SurfaceMesh(frame[used].astype(float), f) for s, (used, f) in pieces.items()}
        for frame in vertices
    ]
