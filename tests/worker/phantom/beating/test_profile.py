import numpy as np
import pytest

from worker.phantom.beating import Infarct
from worker.phantom.beating.profile import Profile
from worker.phantom.contraction import layout
from worker.phantom.shape import HeartShape

PROFILE = Profile(layout(HeartShape(), 0.0), Infarct())


@pytest.mark.parametrize("curve", ["cavity_mm2", "outer_mm2", "squeeze", "infarct_along"])
def test_slopes_are_those_of_the_values(curve):
    # Not at the apices, where the squares of radii have a corner.
    height = np.linspace(-75.0, 22.0, 400)
    call = getattr(PROFILE, curve)
    above, below = (call(height + step)[0] for step in (1e-6, -1e-6))
    np.testing.assert_allclose(call(height)[1], (above - below) / 2e-6, rtol=1e-6, atol=1e-6)


def test_radii_are_those_of_the_ellipsoids():
    height = np.array([-80.0, -65.0, 0.0, 22.0])
    inner, outer = PROFILE.cavity_mm2(height)[0], PROFILE.outer_mm2(height)[0]
    assert (inner[:2] == 0.0).all()
    assert outer[0] == 0.0
    assert outer[1] > 0.0
    assert np.sqrt([inner[2], outer[2]]) == pytest.approx([24.5, 33.5])


def test_squeeze_is_none_below_the_cavity_and_nearly_whole_above():
    squeeze = PROFILE.squeeze(np.array([-70.0, -62.0, 0.0]))[0]
    np.testing.assert_allclose(squeeze, [0.0, 0.0, 1.0], atol=0.02)


def test_integrals_are_those_of_fine_sums():
    edges = np.linspace(-62.0, 22.0, 200_001)
    height, step = (edges[1:] + edges[:-1]) / 2.0, edges[1] - edges[0]
    density = PROFILE.squeeze(height)[0] * PROFILE.cavity_mm2(height)[0]
    assert PROFILE.squeezed_ml == pytest.approx(np.pi * density.sum() * step / 1e3, rel=1e-8)
    within = density * PROFILE.infarct_along(height)[0] * PROFILE.infarct.extent_rad / 2.0
    assert PROFILE.infarcted_ml == pytest.approx(within.sum() * step / 1e3, rel=1e-8)
    assert Profile(PROFILE.layout).infarcted_ml == 0.0
