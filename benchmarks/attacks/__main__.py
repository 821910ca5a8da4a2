"""Tries every attack on a service of its own, and writes the table into docs/reliability.md.

    python -m benchmarks.attacks [--check]

Exits with 1 where an answer is not the one expected; the table is written only where all are.
"""

import argparse
import sys
import tempfile
from pathlib import Path

from benchmarks.attacks.catalogue import CATALOGUE
from benchmarks.attacks.target import Attack, Target, target
from benchmarks.attacks.written import write_section

PAGE = Path(__file__).parents[2] / "docs" / "reliability.md"


def main() -> None:
    """Attack, compare, write."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.attacks", description=__doc__)
    parser.add_argument("--check", action="store_true", help="write nothing")
    arguments = parser.parse_args()
    failed = 0
    with (
        tempfile.TemporaryDirectory(prefix="attacked-") as folder,
        target(Path(folder) / "data") as victim,
    ):
        for attacks in CATALOGUE.values():
            failed += sum(not _is_answered(attack, victim) for attack in attacks)
    if not failed and not arguments.check:
        write_section(PAGE, "attacks", table())
    sys.exit(min(failed, 1))


def table() -> str:
    """Markdown, of attacks that were all answered as expected: what is expected is what came."""
    lines = []
    for group, attacks in CATALOGUE.items():
        lines += [f"### {group}", "", "| attack | expected, and got |", "|---|---|"]
        lines += [f"| {attack.name} | {attack.expected} |" for attack in attacks] + [""]
    return "\n".join(lines).rstrip()


def _is_answered(attack: Attack, victim: Target) -> bool:
    got = attack.strike(victim)
    is_right = got == attack.expected and victim.is_well()
    said = "ok" if is_right else f"expected {attack.expected}, got {got}"
    print(f"{attack.name}: {said}")
    return is_right


if __name__ == "__main__":
    main()
