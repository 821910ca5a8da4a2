import numpy as np
import pytest

from schemas.problem import InputError
from worker.phantom.beating import Infarct

INFARCT = Infarct(half_width_deg=30.0, edge_deg=25.0, low=0.4, high=0.8, edge=0.25)


def test_it_is_whole_within_and_nothing_beyond():
    degrees = np.array([100.0, 71.0, 129.0, 460.0, 44.0, 156.0, -80.0])
    np.testing.assert_allclose(INFARCT.around(np.radians(degrees))[0], [1, 1, 1, 1, 0, 0, 0])
    rises = np.array([0.4, 0.6, 0.8, 0.14, 1.06])
    np.testing.assert_allclose(INFARCT.along(rises)[0], [1, 1, 1, 0, 0])


def test_slopes_are_those_of_the_shares():
    at = np.linspace(-3.0, 3.0, 501)
    for share in (INFARCT.around, INFARCT.along):
        above, below = (share(at + step)[0] for step in (1e-6, -1e-6))
        np.testing.assert_allclose(share(at)[1], (above - below) / 2e-6, atol=1e-7)


def test_its_extent_is_its_share_over_all_angles():
    angles = np.linspace(0.0, 2.0 * np.pi, 20_001)[:-1]
    mean = INFARCT.around(angles)[0].sum() * 2.0 * np.pi / 20_000
    assert INFARCT.extent_rad == pytest.approx(mean, rel=1e-9)


@pytest.mark.parametrize("wrong", [{"edge": 0.0}, {"half_width_deg": 120.0}, {"low": 0.1}])
def test_an_infarct_that_fits_no_heart_is_refused(wrong):
    with pytest.raises(InputError, match="choose between"):
        Infarct(**wrong)
