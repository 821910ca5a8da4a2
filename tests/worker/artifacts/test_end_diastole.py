import pytest

from schemas.vocabulary import Structure
from tests.worker.artifacts.page.example_report import frame_report, surface_report
from worker.artifacts.end_diastole import end_diastole

LEFT, RIGHT, EPI = Structure.LV_ENDO, Structure.RV_ENDO, Structure.EPI
Sizes = dict[Structure, tuple[float | None, float]]


def frames(*sizes: Sizes):
    return [
        frame_report(
            surfaces={
                structure: surface_report(volume_ml=volume, area_cm2=area)
                for structure, (volume, area) in one.items()
            }
        )
        for one in sizes
    ]


@pytest.mark.parametrize(
    ("sizes", "index"),
    [
        # The left cavity, whatever the others say.
        ([{LEFT: (90.0, 1.0), RIGHT: (99.0, 9.0)}, {LEFT: (91.0, 1.0), RIGHT: (80.0, 1.0)}], 1),
        # Closed in one frame only, it still tells.
        ([{LEFT: (None, 9.0)}, {LEFT: (50.0, 1.0)}, {RIGHT: (300.0, 1.0)}], 1),
        # Nowhere closed: the right cavity, then any volume.
        ([{LEFT: (None, 9.0), RIGHT: (80.0, 1.0)}, {LEFT: (None, 1.0), RIGHT: (90.0, 1.0)}], 1),
        ([{LEFT: (None, 9.0), EPI: (80.0, 1.0)}, {LEFT: (None, 1.0), EPI: (90.0, 1.0)}], 1),
        # No volume at all: the left cavity's area.
        ([{LEFT: (None, 8.0), EPI: (None, 9.0)}, {LEFT: (None, 9.0), EPI: (None, 1.0)}], 1),
        ([{}, {}], 0),
    ],
)
def test_the_largest_of_what_tells_best(sizes: list[Sizes], index: int) -> None:
    assert end_diastole(frames(*sizes)) == index
