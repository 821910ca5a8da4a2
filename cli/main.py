"""The `neuralmri` command: one file a subcommand, and what an error means for the exit code.

0 done, 1 our fault, 2 bad input, 130 interrupted.
"""

import sys

import typer

from cli.console import complain
from cli.demo import demo
from cli.evaluate import evaluate
from cli.phantom import phantom
from cli.reconstruct import reconstruct
from cli.serve import serve
from cli.slice import slice_
from cli.submit import submit
from schemas.problem import InputError, ServiceError

EXIT_OUR_FAULT = 1
EXIT_BAD_INPUT = 2

app = typer.Typer(
    name="neuralmri",
    help="Sparse planar heart segmentations in, simulation-ready 3D surfaces out.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
app.command()(serve)
app.command()(reconstruct)
app.command()(submit)
app.command()(evaluate)
app.command("slice")(slice_)
app.command()(phantom)
app.command()(demo)


def main() -> None:
    """Run the command line of this process. An expected failure is told in one sentence."""
    try:
        app()
    except ServiceError as error:
        complain(error, as_json="--json" in sys.argv)
        sys.exit(EXIT_BAD_INPUT if isinstance(error, InputError) else EXIT_OUR_FAULT)
    except KeyboardInterrupt:
        sys.exit(130)
