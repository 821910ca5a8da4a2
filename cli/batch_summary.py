"""What a batch came to, for people and for the exit code."""

from cli.console import notice_console, say
from cli.exit_code import EXIT_BAD_INPUT, EXIT_OUR_FAULT
from schemas.batch import Batch, MemberState
from schemas.problem import Fault

_BAD = (MemberState.REFUSED, MemberState.FAILED, MemberState.CANCELLED, MemberState.ERASED)


def say_batch(batch: Batch) -> None:
    """A line for each study: job, state, name, and why not."""
    for member in batch.studies:
        why = f"  {member.error.detail}" if member.error else ""
        say(f"{member.job_id or '-':<32}  {member.state:<10}  {member.name or '-'}{why}")


def notice_refusals(batch: Batch) -> None:
    """What was refused at once, on standard error."""
    for member in batch.studies:
        if member.state is MemberState.REFUSED and member.error is not None:
            notice_console.print(
                f"refused: {member.name or member.error.pointer}: {member.error.detail}",
                markup=False,
                soft_wrap=True,
            )


def counts_line(batch: Batch) -> str:
    """How many stand in each state, those that there are."""
    return ", ".join(f"{count} {state}" for state, count in batch.counts.items() if count)


def batch_exit_code(batch: Batch) -> int:
    """0 where nothing went wrong, 1 where something is our fault, else 2."""
    bad = [member for member in batch.studies if member.state in _BAD]
    if any(member.error and member.error.fault is Fault.SERVICE for member in bad):
        return EXIT_OUR_FAULT
    return EXIT_BAD_INPUT if bad else 0
