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
from worker.artifacts.measured import FIELDS, Measured
from worker.artifacts.report import measure, timed
from worker.reconstruction.result import (
    ContourPoints,
    FailedFrame,
    FrameFit,
    LevelFit,
    LevelSetCurvature,
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
        normal=np.array([0.0, 0.0, 1.0]),
        shift_mm=np.array(shift_mm),
        shift_deviation_mm=0.1,
        crossings=6,
        turn_rad=0.0,
        pivot_mm=np.zeros(3),
        contours_mm={Structure.LV_ENDO: (ContourPoints(points_mm, closed=True),)},
    )


def frame(label: str, radius_mm: float, *slices: SliceFit) -> FrameFit:
    return FrameFit(
        label=label,
        time_ms=None,
        surfaces={Structure.LV_ENDO: sphere(radius_mm)},
        slices=slices or (slice_fit(circle(radius_mm, 0.0), (0.0, 0.0, 0.0)),),
        levels=(LevelFit(0, 4.0, 9, *(np.array(x) for x in ([0.6, 0.4], [0.0, 2.0], [0.6, 0.6]))),),
    )


def measured(*frames: FrameFit, references: dict[str, SurfaceMesh] | None = None) -> Measured:
    return measure(
        Reconstruction("case-01", Axes.RAS, frames),
        options=Options(formats=[MeshFormat.STL, MeshFormat.VTP]),
        warnings=["look"],
        provenance=PROVENANCE,
        references=references,
    )


def report_of(*frames: FrameFit) -> Report:
    return timed(measured(*frames), {"fitting": 1.0}).report


