"""What is reported of a surface and its reference: closed forms and reasons."""

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from schemas.options import ReferenceOptions
from schemas.problem import InputError, InternalError
from schemas.reference_report import ReferenceReport
from schemas.vocabulary import Structure, View
from worker.artifacts.reference_report import MeasuredReference, reference_report
from worker.evaluation.comparison import compared
from worker.evaluation.regions import Regions, regions
from worker.observer import Cancelled, Unobserved
from worker.surface_mesh import SurfaceMesh

UP = np.array([0.0, 0.0, 1.0])
X, Y = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
QUICK = ReferenceOptions(samples=4000, curvature_edge_mm=None)
PLANES = [
    *((View.SAX, height * UP, UP) for height in (-30.0, -10.0, 0.0, 10.0)),
    (View.LAX_2CH, np.zeros(3), X),
    (View.LAX_4CH, np.zeros(3), Y),
]


def ball(radius_mm: float, centre: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> SurfaceMesh:
    solid = trimesh.creation.icosphere(subdivisions=4, radius=radius_mm)
    return SurfaceMesh(
        np.asarray(solid.vertices) + np.array(centre), np.asarray(solid.faces, dtype=np.int64)
    )


BALL = ball(22.0)
SURFACES = {Structure.LV_ENDO: BALL, Structure.RV_ENDO: ball(15.0, (-40.0, 0.0, 0.0))}
REGIONS = regions(Structure.LV_ENDO, SURFACES, UP)
OPENED = SurfaceMesh(BALL.vertices_mm, BALL.faces[BALL.triangles_mm[:, :, 2].max(axis=1) < 15.0])


def held(
    mesh: SurfaceMesh,
    reference: SurfaceMesh,
    options: ReferenceOptions = QUICK,
    regions: Regions = REGIONS,
) -> MeasuredReference:
    return reference_report(
        mesh, reference, regions=regions, planes=PLANES, options=options, seed=0
    )


def test_spheres_about_one_centre_measure_as_the_formulas_say() -> None:
    options = ReferenceOptions(samples=4000, curvature_edge_mm=3.0)
    found = held(BALL, ball(20.0), options)
    report = found.report
    assert report.not_measured == {}
    assert report.volume_ml == pytest.approx(4e-3 / 3 * np.pi * 20.0**3, rel=0.01)
    assert report.volume_difference_percent == pytest.approx(100.0 * (1.1**3 - 1.0))
    for number in (report.mean_mm, report.rms_mm, report.hausdorff95_mm, report.hausdorff_mm):
        assert number == pytest.approx(2.0, abs=0.06)
    assert report.to_reference_mm.count == report.from_reference_mm.count == 4000
    assert report.by_region_mm.keys() == {"apex", "mid", "base", "septum", "free_wall"}
    for part in report.by_region_mm.values():
        assert part.mean == pytest.approx(2.0, abs=0.05)
    thirds = [report.by_region_mm[name].count for name in ("apex", "mid", "base")]
    assert np.array(thirds) / 4000 == pytest.approx([1 / 3] * 3, abs=0.03)
    assert report.by_region_mm["septum"].count / 4000 == pytest.approx(1 / 3, abs=0.03)
    assert 0.0 <= report.above_p90_area_percent <= 15.0
    # The plane at -30 mm meets neither.
    assert {kind: part.planes for kind, part in report.by_view.items()} == {
        "short_axis": 3,
        "long_axis": 2,
    }
    long_axis = report.by_view["long_axis"]
    assert long_axis.distance_mm.mean == pytest.approx(2.0, abs=0.05)
    assert long_axis.dice_min == pytest.approx(2.0 / (1.0 + 1.1**2), abs=0.01)
    assert report.point_set.points == 4000
    assert report.point_set.rms_chamfer_mm > report.rms_mm
    assert report.curvature.mean_per_mm.mean_abs == pytest.approx(1 / 20 - 1 / 22, rel=0.2)
    assert report.curvature.mean_per_mm.mean_abs_by_region.keys() == report.by_region_mm.keys()
    assert report.placement is None
    assert found.reference.vertices_mm is not BALL.vertices_mm
    np.testing.assert_allclose(found.distance_mm, 2.0, atol=0.06)


def test_it_says_what_the_command_says() -> None:
    reference = ball(20.0, (1.0, 0.0, 0.0))
    report, same = held(BALL, reference).report, compared(BALL, reference, 4000, 0)
    assert report.mean_mm == same.surface_distance.mean_mm
    assert report.hausdorff95_mm == same.surface_distance.hausdorff95_mm
    assert report.from_reference_mm.p95 == same.surface_distance.from_reference.p95_mm
    assert report.volume_difference_percent == same.volume_difference_percent
    assert report.point_set.chamfer_mm2 == same.point_set_distance.chamfer_mm2
    assert report.point_set.optimal_threshold_mm == same.point_set_distance.optimal_threshold_mm


def test_an_error_is_found_in_the_region_where_it_is() -> None:
    """A bulge to the right ventricle's side."""
    x = BALL.vertices_mm[:, 0] / 22.0
    bulge = np.clip((-x - 0.8) / 0.2, 0.0, 1.0) * 3.0
    reference = SurfaceMesh(BALL.vertices_mm * (1.0 + bulge / 22.0)[:, None], BALL.faces)
    parts = held(BALL, reference).report.by_region_mm
    assert parts["septum"].max > 2.0
    assert parts["free_wall"].max < 0.1
    assert parts["mid"].mean > 5.0 * parts["base"].mean


@pytest.mark.parametrize(
    ("mesh", "reference", "missing", "reason"),
    [
        (OPENED, BALL, {"volume_difference_percent", "by_view", "curvature"}, "surface is open"),
        (
            BALL,
            OPENED,
            {"volume_ml", "volume_difference_percent", "by_view", "curvature"},
            "reference is open",
        ),
    ],
)
def test_what_needs_closed_surfaces_is_null_with_a_reason(
    mesh: SurfaceMesh, reference: SurfaceMesh, missing: set[str], reason: str
) -> None:
    report = held(mesh, reference, ReferenceOptions(samples=500)).report
    assert report.not_measured.keys() == missing
    assert all(reason in text for text in report.not_measured.values())
    assert report.volume_difference_percent is None
    assert report.by_view == {}
    assert report.curvature is None
    assert report.mean_mm < 2.0


def test_what_is_not_asked_for_or_cannot_be_split_is_said() -> None:
    report = held(BALL, BALL, regions=regions(Structure.LV_ENDO, SURFACES, None)).report
    assert report.by_region_mm == {}
    assert report.not_measured.keys() == {"thirds", "septum", "curvature"}
    assert "reference.curvature_edge_mm" in report.not_measured["curvature"]


def test_a_reference_without_inside_gives_numbers_or_reasons_and_nothing_infinite() -> None:
    corners = np.array([[0.0, 0, 0], [10, 0, 0], [0, 10, 0]])
    flat = SurfaceMesh(corners, np.array([[0, 1, 2], [0, 2, 1]]))
    report = held(BALL, flat, ReferenceOptions(samples=500)).report
    assert report.volume_ml == 0.0
    assert "encloses nothing" in report.not_measured["volume_difference_percent"]
    assert "too thin" in report.not_measured["curvature"]
    again = ReferenceReport.model_validate_json(report.model_dump_json())
    assert again == report


def test_without_area_nothing_can_be_measured() -> None:
    line = SurfaceMesh(np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]]), np.array([[0, 1, 2]]))
    with pytest.raises(InputError, match="send the surface itself"):
        held(BALL, line)
    with pytest.raises(InternalError, match="no area"):
        held(line, BALL)


