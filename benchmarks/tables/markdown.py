"""Tables as text."""

import math
from collections.abc import Iterable, Sequence


def table(
    header: Sequence[str], rows: Iterable[Sequence[str]], *, aligned_right: bool = True
) -> str:
    """A table; what follows the first column is aligned to the right if it is numbers."""
    rule = ["---", *["---:" if aligned_right else "---"] * (len(header) - 1)]
    return "\n".join(f"| {' | '.join(row)} |" for row in [header, rule, *rows])


def number(value: float | None, digits: int, *, sign: bool = False) -> str:
    """A number with so many decimals; a dash where there is none."""
    if value is None or math.isnan(value):
        return "-"
    return f"{value:{'+' if sign else ''}.{digits}f}"


def lowest_bold(values: Sequence[float], digits: int) -> list[str]:
    """Numbers, the lowest in bold, and with it all that read the same."""
    texts = [number(value, digits) for value in values]
    there = [value for value in values if not math.isnan(value)]
    best = number(min(there), digits) if there else None
    return [f"**{text}**" if text == best else text for text in texts]


def folded(title: str, text: str) -> str:
    """Text that opens when its title is clicked."""
    return f"<details><summary>{title}</summary>\n\n{text}\n\n</details>"