def test_a_sphere_measures_as_the_formulas_say() -> None:
    report = report_of(frame("ED", 30.0))
    surface = report.frames[0].surfaces[Structure.LV_ENDO]
    assert surface.volume_ml == pytest.approx(4 / 3 * math.pi * 27.0, rel=2e-3)
    assert surface.area_cm2 == pytest.approx(4 * math.pi * 9.0, rel=2e-3)
    assert (surface.watertight, surface.euler_number) == (True, 2)
    assert surface.files == ["ED_lv_endo.stl", "ED_lv_endo.vtp"]
    assert surface.contour_residual_mm.mean < 0.03
    assert surface.contour_residual_mm.count == 60
    assert (report.axes, report.warnings[0], report.timings_s) == (
        Axes.RAS,
        "look",
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
    observed = slice_fit(circle(30.0, 0.0), (0.0, 0.0, 0.0))
    empty = replace(observed, id="sax-01", contours_mm={})
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
    assert function.lv_fractional_area_change_percent == pytest.approx(36.0, abs=0.2)
    assert function.rv_edv_ml is None
    assert (function.ed_frame, function.es_frame) == ("ED", "ES")


def test_function_of_a_cycle_is_of_its_largest_and_smallest_cavity() -> None:
    radii_mm = {"F0": 27.0, "F1": 24.0, "F2": 25.0, "F3": 30.0}
    function = report_of(*(frame(label, radius) for label, radius in radii_mm.items())).function
    assert function is not None
    assert (function.ed_frame, function.es_frame) == ("F3", "F1")
    assert function.lv_ejection_fraction_percent == pytest.approx(100 * (1 - 0.8**3), abs=0.1)
    assert function.lv_fractional_area_change_percent == pytest.approx(36.0, abs=0.2)


def test_frames_that_are_named_so_are_end_diastole_and_end_systole() -> None:
    radii_mm = {"a": 31.0, "es": 24.0, "b": 20.0, "ed": 30.0}
    report = report_of(*(frame(label, radius) for label, radius in radii_mm.items()))
    assert report.function is not None
    assert (report.function.ed_frame, report.function.es_frame) == ("ed", "es")
    # What the cycle says is of the volumes alone.
    assert report.cycle is not None
    assert (report.cycle.ed_frame, report.cycle.chambers[Structure.LV_ENDO].es_frame) == ("a", "b")


def test_the_right_ventricle_pumps_too() -> None:
    def both(label: str, left_mm: float, right_mm: float) -> FrameFit:
        left = frame(label, left_mm)
        (one,) = left.slices
        beside = circle(right_mm, 0.0, (70.0, 0.0))
        rv = {Structure.RV_ENDO: (ContourPoints(beside, closed=True),)}
        right = sphere(right_mm)
        moved = SurfaceMesh(right.vertices_mm + np.array([70.0, 0.0, 0.0]), right.faces)
        return replace(
            left,
            surfaces={**left.surfaces, Structure.RV_ENDO: moved},
            slices=(replace(one, contours_mm={**one.contours_mm, **rv}),),
        )

    function = report_of(both("ED", 30.0, 25.0), both("ES", 24.0, 20.0)).function
    assert function.rv_edv_ml == pytest.approx(4e-3 / 3 * math.pi * 25.0**3, rel=5e-3)
    assert function.rv_ejection_fraction_percent == pytest.approx(100 * (1 - 0.8**3), abs=0.1)
    assert function.rv_stroke_volume_ml == pytest.approx(function.rv_edv_ml - function.rv_esv_ml)


def test_residuals_are_told_by_view_and_region_and_add_up() -> None:
    fit = stack(long_axis=True)
    surface = report_of(fit).frames[0].surfaces[Structure.LV_ENDO]
    by_view = surface.contour_residual_by_view
    assert set(by_view) == {"short_axis", "long_axis"}
    total = surface.contour_residual_mm.count
    assert sum(part.summary_mm.count for part in by_view.values()) == total
    assert sum(part.count for part in surface.contour_residual_by_region_mm.values()) == total
    for part in by_view.values():
        assert sum(part.histogram.counts) + part.histogram.beyond == part.summary_mm.count


def test_sections_cover_what_was_outlined() -> None:
    half = frame("ED", 30.0, slice_fit(circle(15.0, 0.0), (0.0, 0.0, 0.0)))
    (exact,), (small,) = (report_of(one).frames[0].slices for one in (frame("ED", 30.0), half))
    assert exact.dice[Structure.LV_ENDO] == pytest.approx(1.0, abs=3e-3)
    assert small.dice[Structure.LV_ENDO] == pytest.approx(2.0 * 0.25 / 1.25, abs=3e-3)


def test_an_even_sphere_is_fit_for_a_simulation_and_one_with_slivers_is_not() -> None:
    even = frame("ED", 30.0)
    mesh = even.surfaces[Structure.LV_ENDO]
    thin = SurfaceMesh(mesh.vertices_mm.copy(), mesh.faces)
    first = mesh.faces[0]
    thin.vertices_mm[first[0]] = thin.vertices_mm[first[1]] + 0.01 * (
        thin.vertices_mm[first[0]] - thin.vertices_mm[first[1]]
    )
    uneven = replace(even, surfaces={Structure.LV_ENDO: thin})
    fit, unfit = (
        report_of(one).frames[0].surfaces[Structure.LV_ENDO].simulation for one in (even, uneven)
    )
    assert (fit.fit, fit.reasons) == (True, [])
    assert not unfit.fit
    assert "target_edge_mm" in unfit.reasons[-1]


@pytest.mark.parametrize("labels", [("ED",), ("ED", "t01")])
def test_function_is_not_guessed_from_other_frames(labels: tuple[str, ...]) -> None:
    assert report_of(*(frame(label, 30.0) for label in labels)).function is None


def sax(index: int, z_mm: float, radius_mm: float) -> SliceFit:
    fit = slice_fit(circle(radius_mm, z_mm), (0.0, 0.0, 0.0))
    return replace(fit, id=f"sax-{index:02d}")


def stack(*, long_axis: bool) -> FrameFit:
    """A sphere of 30 mm cut at -20, -12, -4, 4 mm; the base, by width, is up; maybe a LAX cut."""
    slices = [
        sax(k, z_mm, math.sqrt(900.0 - z_mm**2)) for k, z_mm in enumerate((-20.0, -12.0, -4.0, 4.0))
    ]
    if long_axis:
        upright = circle(30.0, 0.0)[:, [0, 2, 1]]
        outline = (ContourPoints(upright, closed=True),)
        one = slice_fit(circle(30.0, 0.0), (0.0, 0.0, 0.0))
        contours_mm = {Structure.LV_ENDO: outline}
        across = np.array([0.0, 1.0, 0.0])
        slices.append(
            replace(one, id="lax", view=View.LAX_4CH, normal=across, contours_mm=contours_mm)
        )
    return frame("ED", 30.0, *slices)


def test_views_that_contradict_each_other_are_told_of() -> None:
    unsteady = replace(frame("ED", 30.0), contour_noise_mm=1.5)
    report = report_of(unsteady, frame("ES", 20.0))
    assert [one.contour_noise_mm for one in report.frames] == [1.5, None]
    assert [w[:3] for w in report.warnings if "1.5 mm, beyond" in w] == ["ED:"]


def test_an_end_that_no_long_axis_slice_shows_is_told_of() -> None:
    report = report_of(stack(long_axis=False))
    surface = report.frames[0].surfaces[Structure.LV_ENDO]
    assert surface.apex is not None
    assert surface.base is not None
    # From the pole to the nearest ring, at -20 and at +4 mm.
    apex_mm, base_mm = math.hypot(10.0, math.sqrt(500.0)), math.hypot(26.0, math.sqrt(884.0))
    assert surface.apex.height_mm == pytest.approx(10.0, abs=0.01)
    assert surface.apex.support_max_mm == pytest.approx(apex_mm, abs=0.05)
    assert surface.base.support_max_mm == pytest.approx(base_mm, abs=0.05)
    assert surface.slice_gap_mm == pytest.approx(8.0)
    assert surface.support_mm.max == pytest.approx(base_mm, abs=0.05)
    assert report.warnings[1:] == [
        "ED lv_endo: its apex and base lie up to 24.5 and 39.5 mm from the nearest contour; no "
        "long-axis slice shows them, so its shape there is extrapolated."
    ]


def test_an_end_that_a_long_axis_slice_shows_is_not() -> None:
    report = report_of(stack(long_axis=True))
    surface = report.frames[0].surfaces[Structure.LV_ENDO]
    assert surface.apex is not None
    assert surface.apex.on_long_axis
    assert report.warnings == ["look"]


def test_support_is_measured_from_where_slices_were_moved_back_to() -> None:
    still = frame("ED", 30.0, slice_fit(circle(30.0, 0.0), (0.0, 0.0, 0.0)))
    displaced = slice_fit(circle(30.0, 0.0, centre_mm=(3.0, -4.0)), (3.0, -4.0, 0.0))
    one, two = (
        report_of(fit).frames[0].surfaces[Structure.LV_ENDO].support_mm
        for fit in (still, frame("ED", 30.0, displaced))
    )
    assert one.max == pytest.approx(two.max)
    assert one.mean == pytest.approx(two.mean)


def test_triangles_are_told_before_and_after_remeshing() -> None:
    fit = frame("ED", 30.0)
    plain = report_of(fit).frames[0].surfaces[Structure.LV_ENDO]
    assert plain.quality_before_remeshing is None
    assert plain.remeshing_distance_mm is None
    coarse = trimesh.creation.icosphere(subdivisions=3, radius=30.0)
    coarse_mesh = SurfaceMesh(np.asarray(coarse.vertices), np.asarray(coarse.faces, dtype=np.int64))
    remeshed = replace(
        fit,
        surfaces={Structure.LV_ENDO: coarse_mesh},
        unremeshed=fit.surfaces,
    )
    surface = report_of(remeshed).frames[0].surfaces[Structure.LV_ENDO]
    assert surface.quality_before_remeshing == plain.quality
    assert surface.quality.edge_mean_mm == pytest.approx(4 * plain.quality.edge_mean_mm, rel=0.02)
    assert surface.remeshing_distance_mm is not None
    # Triangles of the coarser sphere sag by about a sixth of edge squared over radius.
    sag_mm = surface.quality.edge_mean_mm**2 / 6 / 30.0
    assert surface.remeshing_distance_mm.max == pytest.approx(sag_mm, rel=0.4)


def test_a_triangle_without_area_has_no_aspect_ratio_in_the_report() -> None:
    fit = frame("ED", 30.0)
    whole = fit.surfaces[Structure.LV_ENDO]
    flat = SurfaceMesh(whole.vertices_mm, np.vstack([whole.faces, [[0, 0, 1]]]))
    surface = (
        report_of(replace(fit, surfaces={Structure.LV_ENDO: flat}))
        .frames[0]
        .surfaces[Structure.LV_ENDO]
    )
    assert surface.quality.aspect_ratio_max is None
    assert surface.quality.min_angle_deg == 0.0


def test_losses_are_told_by_iteration_and_their_means_by_level() -> None:
    (level,) = report_of(frame("ED", 30.0)).frames[0].levels
    assert level.iterations.bce == [0.6, 0.4]
    assert level.iterations.hinge == [0.0, 2.0]
    assert (level.bce, level.hinge, level.total) == pytest.approx((0.5, 1.0, 0.6))


def test_a_slice_that_was_left_out_is_measured_on_the_surface_without_it() -> None:
    one = frame("ED", 30.0)
    without = replace(one, held_out={"sax-00": {Structure.LV_ENDO: sphere(27.0)}})
    report = report_of(without).frames[0]
    assert report.slices[0].held_out_mm[Structure.LV_ENDO].mean == pytest.approx(3.0, abs=0.03)
    surface = report.surfaces[Structure.LV_ENDO]
    assert surface.held_out_mm == report.slices[0].held_out_mm[Structure.LV_ENDO]
    assert surface.held_out_by_view_mm == {"short_axis": surface.held_out_mm}
    plain = report_of(one).frames[0]
    assert plain.surfaces[Structure.LV_ENDO].held_out_mm is None
    assert plain.slices[0].held_out_mm == {}


def test_the_spread_of_an_ensemble_is_told_at_every_vertex() -> None:
    """Spheres 1 mm within and without: squares sum to 2, over two members."""
    members = tuple({Structure.LV_ENDO: sphere(radius)} for radius in (29.0, 31.0))
    found = measured(replace(frame("ED", 30.0), members=members))
    surface = found.report.frames[0].surfaces[Structure.LV_ENDO]
    assert surface.deviation_mm is not None
    assert surface.deviation_mm.mean == pytest.approx(1.0, abs=0.01)
    deviation = found.frames[0].surfaces[Structure.LV_ENDO].fields["deviation_mm"]
    np.testing.assert_allclose(deviation, 1.0, atol=0.02)


def test_a_reference_is_measured_against_and_at_every_vertex() -> None:
    found = measured(frame("ED", 30.0), references={"ED_lv_endo": sphere(32.0)})
    surface = found.report.frames[0].surfaces[Structure.LV_ENDO]
    assert surface.reference is not None
    assert surface.reference.mean_mm == pytest.approx(2.0, abs=0.02)
    assert surface.reference.hausdorff_mm == pytest.approx(2.0, abs=0.05)
    assert surface.reference.by_view["short_axis"].distance_mm.mean == pytest.approx(2.0, abs=0.02)
    drawn = found.frames[0].surfaces[Structure.LV_ENDO]
    assert drawn.reference is not None
    np.testing.assert_allclose(drawn.fields["distance_mm"], 2.0, atol=0.05)
    assert found.frames[0].slices[0].reference_sections.keys() == {Structure.LV_ENDO}
    assert report_of(frame("ED", 30.0)).frames[0].surfaces[Structure.LV_ENDO].reference is None


def test_vertices_carry_what_is_known_there_and_nothing_else() -> None:
    fit = stack(long_axis=True)
    mesh = fit.surfaces[Structure.LV_ENDO]
    count = len(mesh.vertices_mm)
    flat = LevelSetCurvature(np.full(count, 1.0 / 900.0), np.full(count, 1.0 / 30.0))
    found = measured(replace(fit, curvature={Structure.LV_ENDO: flat}))
    fields = found.frames[0].surfaces[Structure.LV_ENDO].fields
    assert set(fields) == {
        "support_mm",
        "residual_mm",
        "gaussian_curvature_per_mm2",
        "mean_curvature_per_mm",
        "third",
    }
    assert set(fields) < set(FIELDS)
    assert all(np.isfinite(numbers).all() for numbers in fields.values())
    third = fields["third"]
    assert third[mesh.vertices_mm[:, 2].argmin()] == 0.0
    assert third[mesh.vertices_mm[:, 2].argmax()] == 2.0


def test_sections_of_an_open_surface_end_at_its_rim() -> None:
    fit = stack(long_axis=True)
    whole = fit.surfaces[Structure.LV_ENDO]
    below = (whole.triangles_mm[:, :, 2] < 10.0).all(axis=1)
    cup = SurfaceMesh(whole.vertices_mm, whole.faces[below])
    frames = measured(replace(fit, surfaces={Structure.LV_ENDO: cup})).frames
    sections = {one.id: one.sections for one in frames[0].slices}
    (ring,) = sections["sax-02"][Structure.LV_ENDO]
    np.testing.assert_allclose(ring[0], ring[-1])
    (arc,) = sections["lax"][Structure.LV_ENDO]
    assert np.linalg.norm(arc[0] - arc[-1]) > 30.0


def test_what_warnings_say_is_among_the_concerns() -> None:
    report = report_of(stack(long_axis=False))
    texts = [one.text for one in report.concerns]
    assert set(report.warnings) <= set(texts)
    assert [one.severity for one in report.concerns] == sorted(
        one.severity for one in report.concerns
    )


def test_frames_that_failed_are_named_with_their_reasons() -> None:
    empty = FailedFrame("F1", "F1 encloses nothing.")
    inward = frame("F2", 30.0)
    mesh = inward.surfaces[Structure.LV_ENDO]
    turned = SurfaceMesh(mesh.vertices_mm, mesh.faces[:, ::-1].copy())
    fits = (frame("ED", 30.0), replace(inward, surfaces={Structure.LV_ENDO: turned}))
    report = measure(
        Reconstruction("case-01", Axes.RAS, fits, (empty,), ("slice sax-00 differs",)),
        options=Options(),
        warnings=[],
        provenance=PROVENANCE,
    ).report
    assert [one.label for one in report.frames] == ["ED"]
    assert [one.label for one in report.failed_frames] == ["F1", "F2"]
    said = "\n".join(report.warnings)
    assert "Frame F1 has no results: F1 encloses nothing." in said
    assert "Frame F2 has no results" in said
    assert "slice sax-00 differs" in said
    assert {"F1", "F2"} <= {one.text.split()[1] for one in report.concerns}
