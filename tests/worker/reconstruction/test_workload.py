"""What would not fit into memory is refused with the option and a value that fits."""

import re

import numpy as np
import pytest

from schemas.options import Options
from schemas.problem import InputError, ProblemType
from worker.reconstruction.hull import Hull, inflated_hull
from worker.reconstruction.workload import check_workload


@pytest.fixture
def hull() -> Hull:
    corners = np.array(np.meshgrid(*[(-1.0, 1.0)] * 3)).reshape(3, -1).T
    return inflated_hull(corners, 1.1)


def test_a_lattice_that_is_too_fine_names_one_that_fits(hull: Hull) -> None:
    horse_mm = 120.0
    options = Options()

    def check(cell_mm: float) -> None:
        check_workload(20, hull, cell_mm, cell_mm / horse_mm, 3, options)

    check(1.25)
    with pytest.raises(InputError) as refused:
        check(0.5)
    assert refused.value.type is ProblemType.TOO_LARGE
    assert refused.value.pointer == "/options/mesh/grid_mm"
    (named,) = re.findall(r"`mesh.grid_mm` to ([0-9.]+)", refused.value.detail)
    check(float(named))


def test_samples_are_counted_over_slices_and_levels(hull: Hull) -> None:
    sampling = {"contour_samples_per_plane": 50000, "uniform_samples_per_plane": 50000}
    many = Options.model_validate({"sampling": sampling})
    check_workload(10, hull, 1.25, 0.02, 3, many)
    with pytest.raises(InputError, match="contour_samples_per_plane") as refused:
        check_workload(40, hull, 1.25, 0.02, 3, many)
    assert refused.value.pointer == "/options/sampling"
    one_level = many.model_copy(update={"levels": 1})
    check_workload(40, hull, 1.25, 0.02, 3, one_level)
