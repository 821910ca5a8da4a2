"""The one method here that takes every slice, whatever its direction, closed or open."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from schemas.problem import InputError
from schemas.vocabulary import View
from tests.worker.interpolation.stacks import STRUCTURE, ellipsoid, heights_mm
from worker.evaluation.topology import euler_number, is_outward
from worker.interpolation.hermite_rbf import hermite_rbf

QUICK: dict[str, Any] = {"spacing_mm": 4.0, "cell_mm": 2.0}


PUBLISHED: dict[str, Any] = {"solves": 1, "off_surface_mm": 1.0, "smoothing": 0.0}


@pytest.mark.parametrize("options", [QUICK, {**QUICK, **PUBLISHED}])
def test_slices_that_contradict_each_other_do_not_shatter_it(options: dict[str, Any]) -> None:
    shifts = (3.0, -2.5, 0.0, 3.5, -3.0, 2.0, -3.5, 1.0, -2.0)
    truth = ellipsoid(shifts_mm=shifts)
    mesh = hermite_rbf(truth.stack, STRUCTURE, **options)
    assert is_outward(mesh)
    assert euler_number(mesh) == 2
    assert np.abs(truth.off_mm(mesh.vertices_mm)).max() <= 5.0


def test_one_solve_takes_each_slice_for_perpendicular_and_further_ones_do_not() -> None:
    truth = ellipsoid()
    published = hermite_rbf(truth.stack, STRUCTURE, **QUICK, **PUBLISHED)
    refined = hermite_rbf(truth.stack, STRUCTURE, **QUICK)
    error = [np.abs(truth.off_mm(m.vertices_mm)).mean() for m in (refined, published)]
    assert error[0] < error[1] <= 0.3


def test_the_long_axis_holds_displaced_slices() -> None:
    """The first five slices are displaced alike: the surface stays nearer to the long axis."""
    truth = ellipsoid(shifts_mm=(4.0, 4.0, 4.0, 4.0, 4.0))
    axial = tuple(s for s in truth.stack.slices if s.view is View.SAX)
    held = hermite_rbf(truth.stack, STRUCTURE, **QUICK)
    alone = hermite_rbf(replace(truth.stack, slices=axial), STRUCTURE, **QUICK)
    error = [np.abs(truth.off_mm(mesh.vertices_mm)).mean() for mesh in (held, alone)]
    assert error[0] < 0.7 * error[1]


def test_open_outlines_end_about_their_chord() -> None:
    truth = ellipsoid(open_above_mm=12.0)
    mesh = hermite_rbf(truth.stack, STRUCTURE, **QUICK)
    heights = heights_mm(mesh.vertices_mm)
    assert is_outward(mesh)
    assert 9.0 <= heights.max() <= 18.0
    assert np.abs(truth.off_mm(mesh.vertices_mm[heights < 4.0])).mean() <= 0.15


def test_long_axis_slices_alone_are_enough() -> None:
    truth = ellipsoid()
    long_axis = tuple(s for s in truth.stack.slices if s.view is not View.SAX)
    mesh = hermite_rbf(replace(truth.stack, slices=long_axis), STRUCTURE, **QUICK)
    assert is_outward(mesh)
    assert np.abs(truth.off_mm(mesh.vertices_mm)).mean() <= 2.0


def test_one_long_axis_slice_is_refused() -> None:
    stack = ellipsoid().stack
    with pytest.raises(InputError, match="different planes"):
        hermite_rbf(replace(stack, slices=stack.slices[-1:]), STRUCTURE)


def test_it_loads_no_torch() -> None:
    code = "import sys, worker.interpolation.hermite_rbf; print('torch' in sys.modules)"
    root = Path(__file__).parents[3]
    ended = subprocess.run(
        [sys.executable, "-c", code], cwd=root, capture_output=True, text=True, check=True
    )
    assert ended.stdout.strip() == "False"