def test_a_displaced_reference_is_brought_to_the_surface_and_nothing_else_moves() -> None:
    """The report names the surface's motion; planes and regions stay with the surface."""
    stretch = np.array([1.0, 1.2, 1.4])
    mesh = SurfaceMesh(BALL.vertices_mm * stretch, BALL.faces)
    turn = Rotation.from_rotvec([0.0, 3.0, 4.0], degrees=True).as_matrix()
    away = np.array([200.0, -10.0, 3.0])
    reference = SurfaceMesh(mesh.vertices_mm @ turn.T + away, mesh.faces)
    as_it_lies = held(mesh, reference).report
    assert as_it_lies.mean_mm > 100.0
    assert as_it_lies.by_view["long_axis"].dice_mean == 0.0
    found = held(mesh, reference, ReferenceOptions(samples=4000, align=True, curvature_edge_mm=4.0))
    np.testing.assert_allclose(found.reference.vertices_mm, mesh.vertices_mm, atol=0.01)
    assert found.report.hausdorff_mm < 0.01
    assert found.report.placement.rotation_deg == pytest.approx(5.0, abs=0.01)
    assert found.report.placement.translation_mm == pytest.approx(away, abs=0.01)
    assert found.report.by_view["long_axis"].dice_min > 0.999
    assert found.report.by_region_mm.keys() == {"apex", "mid", "base", "septum", "free_wall"}
    assert found.report.curvature.mean_per_mm.rms < 0.05


def test_the_seed_decides() -> None:
    reference = ball(20.0, (1.0, 0.0, 0.0))
    assert held(BALL, reference).report == held(BALL, reference).report


class _Patient(Unobserved):
    """Stops at the n-th time of asking."""

    def __init__(self, times: int) -> None:
        self.left = times

    def is_cancelled(self) -> bool:
        self.left -= 1
        return self.left < 0


def test_it_can_be_stopped_between_all_parts() -> None:
    def run(observer: _Patient) -> None:
        reference_report(
            BALL,
            ball(20.0),
            regions=REGIONS,
            planes=PLANES,
            options=ReferenceOptions(samples=100, align=True, curvature_edge_mm=None),
            seed=0,
            observer=observer,
        )

    counter = _Patient(10**6)
    run(counter)
    asked = 10**6 - counter.left
    assert asked > len(PLANES) + 4
    for times in (0, asked // 2, asked - 1):
        with pytest.raises(Cancelled):
            run(_Patient(times))
