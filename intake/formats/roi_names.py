"""Which structure a region's name means: by a table of well-known names, or as the caller says."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeVar

from schemas.vocabulary import Structure, View

T = TypeVar("T")

_LV = ("lv", "left ventricle", "left ventricular")
_RV = ("rv", "right ventricle", "right ventricular")
_ENDO = ("endo", "endocardium", "endocardial", "cavity", "blood pool", "bloodpool")
_EPI = ("epi", "epicardium", "epicardial")
_BOTH = ("biv", "biventricular", "lv rv", "both ventricles")

WELL_KNOWN: Mapping[str, Structure] = {
    f"{side} {layer}": structure
    for sides, layers, structure in (
        (_LV, _ENDO, Structure.LV_ENDO),
        (_LV, _EPI, Structure.LV_EPI),
        (_RV, _ENDO, Structure.RV_ENDO),
        (_RV, _EPI, Structure.RV_EPI),
        (_BOTH, _EPI, Structure.EPI),
    )
    for side in sides
    for layer in layers
}
"""By name in small letters, words apart. Not here: `lv`, `myocardium`, `epi`: they may be the
cavity or the whole, a wall, one ventricle or both."""

_GLUED = re.compile(r"^(lv|rv|biv)(endo|epi|cavity|blood pool|bloodpool)")
_FILLERS = frozenset(("contour", "contours", "border", "roi"))
_INSTANTS = {
    "ed": "ED",
    "es": "ES",
    "end diastole": "ED",
    "end systole": "ES",
    "end diastolic": "ED",
    "end systolic": "ES",
    "diastole": "ED",
    "systole": "ES",
}
_VIEWS = {
    "sax": View.SAX,
    "short axis": View.SAX,
    "2ch": View.LAX_2CH,
    "lax 2ch": View.LAX_2CH,
    "3ch": View.LAX_3CH,
    "lax 3ch": View.LAX_3CH,
    "4ch": View.LAX_4CH,
    "lax 4ch": View.LAX_4CH,
}
_SHOWN_NAMES = 20
_SHOWN_LETTERS = 64


@dataclass(frozen=True)
class RoiName:
    """What a name says: a structure, an instant (ED or ES), a view; None where it says nothing."""

    structure: Structure | None
    instant: str | None
    view: View | None


def understood(name: str, given: Mapping[str, Structure]) -> RoiName:
    """`name` by the caller's table `given` (whole names, any case), else by the well-known ones."""
    words = _words(name)
    words, instant = _taken(words, _INSTANTS)
    words, view = _taken(words, _VIEWS)
    said = {key.strip().casefold(): structure for key, structure in given.items()}
    structure = said.get(name.strip().casefold())
    if structure is None:
        left = " ".join(word for word in words.split() if word not in _FILLERS)
        structure = WELL_KNOWN.get(_GLUED.sub(r"\1 \2", left))
    return RoiName(structure, instant, view)


def view_told(description: str) -> View | None:
    """The view that a series description names."""
    return _taken(_words(description), _VIEWS)[1]


def listed(names: list[str]) -> str:
    """Names fit to be shown: printable, short, each once, the first twenty."""
    once = list(dict.fromkeys(names))
    shown = [
        repr("".join(c for c in name[:_SHOWN_LETTERS] if c.isprintable()))
        for name in once[:_SHOWN_NAMES]
    ]
    more = len(once) - len(shown)
    return ", ".join(shown) + (f" and {more} more" if more > 0 else "")


def _words(name: str) -> str:
    return " ".join(re.findall(r"[a-z0-9]+", name[:_SHOWN_LETTERS].casefold()))


def _taken(words: str, table: Mapping[str, T]) -> tuple[str, T | None]:
    """`words` without the longest phrase of `table` in them, and what it means."""
    for phrase in sorted(table, key=len, reverse=True):
        pattern = rf"\b{phrase}\b"
        if re.search(pattern, words):
            return " ".join(re.sub(pattern, " ", words).split()), table[phrase]
    return words, None
