"""Refinement that ends early: the ladder's law in closed form, then a small run on the phantom."""

import numpy as np
import pytest

from schemas.job import Progress
from schemas.options import Holdout, Options
from schemas.problem import InputError
from schemas.study import ContourStudy
from schemas.vocabulary import Structure
from worker.ablation import ablate, check_references, up_to_level
from worker.evaluation.comparison import compared
from worker.observer import Unobserved
from worker.phantom import heart
from worker.phantom.standard_study import standard_study
from worker.reconstruction.sampling import level_radius
from worker.surface_mesh import SurfaceMesh

QUICK = Options.model_validate(
    {
        "preset": "fast",
        "levels": 3,
        "iterations_per_level": 60,
        "mesh": {"grid_mm": 4.0},
        "reference": {"samples": 2000, "curvature_edge_mm": 4.0},
        "holdout": "leave_one_slice_out",
        "ensemble": 3,
        "surfaces": ["lv_endo", "lv_epi"],
    }
)


@pytest.fixture(scope="module")
def study() -> ContourStudy:
    return standard_study(edge_mm=3.0)


@pytest.fixture(scope="module")
def truth() -> SurfaceMesh:
    return heart(0.0).meshes(2.0)[Structure.LV_ENDO]


def _radii(options: Options) -> list[float]:
    return [level_radius(n, options.levels, options.sampling) for n in range(options.levels)]


@pytest.mark.parametrize("level", range(6))
def test_the_radii_of_a_shortened_fit_are_the_first_of_the_full_ladder(level: int) -> None:
    full = Options()
    # 1/16 to 1/256 in five equal ratios.
    closed_form = [2.0 ** (-4.0 - 4.0 * n / 5.0) for n in range(level + 1)]
    assert _radii(up_to_level(level, full)) == pytest.approx(closed_form, rel=1e-12)
    assert _radii(full)[: level + 1] == pytest.approx(closed_form, rel=1e-12)


@pytest.mark.parametrize(("first", "last", "levels"), [(0.2, 0.001, 8), (0.05, 0.05, 4)])
def test_so_they_are_of_any_ladder(first: float, last: float, levels: int) -> None:
    sampling = {"first_radius": first, "last_radius": last}
    full = Options.model_validate({"levels": levels, "sampling": sampling})
    for level in range(levels):
        assert _radii(up_to_level(level, full)) == pytest.approx(_radii(full)[: level + 1])


def test_nothing_but_the_ladder_is_changed() -> None:
    full = Options(seed=7)
    short = up_to_level(2, full)
    assert (short.levels, short.iterations_per_level) == (3, full.iterations_per_level)
    same = {"exclude": {"levels": True, "sampling": {"last_radius"}}}
    assert short.model_dump(**same) == full.model_dump(**same)
    assert Options.model_validate(short.model_dump()) == short
    assert up_to_level(5, full) is full, "the last is the full fit, to the last bit"


@pytest.mark.parametrize("level", [-1, 6])
def test_a_level_that_is_not_there_is_the_callers_fault(level: int) -> None:
    with pytest.raises(InputError, match=r"choose from 0 to 5, or raise `levels`"):
        up_to_level(level, Options())


def test_references_are_of_surfaces_that_there_will_be(study: ContourStudy) -> None:
    check_references(["ED_lv_endo", "ED_lv_epi"], study, QUICK)
    for name in ("ES_lv_endo", "ED_rv_endo", "heart"):
        with pytest.raises(InputError, match=f"{name}.*Remedy"):
            check_references([name], study, QUICK)


def test_levels_are_compared_where_they_lie(study: ContourStudy) -> None:
    moved = Options.model_validate({"reference": {"align": True}})
    check_references([], study, moved)
    with pytest.raises(InputError, match=r"leave `reference.align` out"):
        check_references(["ED_lv_endo"], study, moved)


class _Watcher(Unobserved):
    def __init__(self) -> None:
        self.fractions: list[float] = []

    def advanced(self, progress: Progress) -> None:
        self.fractions.append(progress.fraction)


@pytest.mark.slow
def test_every_level_is_a_row_and_the_last_is_the_full_fit(
    study: ContourStudy, truth: SurfaceMesh
) -> None:
    from worker.reconstruction.pipeline import reconstruct

    watcher = _Watcher()
    found = ablate(study, QUICK, [0, 2], {"ED_lv_endo": truth}, watcher)

    assert [(one.row.level, one.row.surface) for one in found] == [
        (0, "lv_endo"),
        (0, "lv_epi"),
        (2, "lv_endo"),
        (2, "lv_epi"),
    ]
    first, other, last, _ = found
    assert (first.row.iterations, last.row.iterations) == (60, 180)
    assert last.row.radius_mm == pytest.approx(first.row.radius_mm / 16.0)
    assert last.row.contour_residual_mean_mm < first.row.contour_residual_mean_mm
    assert other.row.reference is None
    assert other.distance_mm is None

    once = QUICK.model_copy(update={"holdout": Holdout.NONE, "ensemble": 0})
    full = reconstruct(study, once).frames[0].surfaces[Structure.LV_ENDO]
    np.testing.assert_array_equal(last.mesh.vertices_mm, full.vertices_mm)

    held, same = last.row.reference, compared(full, truth, 2000, curvature_edge_mm=4.0)
    assert held is not None
    assert held.mean_mm == same.surface_distance.mean_mm
    assert held.hausdorff95_mm == same.surface_distance.hausdorff95_mm
    assert held.point_set_chamfer_mm2 == same.point_set_distance.chamfer_mm2
    assert held.volume_difference_percent == same.volume_difference_percent
    assert same.curvature is not None
    assert held.gaussian_curvature_mean_abs_per_mm2 == same.curvature.gaussian_per_mm2.mean_abs
    assert last.distance_mm is not None
    assert last.distance_mm.shape == (len(full.vertices_mm),)
    assert held.mean_mm / 2.0 < last.distance_mm.mean() < 2.0 * held.mean_mm

    assert watcher.fractions == sorted(watcher.fractions), "progress never goes back"
    assert 0.0 <= watcher.fractions[0] < 0.1
    assert watcher.fractions[-1] == pytest.approx(1.0)
