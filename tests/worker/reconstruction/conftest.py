"""Studies cut from shapes with a formula."""

from collections.abc import Callable

import numpy as np
import pytest

from schemas.options import Options
from schemas.study import ContourStudy

StudyMaker = Callable[..., ContourStudy]


def _sphere_slice(
    index: int,
    view: str,
    structures: dict[str, float],
    centre: np.ndarray,
    rotation: np.ndarray,
    offset: float,
    normal_axis: int,
    displacement: tuple[float, float] = (0.0, 0.0),
) -> dict[str, object]:
    u, v = np.eye(3)[(normal_axis + 1) % 3], np.eye(3)[(normal_axis + 2) % 3]
    normal = np.eye(3)[normal_axis]
    origin = offset * normal + displacement[0] * u + displacement[1] * v
    t = np.linspace(0.0, 2.0 * np.pi, 90, endpoint=False)
    contours, absent = [], []
    for structure, radius in structures.items():
        if abs(offset) >= radius:
            absent.append(structure)
            continue
        within = np.sqrt(radius**2 - offset**2)
        ring = origin + within * (np.cos(t)[:, None] * u + np.sin(t)[:, None] * v)
        points = (ring @ rotation.T + centre).tolist()
        contours.append({"structure": structure, "points": points})
    return {
        "id": f"{view}-{index:02d}",
        "view": view,
        "origin": (origin @ rotation.T + centre).tolist(),
        "normal": (rotation @ normal).tolist(),
        "contours": contours,
        "absent": absent,
    }


@pytest.fixture(scope="session")
def concentric_spheres() -> StudyMaker:
    """Makes a study of concentric spheres, lv_endo inside lv_epi, from SAX slices and two LAX."""

    def make(
        endo_mm: float = 25.0,
        epi_mm: float = 35.0,
        spacing_mm: float = 8.0,
        centre: tuple[float, float, float] = (12.0, -30.0, 55.0),
        rotation: np.ndarray | None = None,
        displacements: dict[int, tuple[float, float]] | None = None,
        long_axis: bool = True,
    ) -> ContourStudy:
        radii = {"lv_endo": endo_mm, "lv_epi": epi_mm}
        turn = np.eye(3) if rotation is None else rotation
        half = int(np.ceil(epi_mm / spacing_mm))
        slices = [
            _sphere_slice(
                k,
                "sax",
                radii,
                np.array(centre),
                turn,
                spacing_mm * (k - half) + 0.3 * spacing_mm,
                2,
                (displacements or {}).get(k, (0.0, 0.0)),
            )
            for k in range(2 * half)
        ]
        if long_axis:
            slices += [
                _sphere_slice(k, view, radii, np.array(centre), turn, 0.0, axis)
                for k, (view, axis) in enumerate((("lax_4ch", 0), ("lax_2ch", 1)))
            ]
        return ContourStudy.model_validate(
            {
                "subject_id": "spheres",
                "units": "mm",
                "axes": "LPS",
                "frames": [{"label": "ED", "slices": slices}],
            }
        )

    return make


@pytest.fixture(scope="session")
def quick() -> Options:
    """Options of a fit that takes about a second."""
    return Options.model_validate(
        {
            "levels": 3,
            "iterations_per_level": 60,
            "optimizer": {"samples_per_step": 1024},
            "mesh": {"grid_mm": 3.0},
        }
    )
