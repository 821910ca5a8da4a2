"""What was accepted, run through the worker's own code in this process, with little to fit.

A job that was accepted succeeds, or fails with an error that the caller can mend.
"""

import tempfile
from collections import Counter
from pathlib import Path

from intake.study import DEFAULT_LIMITS
from jobs.disk_store import DiskStore
from schemas.messages import JobRequest
from schemas.options import Holdout, Options
from schemas.problem import InputError, InternalError, ProblemType
from worker.observer import Unobserved
from worker.produce import produce

_LITTLE = {"levels": 1, "iterations_per_level": 5}
_ENOUGH = {"levels": 3, "iterations_per_level": 120}


class Science:
    """Runs every `every`-th of what it is given.

    outcomes: how many succeeded, or failed with which input error.
    """

    def __init__(self, every: int) -> None:
        self.outcomes: Counter[str] = Counter()
        self._every = every
        self._given = 0

    def __call__(self, request: JobRequest, inputs: dict[str, bytes]) -> None:
        self._given += 1
        if self._given % self._every == 0:
            self.outcomes[_outcome(request, inputs)] += 1


def _outcome(request: JobRequest, inputs: dict[str, bytes]) -> str:
    try:
        _run(_cheap(request, _LITTLE), inputs)
    except InputError as error:
        return error.type.value
    except InternalError as error:
        if error.type is not ProblemType.NO_SURFACE:
            raise
        return _second_chance(request, inputs)
    return "succeeded"


def _second_chance(request: JobRequest, inputs: dict[str, bytes]) -> str:
    """Five iterations may find nothing in a good study; these do not."""
    try:
        _run(_cheap(request, _ENOUGH), inputs)
    except InputError as error:
        return error.type.value
    return "succeeded at the second attempt"


def _run(request: JobRequest, inputs: dict[str, bytes]) -> None:
    with tempfile.TemporaryDirectory() as root:
        store = DiskStore(Path(root) / "jobs")
        folder = store.folder(request.job_id)
        folder.create(request, inputs)
        out_dir = Path(root) / "out"
        out_dir.mkdir()
        produce(folder, out_dir, Unobserved(), threads=1, limits=DEFAULT_LIMITS)


def _cheap(request: JobRequest, effort: dict[str, int]) -> JobRequest:
    """The same job with as little work as shows whether it can be done."""
    if request.contours is not None:
        cheap = _options(request.contours.options, effort)
        contours = request.contours.model_copy(update={"options": cheap})
        return request.model_copy(update={"contours": contours})
    if request.labels is not None:
        cheap = _options(request.labels.options, effort)
        labels = request.labels.model_copy(update={"options": cheap})
        return request.model_copy(update={"labels": labels})
    raise ValueError("the request asks for nothing")


def _options(options: Options, effort: dict[str, int]) -> Options:
    grid_mm = max(options.mesh.grid_mm, 4.0)
    return options.model_copy(
        update={
            **effort,
            "mesh": options.mesh.model_copy(update={"grid_mm": grid_mm}),
            "ensemble": min(options.ensemble, 1),
            "holdout": Holdout.NONE,
        }
    )
