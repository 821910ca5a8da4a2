"""Saying beforehand what takes longer than a plain fit."""

from cli.console import notice_console
from schemas.options import Holdout, Options
from schemas.study import ContourStudy


def tell_effort(study: ContourStudy, options: Options) -> None:
    """One line, where `holdout` or `ensemble` make the work many times that of a plain fit."""
    # Loads numpy, which looks up its thread count then.
    from intake.effort import effort

    plain = options.model_copy(update={"holdout": Holdout.NONE, "ensemble": 0})
    times = effort(study, options) / max(effort(study, plain), 1.0)
    if times > 1.0:
        notice_console.print(
            f"`holdout` and `ensemble` make this about {times:.0f} times the work of a plain fit.",
            markup=False,
            soft_wrap=True,
        )
