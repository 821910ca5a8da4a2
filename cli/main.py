"""The `neuralmri` command: one file a subcommand, and what an error means for the exit code.

0 done, 1 our fault, 2 bad input, 130 interrupted.
"""

import errno
import sys
from typing import NoReturn

import typer

from cli.ablate import ablate
from cli.audit import audit
from cli.cancel import cancel
from cli.console import complain
from cli.convert import convert
from cli.demo import demo
from cli.download import download
from cli.erase import erase
from cli.evaluate import evaluate
from cli.exit_code import exit_code
from cli.keys import keys
from cli.list_jobs import list_jobs
from cli.phantom import phantom
from cli.reconstruct import reconstruct
from cli.rerun import rerun
from cli.serve import serve
from cli.slice import slice_
from cli.submit import submit
from cli.submit_batch import submit_batch
from cli.watch import watch
from cli.webhooks import webhooks
from schemas.problem import InputError, InternalError, ProblemType, ServiceError

_FULL = (errno.ENOSPC, errno.EDQUOT)

app = typer.Typer(
    name="neuralmri",
    help="Sparse planar heart segmentations in, simulation-ready 3D surfaces out.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)
app.command()(serve)
app.command()(reconstruct)
app.command()(submit)
app.command()(submit_batch)
app.command("list")(list_jobs)
app.command()(cancel)
app.command()(erase)
app.command()(download)
app.command()(watch)
app.command()(rerun)
app.command()(evaluate)
app.command()(ablate)
app.command("slice")(slice_)
app.command()(convert)
app.command()(audit)
app.command()(phantom)
app.command()(demo)
app.add_typer(keys)
app.add_typer(webhooks)


def main() -> None:
    """Run the command line of this process. An expected failure is told in one sentence."""
    try:
        app()
    except ServiceError as error:
        _fail(error)
    except OSError as error:
        if error.filename is None and error.errno not in _FULL:
            raise
        _fail(_of_file(error))
    except KeyboardInterrupt:
        sys.exit(130)


def _fail(error: ServiceError) -> NoReturn:
    complain(error, as_json="--json" in sys.argv)
    sys.exit(exit_code(error))


def _of_file(error: OSError) -> ServiceError:
    """A file or folder that cannot be used: nearly always one that the command line named."""
    where = f"{error.filename}: " if error.filename else ""
    if error.errno in _FULL:
        return InternalError(
            ProblemType.STORAGE_FULL, f"{where}{error.strerror}; make room and try again"
        )
    return InputError(
        ProblemType.INVALID_REQUEST,
        f"{where}{error.strerror}; choose another place, or correct its permissions",
    )
