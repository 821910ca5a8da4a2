"""The documents agree with the tree: links lead somewhere, named files exist."""

import re
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

from service.settings import ServiceSettings
from worker.settings import WorkerSettings

ROOT = Path(__file__).parents[1]
_FOLDERS = sorted(
    path.name for path in ROOT.iterdir() if path.is_dir() and path.name[0] not in "._"
)
DOCUMENTS = sorted(
    [*ROOT.glob("*.md"), *(path for folder in _FOLDERS for path in (ROOT / folder).rglob("*.md"))]
)

every_document = pytest.mark.parametrize(
    "document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT))
)


def prose(text: str) -> str:
    """A document without its fenced blocks."""
    return re.sub(r"^(`{3,})[^\n]*\n.*?^\1\s*$", "", text, flags=re.MULTILINE | re.DOTALL)


def links(text: str) -> Iterator[str]:
    """Targets of links and images, inline or by reference, without code spans."""
    spoken = re.sub(r"`[^`\n]*`", "", prose(text))
    yield from re.findall(r"\]\(\s*<?([^)\s>]+)", spoken)
    yield from re.findall(r"^\[[^\]]+\]:\s*<?([^\s>]+)", spoken, re.MULTILINE)


def anchors(document: Path) -> set[str]:
    """Names that a link's fragment can have: headings as the forge spells them."""
    headings = re.findall(r"^#+\s+(.+?)\s*$", prose(document.read_text()), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def repository_paths(text: str) -> Iterator[str]:
    """Code spans that name a file or folder below a top-level folder of this tree."""
    for span in re.findall(r"`([^`\n]+)`", prose(text)):
        first, slash, _ = span.partition("/")
        if slash and first in _FOLDERS and re.fullmatch(r"[\w./-]+", span):
            yield span


@every_document
def test_relative_links_lead_somewhere(document: Path) -> None:
    broken = []
    for link in links(document.read_text()):
        if re.match(r"[a-z][a-z0-9+.-]*:", link):
            continue
        path, _, fragment = link.partition("#")
        target = (document.parent / path).resolve() if path else document
        there = target.exists() and target.is_relative_to(ROOT)
        if there and fragment and target.suffix == ".md":
            there = fragment in anchors(target)
        if not there:
            broken.append(link)
    assert not broken


@every_document
def test_paths_that_it_names_exist(document: Path) -> None:
    named = set(repository_paths(document.read_text()))
    assert not {path for path in named if not (ROOT / path).exists()}


@every_document
def test_commands_read_files_that_exist(document: Path) -> None:
    """Files of the tree that a shell block hands to a command."""
    blocks = re.findall(
        r"^```(?:sh|bash|shell|console)\n(.*?)^```", document.read_text(), re.M | re.S
    )
    inputs = {
        name
        for block in blocks
        for name in re.findall(r"(?<![\w/.-])((?:examples|docker)/[\w./-]*\w\.\w+)", block)
    }
    assert not {name for name in inputs if not (ROOT / name).exists()}


def test_the_checks_find_what_is_wrong() -> None:
    text = "See [a](gone.md), `tests/gone.py`, `and/or`.\n```\n[b](fenced.md)\n```\n[c]: other.md\n"
    assert list(links(text)) == ["gone.md", "other.md"]
    assert list(repository_paths(text)) == ["tests/gone.py"]


def test_glossary_is_alphabetical_and_says_each_term_once() -> None:
    rows = re.findall(r"^\| (.+?) \|", (ROOT / "docs" / "glossary.md").read_text(), re.MULTILINE)
    terms = [row.lower().replace("-", " ") for row in rows[1:]]
    assert terms == sorted(set(terms))
    assert len(terms) > 50


def test_every_setting_is_documented_with_its_default() -> None:
    rows = re.findall(
        r"^\| `(NEURALMRI_\w+)` \| `([^`]*)` \|",
        (ROOT / "docs" / "deploy.md").read_text(),
        re.MULTILINE,
    )
    fields = ServiceSettings.model_fields | WorkerSettings.model_fields
    held = {f"NEURALMRI_{name.upper()}": str(field.default) for name, field in fields.items()}
    assert dict(rows) == held


def test_decisions_are_numbered_without_gaps() -> None:
    records = sorted((ROOT / "docs" / "adr").glob("*.md"))
    assert [int(path.name[:4]) for path in records] == list(range(1, len(records) + 1))
    for path in records:
        text = path.read_text()
        assert re.match(rf"# {int(path.name[:4])}\. ", text), path.name
        assert re.findall(r"^## (.+)$", text, re.MULTILINE)[:3] == [
            "Context",
            "Decision",
            "Consequences",
        ]


def test_changelog_has_a_section_for_what_is_being_made() -> None:
    version = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    text = (ROOT / "CHANGELOG.md").read_text()
    assert re.search(rf"^## \[?(Unreleased|{re.escape(version)})\]?", text, re.MULTILINE)
