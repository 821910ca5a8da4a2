"""Leave-one-slice-out beside the truth: rows of a real case, and tables with known numbers."""

import pytest

from benchmarks.cases import Case
from benchmarks.environment import environment
from benchmarks.holdout import surface_rows
from benchmarks.holdout_results import HoldoutResults, SliceRow, SurfaceRow
from benchmarks.tables.holdout import by_surface, in_short
from schemas.options import Options
from schemas.vocabulary import Structure
from worker.phantom import SlicingPlan, heart, slice_meshes


def surface(case: str, held_out_mm: float, true_mm: float) -> SurfaceRow:
    return SurfaceRow(
        case=case,
        surface=Structure.LV_ENDO,
        slices=9,
        times_plain_fit=5.0,
        held_out_mm=held_out_mm,
        true_mm=true_mm,
        by_slice=[SliceRow(held_out_mm=held_out_mm, true_mm=true_mm)],
    )


@pytest.fixture
def results() -> HoldoutResults:
    rows = [surface(f"phantom {i}", 2.0**i, 2.0 ** (i - 1)) for i in range(4)]
    return HoldoutResults(environment=environment(), surfaces=rows)


def test_errors_in_one_ratio_correlate_fully(results: HoldoutResults) -> None:
    text = in_short(results)
    assert "| all surfaces | 4 | 1.00 | 1.00 | 2.0 | 2.0 | 2.0 |" in text
    assert "| surfaces of anatomy | 0 | - | - | - | - | - |" in text
    assert "| all slices | 4 | 1.00 | 1.00 | 2.0 | 2.0 | 2.0 |" in text


def test_every_surface_has_its_ratio(results: HoldoutResults) -> None:
    assert "| phantom 3 | lv_endo | 9 | 8.00 | 4.00 | 2.0 |" in by_surface(results)


@pytest.mark.slow
def test_rows_of_a_phantom() -> None:
    truth = heart(0.0).meshes(3.0)
    plan = SlicingPlan(
        spacing_mm=14.0, long_axis_planes=2, shift_sd_mm=0.0, noise_sd_mm=0.0, margin_mm=0.0
    )
    options = Options.model_validate(
        {
            "levels": 3,
            "iterations_per_level": 40,
            "optimizer": {"samples_per_step": 512},
            "mesh": {"grid_mm": 4.0},
        }
    )
    rows = surface_rows(Case("phantom", slice_meshes(truth, plan).study, truth, plan), options)
    assert {row.surface for row in rows} == set(truth)
    for row in rows:
        assert row.slices >= len(row.by_slice) > 0
        assert 0.0 < row.true_mm < row.held_out_mm < 20.0
        assert row.times_plain_fit > 1.0
