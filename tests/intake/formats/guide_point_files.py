"""Guide-point files of a made heart: circles of which upstream writes the shared border once."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from schemas.problem import InputError

Array = NDArray[np.float64]

HEADER = "x\ty\tz\tcontour type\tframeID\tweight\ttime frame\n"


def said_of(read: Callable[[], object]) -> str:
    """What a reader says of what it refuses; of what it takes, that there is no Remedy to say."""
    try:
        read()
    except InputError as error:
        return error.detail
    return "no Remedy is needed"


def arc(centre: tuple[float, float], radius: float, first: float, last: float, n: int) -> Array:
    """Points (n, 2) of a circle between two angles, degrees."""
    angle = np.deg2rad(np.linspace(first, last, n))
    return np.array(centre) + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def short_axis_pieces() -> dict[str, Array]:
    """A left ventricle about the origin, its wall's right side the septum, a crescent beside it."""
    return {
        "SAX_LV_ENDOCARDIAL": arc((0, 0), 20, 0, 354, 60),
        "SAX_LV_EPICARDIAL": arc((0, 0), 30, -116, 116, 60),
        "SAX_RV_SEPTUM": arc((0, 0), 30, 120, 240, 30),
        # From one end of the septum round the free wall to the other.
        "SAX_RV_FREEWALL": arc((-24, 0), 27.5, 105, 255, 50),
    }


def long_axis_pieces() -> dict[str, Array]:
    """A two-chamber view: half ellipses, open at the mitral valve."""
    endo = arc((0, 0), 1, 180, 360, 50) * np.array([20, 55])
    epi = arc((0, 0), 1, 180, 360, 50) * np.array([30, 65])
    return {
        "LAX_LV_ENDOCARDIAL": endo,
        "LAX_LV_EPICARDIAL": epi,
        "MITRAL_VALVE": np.array([[-20.0, 0.0], [20.0, 0.0]]),
    }


def rows(pieces: dict[str, Array], slice_: int, z_mm: float, order: NDArray[np.intp] | None) -> str:
    """Lines of a file for a plane across z, or along it (`z_mm` NaN); shuffled by `order`."""
    lines = []
    for kind, points in pieces.items():
        for x, y in points:
            place = (x, y, z_mm) if np.isfinite(z_mm) else (x, 0.0, y)
            lines.append("\t".join(map(repr, map(float, place))) + f"\t{kind}\t{slice_}\t1.0\t0\n")
    if order is not None:
        lines = [lines[k] for k in order[: len(lines)] if k < len(lines)]
    return "".join(lines)


def info(slice_: int, origin: tuple[float, float, float], *directions: float) -> str:
    values = ["ImagePositionPatient", *origin, "ImageOrientationPatient", *directions]
    return "\t".join(
        map(str, ["i.dcm", "sliceID: ", slice_, *values, "PixelSpacing", 1.4, 1.4])
    ) + "\n"  # fmt: skip


def heart(seed: int | None = None) -> dict[str, bytes]:
    """Three short-axis slices and a long-axis one, in one frame; rows shuffled by a seed."""
    text, infos = HEADER, ""
    for slice_, z_mm in enumerate((-40.0, -30.0, -20.0), start=1):
        pieces = short_axis_pieces()
        order = None
        if seed is not None:
            count = sum(map(len, pieces.values()))
            order = np.random.default_rng(seed + slice_).permutation(count)
        text += rows(pieces, slice_, z_mm, order)
        infos += info(slice_, (0.0, 0.0, z_mm), 1, 0, 0, 0, 1, 0)
    text += rows(long_axis_pieces(), 4, np.nan, None)
    infos += info(4, (0.0, 0.0, 0.0), 1, 0, 0, 0, 0, 1)
    return {"GPFile_000.txt": text.encode(), "SliceInfoFile.txt": infos.encode()}
