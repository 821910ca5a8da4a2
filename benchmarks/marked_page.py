"""Tables that a command writes into a page that people write: between two comments."""

import re
from pathlib import Path


def write_between_marks(page: Path, name: str, text: str) -> None:
    """Replace what stands between `<!-- name -->` and `<!-- /name -->`.

    Raises ValueError where the page has not these marks, each once.
    """
    marked = re.compile(rf"(<!-- {re.escape(name)} -->\n).*?(<!-- /{re.escape(name)} -->)", re.S)
    before = page.read_text(encoding="utf-8")
    after, count = marked.subn(lambda found: f"{found[1]}\n{text}\n\n{found[2]}", before)
    if count != 1:
        raise ValueError(f"{page} has {count} places for {name}, not one")
    page.write_text(after, encoding="utf-8")
