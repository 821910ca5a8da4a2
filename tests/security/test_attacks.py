"""Every row of the table of attacks, on a real service; and the page has the same rows."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from benchmarks.attacks.__main__ import PAGE, table
from benchmarks.attacks.catalogue import CATALOGUE
from benchmarks.attacks.target import Attack, Target, target
from benchmarks.attacks.written import write_section


@pytest.fixture(scope="module")
def victim(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Target]:
    with target(tmp_path_factory.mktemp("attacked") / "data") as attacked:
        yield attacked


@pytest.mark.slow
@pytest.mark.integration
@pytest.mark.parametrize(
    "attack", [a for of in CATALOGUE.values() for a in of], ids=lambda attack: attack.name[:60]
)
def test_the_answer_is_the_one_expected(victim: Target, attack: Attack) -> None:
    assert attack.strike(victim) == attack.expected
    assert victim.is_well(), "others are served, and the victim's job is untouched"


def test_the_page_has_the_table() -> None:
    assert f"<!-- attacks -->\n{table()}\n<!-- /attacks -->" in PAGE.read_text(encoding="utf-8")


def test_a_section_is_written_in_its_place_alone(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("a\n<!-- x -->\nold\n<!-- /x -->\nb\n")
    write_section(page, "x", "new")
    assert page.read_text() == "a\n<!-- x -->\nnew\n<!-- /x -->\nb\n"
    with pytest.raises(ValueError, match="no place for y"):
        write_section(page, "y", "new")
