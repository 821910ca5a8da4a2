"""A bar on standard error that shows how far a job has come."""

from collections.abc import Iterator
from contextlib import contextmanager

from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeElapsedColumn

from cli.console import notice_console
from schemas.job import Progress as JobProgress


class ProgressBar:
    """Shows progress; as an observer it never asks to stop."""

    def __init__(self, bar: Progress, task: TaskID) -> None:
        self._bar = bar
        self._task = task

    def advanced(self, progress: JobProgress) -> None:
        self._bar.update(self._task, completed=progress.fraction, description=_describe(progress))

    def is_cancelled(self) -> bool:
        return False


@contextmanager
def progress_bar(what: str, *, quiet: bool) -> Iterator[ProgressBar]:
    """A bar for as long as the block lasts; where `quiet`, none."""
    bar = Progress(
        TextColumn("{task.fields[what]}", markup=False),
        BarColumn(),
        TextColumn("{task.percentage:>3.0f} %"),
        TimeElapsedColumn(),
        TextColumn("{task.description}", markup=False),
        console=notice_console,
        disable=quiet,
    )
    with bar:
        yield ProgressBar(bar, bar.add_task("", total=1.0, what=what))


def _describe(progress: JobProgress) -> str:
    parts = [progress.stage.value]
    if progress.frame is not None:
        parts.append(progress.frame)
    if progress.level is not None:
        parts.append(f"level {progress.level}")
    if progress.loss is not None:
        parts.append(f"loss {progress.loss:.4f}")
    return ", ".join(parts)
