"""Studies cut from shapes with a formula."""

from collections.abc import Callable, Iterable

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

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
def ellipsoids() -> StudyMaker:
    """Makes a study of two similar ellipsoids about the origin: turns show, since none is round.

    motions: by index of the short-axis slice, a shift in mm along x and y and a turn in degrees
    about z through the middle of the outlines, which comes first.
    """

    def make(
        semi_axes_mm: tuple[float, float, float] = (36.0, 24.0, 44.0),
        spacing_mm: float = 8.0,
        motions: dict[int, tuple[float, float, float]] | None = None,
        long_axis_degrees: tuple[float, ...] = (20.0, 80.0, 140.0),
    ) -> ContourStudy:
        semi = np.array(semi_axes_mm)
        sizes = {"lv_epi": 1.0, "lv_endo": 0.7}
        t = np.linspace(0.0, 2.0 * np.pi, 180, endpoint=False)
        circle, x, z = np.column_stack([np.cos(t), np.sin(t), 0.0 * t]), np.eye(3)[0], np.eye(3)[2]
        half = int(semi[2] // spacing_mm)
        slices: list[dict[str, object]] = []
        for k in range(2 * half + 1):
            height = spacing_mm * (k - half)
            dx, dy, degrees = (motions or {}).get(k, (0.0, 0.0, 0.0))
            origin = np.array([dx, dy, height])
            rings = {}
            for name, size in sizes.items():
                within = 1.0 - (height / (size * semi[2])) ** 2
                if within > 0.0:
                    ring = size * np.sqrt(within) * semi * circle
                    rings[name] = Rotation.from_rotvec(np.radians(degrees) * z).apply(ring) + origin
            slices.append(_slice(f"sax-{k:02d}", "sax", origin, z, rings, sizes))
        for k, (view, degrees) in enumerate(zip(_LONG_AXIS_VIEWS, long_axis_degrees, strict=False)):
            along = Rotation.from_rotvec(np.radians(degrees) * z).apply(x)
            reach = 1.0 / np.linalg.norm(along / semi)
            ring = circle @ np.stack([reach * along, semi[2] * z, 0.0 * z])
            rings = {name: size * ring for name, size in sizes.items()}
            slices.append(_slice(f"lax-{k}", view, np.zeros(3), np.cross(along, z), rings, sizes))
        return ContourStudy.model_validate(
            {
                "subject_id": "ellipsoids",
                "units": "mm",
                "axes": "LPS",
                "frames": [{"label": "ED", "slices": slices}],
            }
        )

    return make


_LONG_AXIS_VIEWS = ("lax_4ch", "lax_2ch", "lax_3ch")


def _slice(
    name: str,
    view: str,
    origin: np.ndarray,
    normal: np.ndarray,
    rings: dict[str, np.ndarray],
    structures: Iterable[str],
) -> dict[str, object]:
    return {
        "id": name,
        "view": view,
        "origin": origin.tolist(),
        "normal": normal.tolist(),
        "contours": [{"structure": s, "points": ring.tolist()} for s, ring in rings.items()],
        "absent": [s for s in structures if s not in rings],
    }


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
