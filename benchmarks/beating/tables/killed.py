"""A job that was interrupted."""

from benchmarks.beating.results import KilledRun
from benchmarks.tables.markdown import number, table


def killed(run: KilledRun) -> str:
    """What became of the job."""
    same = ", ".join(f"{count} {verdict}" for verdict, count in run.artifacts.items())
    rows = [
        ("frames", str(run.frames)),
        ("fitted when the process was killed", str(run.finished)),
        ("of these taken up by the next attempt", str(run.taken_up)),
        ("of these fitted again", str(run.fitted_again)),
        ("attempts", str(run.attempts)),
        ("from the kill until the next attempt ran, s", number(run.noticed_s, 1)),
        ("from the kill until the next frame was fitted, s", number(run.next_frame_s, 1)),
        ("whole job, s", number(run.broken_s, 1)),
        ("the same job unbroken, s", number(run.unbroken_s, 1)),
        ("artifacts beside those of the unbroken job", same),
    ]
    if run.not_the_same:
        rows.append(("not the same", ", ".join(run.not_the_same)))
    return table(("", "measured"), rows)
