"""Views of one heart are in one place."""

import numpy as np
import pytest

from schemas.problem import InputError, ProblemType
from schemas.vocabulary import View
from tests.labelmaps.heart_maps import SAX_AFFINE, SAX_SHAPE, sax
from worker.labelmaps.planes import PlaneStack
from worker.labelmaps.views import Extent, check_same_place, labelled_extent


def extent(x_mm: float, reach_mm: float = 50.0) -> Extent:
    return Extent(np.array([x_mm, 0.0, 0.0]), reach_mm)


def test_extent_of_a_heart() -> None:
    found = labelled_extent(PlaneStack(SAX_AFFINE, SAX_SHAPE, 2), [sax()])
    assert np.linalg.norm(found.centre_mm) < 20.0
    assert 35.0 < found.reach_mm < 60.0


@pytest.mark.parametrize(("apart_mm", "together"), [(0.0, True), (49.0, True), (51.0, False)])
def test_centres_lie_within_reach(apart_mm: float, together: bool) -> None:
    extents = {View.SAX: extent(0.0), View.LAX_2CH: extent(apart_mm, 20.0)}
    if together:
        check_same_place(extents)
    else:
        with pytest.raises(InputError, match="51 mm") as raised:
            check_same_place(extents)
        assert (raised.value.type, raised.value.pointer) == (
            ProblemType.MISMATCHED_VIEWS,
            "lax_2ch",
        )


def test_one_view_is_with_itself() -> None:
    check_same_place({View.SAX: extent(1e4)})
