import pytest

from worker.evaluation.extremes import largest_and_smallest


@pytest.mark.parametrize(
    ("sizes", "found"),
    [
        ([90.0, None, 100.0, 40.0, None], (2, 3)),
        ([50.0, 50.0, 50.0], (0, 0)),
        ([90.0, 0.0, 100.0, None], None),
        ([], None),
    ],
)
def test_the_first_largest_and_smallest_of_three_or_more(
    sizes: list[float | None], found: tuple[int, int] | None
) -> None:
    assert largest_and_smallest(sizes) == found
