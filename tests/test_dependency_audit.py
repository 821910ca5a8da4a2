"""`make audit`: what is a finding, and what is nobody having been asked."""

import importlib.util
import tomllib
from datetime import date
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[1]
TODAY = date(2026, 1, 31)


@pytest.fixture(scope="module")
def audit() -> Any:
    spec = importlib.util.spec_from_file_location("audit", ROOT / ".ci" / "audit.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def package(name: str, *flaws: str) -> dict[str, Any]:
    vulns = [{"id": f, "aliases": [f"{f}-alias"], "fix_versions": ["2.0"]} for f in flaws]
    return {"name": name, "version": "1.0", "vulns": vulns}


UNKNOWN = {"name": "ours", "skip_reason": "not found"}
UNTIL_MARCH = [{"id": "CVE-1", "reason": "not loaded", "until": date(2026, 3, 1)}]
UNTIL_ADVENT = [{"id": "CVE-1", "reason": "not loaded", "until": date(2025, 12, 1)}]


@pytest.mark.parametrize(
    ("packages", "exceptions", "code", "said"),
    [
        ([package("a")], [], 0, "no known vulnerability in 1 packages"),
        ([package("a"), UNKNOWN], [], 0, "NOT AUDITED, unknown to the service: ours"),
        ([UNKNOWN, UNKNOWN], [], 3, "NOT AUDITED: the vulnerability service answered for no"),
        ([package("a", "CVE-1")], [], 1, "a 1.0: CVE-1, mended in 2.0"),
        ([UNKNOWN, package("a", "CVE-1")], [], 1, "a 1.0: CVE-1"),
        ([package("a", "CVE-1")], UNTIL_MARCH, 0, "no known vulnerability"),
        ([package("a", "CVE-2", "CVE-1")], UNTIL_MARCH, 1, "CVE-2"),
        ([package("a")], UNTIL_ADVENT, 1, "the exception for CVE-1 has run out"),
    ],
)
def test_a_report_is_judged(
    audit: Any, packages: list[Any], exceptions: list[Any], code: int, said: str
) -> None:
    found, lines = audit.verdict({"dependencies": packages}, "", exceptions, TODAY)
    assert found == code
    assert said in "\n".join(lines)


@pytest.mark.parametrize(
    ("last_words", "code"),
    [
        ("ERROR:pip_audit._cli:Could not connect to PyPI's vulnerability feed", 3),
        ("requests.exceptions.ConnectionError: Max retries exceeded with url", 3),
        ("python: No module named pip_audit", 3),
        ("ERROR:pip_audit._cli:requirement file is malformed", 2),
        ("", 2),
    ],
)
def test_without_a_report_only_silence_is_excused(audit: Any, last_words: str, code: int) -> None:
    assert audit.verdict(None, last_words, [], TODAY)[0] == code


@pytest.mark.parametrize(("required", "code"), [("", 0), ("1", 3)])
def test_not_to_have_asked_passes_unless_it_is_required(
    audit: Any,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    required: str,
    code: int,
) -> None:
    monkeypatch.setenv("NEURALMRI_REQUIRE_AUDIT", required)
    monkeypatch.setattr(audit, "asked", lambda: (None, "Could not connect"))
    assert audit.main() == code
    assert "NOT AUDITED" in capsys.readouterr().err


def test_every_exception_has_a_reason_and_an_end() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    for one in project["tool"]["neuralmri"]["audit"]["exceptions"]:
        assert one.keys() == {"id", "reason", "until"}
        assert one["reason"]
        assert isinstance(one["until"], date)
