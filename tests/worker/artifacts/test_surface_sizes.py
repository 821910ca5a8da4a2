from schemas.vocabulary import Structure
from tests.worker.artifacts.page.example_report import frame_report, surface_report
from worker.artifacts.surface_sizes import areas_cm2, volumes_ml


def test_sizes_are_none_where_they_are_not_known() -> None:
    closed = surface_report(volume_ml=90.0, area_cm2=3.0)
    opened = surface_report(volume_ml=None, area_cm2=2.0)
    some = [
        frame_report(surfaces={structure: surface})
        for structure, surface in (
            (Structure.LV_ENDO, closed),
            (Structure.LV_ENDO, opened),
            (Structure.RV_ENDO, closed),
        )
    ]
    assert volumes_ml(some, Structure.LV_ENDO) == [90.0, None, None]
    assert areas_cm2(some, Structure.LV_ENDO) == [3.0, 2.0, None]
