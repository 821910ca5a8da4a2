"""What the fit costs beside its own matrix products, and how many subjects a machine does.

    python -m benchmarks.speed

Everything on the standard phantom with the standard preset, one thread a process. Machines are
noisy: what is compared is measured in turns, and medians are taken. Prints `results.Speed`.
"""

import sys
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing import get_context
from typing import Any

import torch
from torch.utils._python_dispatch import TorchDispatchMode

from benchmarks.results import Pair, Speed
from schemas.job import Progress, Stage
from schemas.options import Options
from schemas.study import ContourStudy
from worker.cores import usable_cores
from worker.observer import Cancelled
from worker.phantom import standard_study
from worker.reconstruction.pipeline import reconstruct
from worker.threads import bind_libraries, use_threads

_PAIRS = 5
_ROUNDS = 3
_SUBJECTS_A_WORKER = 2

Shapes = tuple[tuple[int, ...], tuple[int, ...]]
"""Of the two operands of a matrix product; three axes where it is a batch of products."""

_aten = torch.ops.aten
_OPERANDS = {_aten.mm: 0, _aten.bmm: 0, _aten.addmm: 1, _aten.baddbmm: 1}
"""Where the operands of each kind of product begin; what is added to a product is left out."""


@dataclass
class UntilMeshing:
    """An observer that ends a reconstruction when its field is fitted, and knows when that was."""

    fitted_at_s: float | None = None

    def advanced(self, progress: Progress) -> None:
        if progress.stage is Stage.MESHING and self.fitted_at_s is None:
            self.fitted_at_s = time.perf_counter()

    def is_cancelled(self) -> bool:
        return self.fitted_at_s is not None


class Products(TorchDispatchMode):
    """Notes the shapes of every matrix product, forward and backward, until the field is fitted."""

    def __init__(self, until: UntilMeshing) -> None:
        TorchDispatchMode.__init__(self)
        self.until = until
        self.shapes: list[Shapes] = []

    def __torch_dispatch__(
        self, func: Any, types: Any, args: tuple[Any, ...] = (), kwargs: Any = None
    ) -> Any:
        first = _OPERANDS.get(func.overloadpacket)
        if first is not None and not self.until.is_cancelled():
            self.shapes.append((tuple(args[first].shape), tuple(args[first + 1].shape)))
        return func(*args, **(kwargs or {}))


def fit_s(study: ContourStudy, until: UntilMeshing) -> float:
    """Seconds from the study to its fitted field: sampling and every step, no meshing."""
    start = time.perf_counter()
    with suppress(Cancelled):
        reconstruct(study, Options(), until)
    if until.fitted_at_s is None:
        raise RuntimeError("the reconstruction told of no meshing; see UntilMeshing")
    return until.fitted_at_s - start


def products_of(study: ContourStudy) -> list[Shapes]:
    """The matrix products of one fit, in their order."""
    until = UntilMeshing()
    with Products(until) as products:
        fit_s(study, until)
    return products.shapes


def products_s(shapes: Sequence[Shapes]) -> float:
    """Seconds that the same products take as plain float32 torch products, and nothing else."""
    generator = torch.Generator().manual_seed(0)
    operands = {
        shape: torch.randn(shape, generator=generator) for pair in set(shapes) for shape in pair
    }
    start = time.perf_counter()
    for left, right in shapes:
        torch.matmul(operands[left], operands[right])
    return time.perf_counter() - start


def flop(shapes: Sequence[Shapes]) -> int:
    """Multiplications and additions: twice the product of the three lengths, and of the batch."""
    return sum(2 * torch.Size(left).numel() * right[-1] for left, right in shapes)


def subject(study: ContourStudy) -> None:
    """One subject, from the study to its surfaces."""
    use_threads(1)
    reconstruct(study, Options())


def subjects_per_minute(pool: ProcessPoolExecutor, study: ContourStudy, count: int) -> float:
    """Throughput of a pool of warm workers on `count` copies of a study."""
    start = time.perf_counter()
    list(pool.map(subject, [study] * count))
    return 60.0 * count / (time.perf_counter() - start)


def speed() -> Speed:
    """Measure everything; about five minutes."""
    study = standard_study()
    shapes = products_of(study)
    pairs = []
    with torch.inference_mode():
        products_s(shapes)  # warm
    for _ in range(_PAIRS):
        own_s = fit_s(study, UntilMeshing())
        with torch.inference_mode():
            pairs.append(Pair(fit_s=own_s, products_s=products_s(shapes)))
        print(f"speed | fit beside its products | {pairs[-1]}", file=sys.stderr, flush=True)
    workers, spawn = usable_cores(), get_context("spawn")
    alone, together = [], []
    with (
        ProcessPoolExecutor(1, spawn) as one,
        ProcessPoolExecutor(workers, spawn) as all_,
    ):
        subjects_per_minute(one, study, 1)
        subjects_per_minute(all_, study, workers)
        for _ in range(_ROUNDS):
            alone.append(subjects_per_minute(one, study, _SUBJECTS_A_WORKER))
            together.append(subjects_per_minute(all_, study, workers * _SUBJECTS_A_WORKER))
            print(
                f"speed | subjects a minute | one process {alone[-1]:.2f}, "
                f"{workers} processes {together[-1]:.2f}",
                file=sys.stderr,
                flush=True,
            )
    return Speed(
        gflop=flop(shapes) / 1e9,
        products=len(shapes),
        pairs=pairs,
        workers=workers,
        subjects_per_minute_alone=alone,
        subjects_per_minute_together=together,
    )


if __name__ == "__main__":
    bind_libraries(1)
    use_threads(1)
    print(speed().model_dump_json())
