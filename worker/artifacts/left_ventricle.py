"""The left ventricle of one frame, measured, or why it was not."""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from schemas.frame_report import LeftVentricleReport, SegmentReport
from schemas.vocabulary import Structure, View
from worker.arrays import Vector
from worker.evaluation.aha_segments import NAMES, LeftVentricle
from worker.evaluation.area_centroid import area_centroid_mm
from worker.evaluation.chamber import (
    long_axis_length_mm,
    mid_area_cm2,
    mid_perimeter_mm,
    sphericity,
)
from worker.evaluation.size import volume_ml
from worker.evaluation.support import AlignedOutline
from worker.evaluation.wall import thickness_by_segment, wall_mass_g
from worker.surface_mesh import SurfaceMesh

_ENDO, _EPI, _RV = Structure.LV_ENDO, Structure.LV_EPI, Structure.RV_ENDO

_BESIDE_MM = 1.0
"""Nearer to the axis than this the right ventricle gives no direction."""

_Measured = float | dict[int, SegmentReport]

Surfaces = Mapping[Structure, SurfaceMesh]
Outlines = Mapping[Structure, Sequence[AlignedOutline]]


@dataclass(frozen=True)
class Unplaced:
    """A ventricle whose segments cannot be told apart, and why."""

    reason: str


class _MissingError(Exception):
    """Something that a measure needs is not there; says what."""


def left_ventricle_report(
    surfaces: Surfaces,
    closed: Surfaces,
    toward_base: Vector | None,
    place: LeftVentricle | Unplaced,
) -> LeftVentricleReport:
    """Length, roundness, mass and wall of the left ventricle.

    surfaces: of the frame, mm. closed: those of them that are watertight. toward_base: (3,) the
    short-axis normal from apex to base, None where there is none. place: see `ventricle_place`.
    """
    measured: dict[str, _Measured] = {}
    reasons: dict[str, str] = {}
    measures: dict[str, Callable[[], _Measured]] = {
        "long_axis_length_mm": lambda: long_axis_length_mm(
            _present(surfaces, _ENDO), _axis(toward_base)
        ),
        "sphericity": lambda: _sphericity(_shut(surfaces, closed, _ENDO), _axis(toward_base)),
        "mid_area_cm2": lambda: mid_area_cm2(_shut(surfaces, closed, _ENDO), _axis(toward_base)),
        "mid_perimeter_mm": lambda: mid_perimeter_mm(
            _shut(surfaces, closed, _ENDO), _axis(toward_base)
        ),
        "wall_mass_g": lambda: wall_mass_g(
            volume_ml(_shut(surfaces, closed, _ENDO)), volume_ml(_shut(surfaces, closed, _EPI))
        ),
        "wall_thickness_mm": lambda: _thickness(surfaces, place),
    }
    for name, measure in measures.items():
        try:
            measured[name] = measure()
        except _MissingError as missing:
            reasons[name] = str(missing)
    return LeftVentricleReport.model_validate(
        {name: measured.get(name) for name in measures} | {"not_measured": reasons}
    )


def ventricle_place(
    surfaces: Surfaces, outlines: Outlines, toward_base: Vector | None
) -> LeftVentricle | Unplaced:
    """Where the left ventricle lies, as its segments are told by: cavity, septum, base.

    outlines: aligned, by structure. The rest as above.
    """
    try:
        return _placed(surfaces, outlines, _axis(toward_base))
    except _MissingError as missing:
        return Unplaced(str(missing))


def _thickness(surfaces: Surfaces, place: LeftVentricle | Unplaced) -> dict[int, SegmentReport]:
    if isinstance(place, Unplaced):
        raise _MissingError(place.reason)
    return {
        number: SegmentReport(
            name=NAMES[number], mean_mm=part.mean_mm, min_mm=part.min_mm, max_mm=part.max_mm
        )
        for number, part in thickness_by_segment(surfaces[_ENDO], surfaces[_EPI], place).items()
    }


def _placed(surfaces: Surfaces, outlines: Outlines, axis: Vector) -> LeftVentricle:
    endo, _ = _present(surfaces, _ENDO), _present(surfaces, _EPI)
    if _RV not in surfaces:
        raise _MissingError("Without rv_endo nothing shows where the septum is.")
    shared = _heights(outlines, _ENDO, axis).keys() & _heights(outlines, _EPI, axis).keys()
    if not shared:
        raise _MissingError("No short-axis slice shows lv_endo and lv_epi in one outline each.")
    centre = area_centroid_mm(endo)
    apex = float((endo.vertices_mm @ axis).min())
    base = max(_heights(outlines, _ENDO, axis)[slice_id] for slice_id in shared)
    if base <= apex:
        raise _MissingError("The slices that show lv_endo and lv_epi all lie below the cavity.")
    toward_rv = area_centroid_mm(surfaces[_RV]) - centre
    if np.linalg.norm(np.cross(axis, toward_rv)) < _BESIDE_MM:
        raise _MissingError("rv_endo is not beside lv_endo, so nothing shows where the septum is.")
    middle = float(centre @ axis)
    return LeftVentricle(centre, axis, toward_rv, apex - middle, base - middle)


def _sphericity(endo: SurfaceMesh, axis: Vector) -> float:
    return sphericity(volume_ml(endo), long_axis_length_mm(endo, axis))


def _present(surfaces: Surfaces, structure: Structure) -> SurfaceMesh:
    if structure not in surfaces:
        raise _MissingError(f"There is no {structure}.")
    return surfaces[structure]


def _shut(surfaces: Surfaces, closed: Surfaces, structure: Structure) -> SurfaceMesh:
    mesh = _present(surfaces, structure)
    if structure not in closed:
        raise _MissingError(f"{structure} is open; ask for a closed base.")
    return mesh


def _axis(toward_base: Vector | None) -> Vector:
    if toward_base is None:
        raise _MissingError("Without short-axis slices the long axis is not known.")
    return toward_base


def _heights(outlines: Outlines, structure: Structure, axis: Vector) -> dict[str, float]:
    """Of the short-axis slices that show a structure in one outline, by id: in several, as where
    a plane grazes the base, it is no ring.
    """
    across = [one for one in outlines.get(structure, ()) if one.view is View.SAX]
    times = Counter(one.slice_id for one in across)
    return {
        one.slice_id: float(np.mean(one.points_mm @ axis))
        for one in across
        if times[one.slice_id] == 1
    }
