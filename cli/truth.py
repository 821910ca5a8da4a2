"""The phantom as the demo needs it: its true surfaces by name, and its label maps."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from schemas.labels import LabelScheme
from schemas.surface_name import SurfaceName
from schemas.vocabulary import Axes, View
from worker.phantom.analytic_heart import heart
from worker.phantom.label_map import write_label_maps
from worker.surface_mesh import SurfaceMesh

_LPS_TO = {Axes.LPS: np.array([1.0, 1.0, 1.0]), Axes.RAS: np.array([-1.0, -1.0, 1.0])}

Truth = Mapping[str, SurfaceMesh]
"""True surfaces, mm, by the name of the mesh file that should match: `ED_lv_endo`."""


def phantom_truth(phases: Mapping[str, float], axes: Axes) -> Truth:
    """The phantom's surfaces at each of `phases` (frame label -> phase), in `axes`."""
    # Two axes change their sign at once, which is a rotation: the surfaces still face outward.
    return {
        str(SurfaceName(label, structure)): SurfaceMesh(
            mesh.vertices_mm * _LPS_TO[axes], mesh.faces
        )
        for label, phase in phases.items()
        for structure, mesh in heart(phase).meshes().items()
    }


def write_phantom_maps(folder: Path, scheme: LabelScheme) -> dict[View, Path]:
    """Label maps of the phantom at end-diastole: a short-axis stack and the long-axis views."""
    return write_label_maps(heart(), folder, scheme)
