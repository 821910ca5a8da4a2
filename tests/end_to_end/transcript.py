"""Shell transcripts in a document: what is typed, and what it should print.

A fenced block whose info string is `console` is a transcript. In it,

- a line that starts with `$ ` is a command; lines that start with `> ` continue it;
- what follows, up to the next command, is its standard output. `...` inside a line stands for any
  text, a line of `...` alone for any number of lines. No output lines: any output will do;
- `127.0.0.1:8000`, in commands and output, stands for the server that the test has started; the
  same server's address is in NEURALMRI_URL.

All transcripts of a document are one session of bash, in order, with `set -eu`: variables live on,
and the first command that fails ends it. Blocks with another info string (`sh`, `text`, ...) are
not run: the way to show a command that does not end, or that installs something.

A `python` block is a program of its own, run in a folder of its own; what it prints is not shown.
"""

import re
from dataclasses import dataclass

_BLOCK = re.compile(r"^```console\n(.*?)^```", re.MULTILINE | re.DOTALL)
_PROGRAM = re.compile(r"^```python\n(.*?)^```", re.MULTILINE | re.DOTALL)
SERVER = "127.0.0.1:8000"


@dataclass(frozen=True)
class Step:
    """One command and the lines it should print; none where its output does not matter."""

    command: str
    expected: tuple[str, ...]


def steps(document: str) -> list[Step]:
    """Every command of every transcript of a document, in order."""
    found = []
    for block in _BLOCK.findall(document):
        for part in re.split(r"^\$ ", block, flags=re.MULTILINE)[1:]:
            lines = part.rstrip("\n").split("\n")
            more = [line for line in lines[1:] if line.startswith("> ")]
            command = "\n".join([lines[0], *(line.removeprefix("> ") for line in more)])
            found.append(Step(command, tuple(lines[1 + len(more) :])))
    return found


def programs(document: str) -> list[str]:
    """Every Python program of a document, in order."""
    return _PROGRAM.findall(document)


def matches(expected: tuple[str, ...], printed: str) -> bool:
    """Whether a command printed what the document says."""
    if not expected:
        return True
    pattern = "".join(
        r"(?:.*\n)*" if line.strip() == "..." else _line_pattern(line) + r"\n" for line in expected
    )
    return re.fullmatch(pattern, printed.rstrip("\n") + "\n") is not None


def _line_pattern(line: str) -> str:
    return ".*".join(re.escape(part) for part in line.rstrip().split("...")) + r"[ \t]*"


def script(commands: list[str], marker: str) -> str:
    """One bash script that prints `marker` on a line of its own before each command."""
    return "set -eu -o pipefail\n" + "".join(
        f"printf '%s\\n' '{marker}'\n{command}\n" for command in commands
    )
