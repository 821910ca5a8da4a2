"""A reconstruction of spheres, whose every measure has a closed form."""

import math
from dataclasses import replace

import numpy as np
import pytest
import trimesh

from schemas.options import Options
from schemas.problem import InternalError
from schemas.report import Provenance, Report
from schemas.vocabulary import Axes, MeshFormat, Structure, View
from worker.artifacts.report import build_report
from worker.reconstruction.result import (
    ContourPoints,
    FrameFit,
    LevelFit,
    Reconstruction,
    SliceFit,
)
from worker.surface_mesh import SurfaceMesh

PROVENANCE = Provenance(
    software="neuralmri 0", python="3", libraries={}, seed=0, threads=1, input_sha256="0" * 64
)


def sphere(radius_mm: float) -> SurfaceMesh:
    ball = trimesh.creation.icosphere(subdivisions=5, radius=radius_mm)
    return SurfaceMesh(np.asarray(ball.vertices), np.asarray(ball.faces, dtype=np.int64))


def circle(
    radius_mm: float, z_mm: float, centre_mm: tuple[float, float] = (0.0, 0.0)
) -> np.ndarray:
    angle = np.linspace(0.0, 2 * np.pi, 60, endpoint=False)
    x_mm, y_mm = centre_mm
    return np.column_stack(
        [x_mm + radius_mm * np.cos(angle), y_mm + radius_mm * np.sin(angle), np.full(60, z_mm)]
    )


def slice_fit(points_mm: np.ndarray, shift_mm: tuple[float, float, float]) -> SliceFit:
    return SliceFit(
        id="sax-00",
        view=View.SAX,
        shift_mm=np.array(shift_mm),
        contours_mm={Structure.LV_ENDO: (ContourPoints(points_mm, closed=True),)},
    )


def frame(label: str, radius_mm: float, *slices: SliceFit) -> FrameFit:
    return FrameFit(
        label=label,
        time_ms=None,
        surfaces={Structure.LV_ENDO: sphere(radius_mm)},
        slices=slices or (slice_fit(circle(radius_mm, 0.0), (0.0, 0.0, 0.0)),),
        levels=(LevelFit(level=0, radius_mm=4.0, samples=9, bce=0.5, hinge=1.0, total=0.6),),
    )


def report_of(*frames: FrameFit) -> Report:
    return build_report(
        Reconstruction("case-01", Axes.RAS, frames),
        options=Options(formats=[MeshFormat.STL, MeshFormat.VTP]),
        warnings=["look"],
        timings_s={"fitting": 1.0},
        provenance=PROVENANCE,
    )


def test_a_sphere_measures_as_the_formulas_say() -> None:
    report = report_of(frame("ED", 30.0))
    surface = report.frames[0].surfaces[Structure.LV_ENDO]
    assert surface.volume_ml == pytest.approx(4 / 3 * math.pi * 27.0, rel=2e-3)
    assert surface.area_cm2 == pytest.approx(4 * math.pi * 9.0, rel=2e-3)
    assert (surface.watertight, surface.euler_number) == (True, 2)
    assert surface.files == ["ED_lv_endo.stl", "ED_lv_endo.vtp"]
    assert surface.contour_residual_mm.mean < 0.03
    assert surface.contour_residual_mm.count == 60
    assert (report.axes, report.warnings, report.timings_s) == (
        Axes.RAS,
        ["look"],
        {"fitting": 1.0},
    )


def test_a_contour_inside_the_surface_is_as_far_from_it_as_it_is_smaller() -> None:
    report = report_of(frame("ED", 30.0, slice_fit(circle(28.0, 0.0), (0.0, 0.0, 0.0))))
    residual = report.frames[0].slices[0].contour_residual_mm[Structure.LV_ENDO]
    assert residual.mean == pytest.approx(2.0, abs=0.03)
    assert residual.max == pytest.approx(2.0, abs=0.03)


def test_a_displaced_slice_is_measured_where_it_was_moved_back_to() -> None:
    displaced = slice_fit(circle(30.0, 0.0, centre_mm=(3.0, -4.0)), (3.0, -4.0, 0.0))
    (one,) = report_of(frame("ED", 30.0, displaced)).frames[0].slices
    assert one.shift_mm == (3.0, -4.0, 0.0)
    assert one.contour_residual_mm[Structure.LV_ENDO].max < 0.03


def test_a_slice_that_only_knows_absence_has_no_residual() -> None:
    empty = SliceFit(id="sax-01", view=View.SAX, shift_mm=np.zeros(3), contours_mm={})
    observed = slice_fit(circle(30.0, 0.0), (0.0, 0.0, 0.0))
    report = report_of(frame("ED", 30.0, observed, empty))
    assert report.frames[0].slices[1].contour_residual_mm == {}


def test_a_structure_that_was_not_asked_for_is_not_measured() -> None:
    observed = slice_fit(circle(30.0, 0.0), (0.0, 0.0, 0.0))
    outline = ContourPoints(circle(40.0, 0.0), closed=True)
    more = replace(observed, contours_mm={**observed.contours_mm, Structure.LV_EPI: (outline,)})
    (one,) = report_of(frame("ED", 30.0, more)).frames[0].slices
    assert set(one.contour_residual_mm) == {Structure.LV_ENDO}


def test_an_open_surface_has_no_volume() -> None:
    fit = frame("ED", 30.0)
    whole = fit.surfaces[Structure.LV_ENDO]
    cut = SurfaceMesh(whole.vertices_mm, whole.faces[:-100])
    report = report_of(replace(fit, surfaces={Structure.LV_ENDO: cut}))
    surface = report.frames[0].surfaces[Structure.LV_ENDO]
    assert (surface.volume_ml, surface.watertight) == (None, False)


def test_an_inside_out_surface_is_not_handed_out() -> None:
    fit = frame("ED", 30.0)
    whole = fit.surfaces[Structure.LV_ENDO]
    inward = SurfaceMesh(whole.vertices_mm, whole.faces[:, ::-1])
    with pytest.raises(InternalError, match="faces inward"):
        report_of(replace(fit, surfaces={Structure.LV_ENDO: inward}))


def test_function_is_reported_for_end_diastole_and_end_systole() -> None:
    function = report_of(frame("ED", 30.0), frame("ES", 24.0)).function
    assert function is not None
    assert function.lv_ejection_fraction_percent == pytest.approx(100 * (1 - 0.8**3), abs=0.1)


@pytest.mark.parametrize("labels", [("ED",), ("ED", "t01")])
def test_function_is_not_guessed_from_other_frames(labels: tuple[str, ...]) -> None:
    assert report_of(*(frame(label, 30.0) for label in labels)).function is None
