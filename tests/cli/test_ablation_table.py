import pytest

from cli.ablation_table import print_ablation
from worker.ablation_row import AblationRow, ReferenceErrors

HELD = ReferenceErrors(
    mean_mm=0.226,
    rms_mm=0.354,
    hausdorff95_mm=0.691,
    hausdorff_mm=14.454,
    point_set_chamfer_mm2=0.773,
    point_set_hausdorff_mm=14.488,
    volume_difference_percent=-0.05,
    gaussian_curvature_mean_abs_per_mm2=None,
    mean_curvature_mean_abs_per_mm=None,
)


def _row(level: int, surface: str, reference: ReferenceErrors | None) -> AblationRow:
    return AblationRow(
        level=level,
        iterations=120 * (level + 1),
        radius_mm=4.0,
        frame="ED",
        surface=surface,
        contour_residual_mean_mm=0.218,
        contour_residual_p95_mm=0.616,
        volume_ml=None if surface == "rv_endo" else 174.36,
        reference=reference,
    )


def test_a_table_a_surface_in_80_columns(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    surfaces = (("lv_endo", HELD), ("rv_endo", None))
    print_ablation(_row(level, name, held) for level in (0, 5) for name, held in surfaces)

    left, right = capsys.readouterr().out.split("ED_rv_endo")
    own, held = (
        ["0.218", "0.616", "174.4"],
        ["0.226", "0.354", "0.691", "14.454", "0.773", "14.488"],
    )
    lines = [line.split() for line in left.splitlines()]
    assert ["0", *own, *held] in lines
    assert ["5", *own, *held] in lines
    assert "Chamfer" in left
    assert "…" not in left + right, "nothing is cut off"
    assert ["5", "0.218", "0.616", "-"] in [line.split() for line in right.splitlines()]
    assert "Chamfer" not in right, "no columns for a reference that is not there"
