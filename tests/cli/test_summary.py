"""What a person at a terminal is told of a report."""

import pytest

from cli.summary import print_summary
from schemas.cycle_report import ChamberCycleReport, CycleReport, LeftVentricleCycleReport
from schemas.report import FunctionReport
from schemas.vocabulary import Structure
from tests.worker.artifacts.page.example_report import report

PUMP = FunctionReport(
    ed_frame="F00",
    es_frame="F09",
    lv_edv_ml=120.0,
    lv_esv_ml=48.0,
    lv_stroke_volume_ml=72.0,
    lv_ejection_fraction_percent=60.0,
)


def cycle(filling_ml_per_s: float | None) -> CycleReport:
    left = ChamberCycleReport(
        ed_frame="F00",
        es_frame="F09",
        edv_ml=120.0,
        esv_ml=48.0,
        stroke_volume_ml=72.0,
        ejection_fraction_percent=60.0,
        peak_ejection_rate_ml_per_s=None if filling_ml_per_s is None else 425.7,
        peak_filling_rate_ml_per_s=filling_ml_per_s,
        jitter_ml=2.0,
    )
    return CycleReport(
        frames=["F00", "F01", "F02"],
        times_ms=None,
        is_whole_cycle=True,
        ed_frame="F00",
        chambers={Structure.LV_ENDO: left},
        surfaces={},
        left_ventricle=LeftVentricleCycleReport(
            longitudinal_shortening_percent=[None] * 3,
            circumferential_shortening_percent=[None] * 3,
            wall_mass_g=[None] * 3,
            wall_thickness_mm={},
            wall_thickening_percent={},
        ),
    )


def test_the_pump_is_named_with_its_frames(capsys: pytest.CaptureFixture[str]) -> None:
    print_summary(report(function=PUMP, cycle=cycle(543.5)))
    said = " ".join(capsys.readouterr().out.split())
    assert "ejection fraction 60.0 %, stroke volume 72.0 mL (F00 to F09)" in said
    assert "lv_endo: peak ejection 426 mL/s, peak filling 544 mL/s" in said


def test_rates_that_are_not_known_are_not_named(capsys: pytest.CaptureFixture[str]) -> None:
    print_summary(report(function=None, cycle=cycle(None)))
    said = capsys.readouterr().out
    assert "peak" not in said
    assert "ejection" not in said
