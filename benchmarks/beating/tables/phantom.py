"""Phantoms: paths, strain and volumes of tracked meshes beside true ones."""

from statistics import fmean

import numpy as np

from benchmarks.beating.results import PhantomBeats, PhantomSurface
from benchmarks.beating.tables.tracked import FAULTS, faults
from benchmarks.beating.volume_curve import ef_error_points
from benchmarks.tables.markdown import number, table
from schemas.vocabulary import Structure

_CAVITIES = (Structure.LV_ENDO, Structure.RV_ENDO)


def paths(beats: PhantomBeats) -> str:
    """Of vertices and of area strain: at end-systole, when both are largest, and over the beat."""
    rows = []
    for one in beats.surfaces:
        end_systole = end_systole_of(one)
        rows.append(
            (
                _named(one),
                f"{number(one.normal_mm[end_systole], 2)} / {number(fmean(one.normal_mm), 2)}",
                f"{number(one.tangential_mm[end_systole], 2)} / "
                f"{number(fmean(one.tangential_mm), 2)}",
                number(one.p95_mm[end_systole], 1),
                number(one.true_strain_percent[end_systole], 1, sign=True),
                number(one.strain_percent[end_systole], 1, sign=True),
                number(one.strain_error_percent[end_systole], 1),
            )
        )
    header = (
        *("", "normal, mm: ES / mean", "tangential, mm: ES / mean", "95th percentile at ES, mm"),
        *("true mean strain at ES, %", "found, %", "mean error by vertex, points"),
    )
    return table(header, rows)


def volumes(beats: PhantomBeats) -> str:
    """Volumes of the tracked meshes, and their faults."""
    rows = [
        (
            _named(one),
            number(float(np.abs(_volume_errors_percent(one)).mean()), 2),
            number(float(np.abs(_volume_errors_percent(one)).max()), 2),
            number(ef_error_points(one.found_ml, one.true_ml), 2, sign=True)
            if one.surface in _CAVITIES
            else "-",
            *faults(one.mesh),
        )
        for one in beats.surfaces
    ]
    header = ("", "volume error, mean %", "worst frame, %", "EF error, points", *FAULTS)
    return table(header, rows)


def end_systole_of(one: PhantomSurface) -> int:
    """The frame whose surface has shrunk most."""
    return int(np.argmin(one.true_strain_percent))


def _named(one: PhantomSurface) -> str:
    return f"{one.preset}, {one.surface}, {one.tracked}"


def _volume_errors_percent(one: PhantomSurface) -> np.ndarray:
    true = np.array(one.true_ml)
    return 100.0 * (np.array(one.found_ml) - true) / true
