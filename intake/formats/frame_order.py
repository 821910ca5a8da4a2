"""Which frame a guide-point file is, and in which order frames follow."""

import re
from collections.abc import Iterable

from intake.formats.faults import unreadable

_PREFIX = re.compile(r"^(?:guide_?points?|gp_?file|gp)[_-]*", re.IGNORECASE)
_KNOWN = ("ed", "es")


def frame_labels(names: Iterable[str]) -> dict[str, str]:
    """File names by their frames' labels, in time: numbered frames by number, ED, ES, the rest.

    `GPFile_012.txt` is frame `t012`, `GP_ED.txt` frame `ED`. Raises InputError for two files of
    one frame.
    """
    labels: dict[str, str] = {}
    for name in sorted(names, key=_place):
        label = _label(name)
        if label.lower() in (one.lower() for one in labels):
            raise unreadable(name, f"a second file of frame {label}", "send one file a frame")
        labels[label] = name
    return labels


def frame_number(label: str) -> int | None:
    """The number of a numbered frame."""
    return int(label[1:]) if re.fullmatch(r"t\d{1,9}", label, re.ASCII) else None


def _label(name: str) -> str:
    stem = name.rsplit("/", 1)[-1].rsplit(".", 1)[0]
    rest = re.sub(r"[^A-Za-z0-9._-]+", "-", _PREFIX.sub("", stem)).strip("-.")[:60]
    if rest.lower() in _KNOWN:
        return rest.upper()
    if re.fullmatch(r"\d{1,9}", rest):
        return f"t{rest}"
    return rest or "t0"


def _place(name: str) -> tuple[int, int, str]:
    label = _label(name)
    number = frame_number(label)
    if number is not None:
        return (0, number, name)
    if label.lower() in _KNOWN:
        return (1, _KNOWN.index(label.lower()), name)
    return (2, 0, name)
