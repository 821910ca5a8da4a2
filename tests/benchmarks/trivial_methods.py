"""Methods of a line each, for processes that tests start."""

import os
import sys
import time
from typing import NoReturn

import numpy as np

from benchmarks.found import Found
from schemas.study import ContourStudy
from schemas.vocabulary import Structure
from worker.surface_mesh import SurfaceMesh

CORNERS_MM = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
FACES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])


def works(study: ContourStudy) -> Found:
    """A tetrahedron in a fifth of a second and 100 MiB."""
    held = np.ones((100, 2**17))
    time.sleep(0.2)
    for library in ("OMP_NUM_THREADS", "IGL_NUM_THREADS", "ITK_GLOBAL_DEFAULT_NUMBER_OF_THREADS"):
        assert os.environ[library] == "1"
    assert "torch" not in sys.modules
    return Found(
        {Structure.LV_ENDO: SurfaceMesh(CORNERS_MM * held[0, 0], FACES)},
        {"sax-00": np.array([1.0, 2.0, 3.0])},
        {Structure.LV_EPI: "too few | slices"},
    )


def raises(study: ContourStudy) -> NoReturn:
    """Says why."""
    raise ValueError(f"{study.subject_id} is no heart")


def dies(study: ContourStudy) -> NoReturn:
    """Says nothing."""
    os._exit(7)


def sleeps(study: ContourStudy) -> NoReturn:
    """Does not end in time."""
    time.sleep(60.0)
    raise AssertionError
