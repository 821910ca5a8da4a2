"""Writing one section of a page that others write other sections of."""

import re
from pathlib import Path


def write_section(page: Path, name: str, text: str) -> None:
    """Put `text` between the page's comments `<!-- name -->` and `<!-- /name -->`.

    Raises ValueError where the page has no such place.
    """
    start, end = f"<!-- {name} -->", f"<!-- /{name} -->"
    before = page.read_text(encoding="utf-8")
    place = re.compile(f"{re.escape(start)}.*?{re.escape(end)}", re.DOTALL)
    if not place.search(before):
        raise ValueError(f"{page} has no place for {name}")
    page.write_text(
        place.sub(lambda _: f"{start}\n{text}\n{end}", before, count=1), encoding="utf-8"
    )
