"""Where a security rule is set aside, the line says why."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
PROGRAMS = ("schemas", "intake", "jobs", "service", "worker", "cli", "docker", ".ci", "benchmarks")

_SUPPRESSED = re.compile(r"#\s*noqa:\s*(?:[A-Z]+\d+,\s*)*S\d+(?P<reason>.*)")


def test_every_suppressed_security_rule_has_its_reason() -> None:
    found = [
        (f"{path.relative_to(ROOT)}: {line.strip()}", suppressed["reason"].strip(" -"))
        for folder in PROGRAMS
        for path in sorted((ROOT / folder).rglob("*.py"))
        for line in path.read_text().splitlines()
        if (suppressed := _SUPPRESSED.search(line))
    ]
    assert len(found) >= 5, "the pattern finds those that there are"
    assert [line for line, reason in found if len(reason) < 4] == []


def test_no_file_sets_security_rules_aside_as_a_whole() -> None:
    for folder in PROGRAMS:
        for path in (ROOT / folder).rglob("*.py"):
            assert not re.search(r"#\s*ruff:\s*noqa", path.read_text()), path
