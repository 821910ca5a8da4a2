"""The planes of a cross-section file (`.csl`), as OReX and its forerunners read them.

A header `CSLC`; counts of planes and labels; then each plane: its number, how many vertices and
components it has, and A, B, C, D of Ax + By + Cz + D = 0; its vertices, one a line; its components,
one a line: how many vertices, a label, and which, counted from 0. A hole is a component.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

from intake.formats.faults import unreadable
from intake.formats.text_file import numbered_lines

HEADER = "CSLC"

_FARTHEST = 1e7


@dataclass(frozen=True)
class CslPlane:
    """One plane. components: label and vertices of each."""

    number: int
    normal: tuple[float, float, float]
    offset: float
    components: tuple[tuple[str, tuple[tuple[float, float, float], ...]], ...]


def looks_like_csl(content: bytes) -> bool:
    """Whether the file begins with the format's header."""
    return content.removeprefix(b"\xef\xbb\xbf").lstrip()[:4] == HEADER.encode()


def read_planes(name: str, content: bytes, most_points: int) -> list[CslPlane]:
    """The planes of file `name`. Raises InputError at the first line that is not as described."""
    lines = _Lines(name, numbered_lines(name, content))
    if lines.next("the header") != [HEADER]:
        raise lines.fault(f"the first line is not {HEADER}")
    planes, labels = lines.counts(2, "the counts of planes and labels")
    if planes < 1 or labels < 1:
        raise lines.fault("no plane, or no label, is announced")
    found = []
    left = most_points
    for _ in range(planes):
        values = lines.next("a plane")
        if len(values) != 7:
            raise lines.fault(f"a plane has 7 values, here are {len(values)}")
        number, vertices, components = (lines.count(value) for value in values[:3])
        a, b, c, d = (lines.number(value) for value in values[3:])
        if math.hypot(a, b, c) < 1e-9:
            raise lines.fault("A, B, C of the plane are all zero")
        left -= vertices
        if left < 0:
            raise lines.fault(f"more than {most_points} vertices")
        points = [lines.point() for _ in range(vertices)]
        made = tuple(lines.component(points) for _ in range(components))
        found.append(CslPlane(number, (a, b, c), d, made))
    lines.end()
    return found


class _Lines:
    """The lines of a file, and where it stands, for faults."""

    def __init__(self, name: str, lines: Iterator[tuple[int, str]]) -> None:
        self._name, self._lines, self._line = name, lines, 1

    def next(self, what: str) -> list[str]:
        try:
            self._line, text = next(self._lines)
        except StopIteration:
            raise self.fault(f"the file ends where {what} should be") from None
        return text.split()

    def end(self) -> None:
        for line, _ in self._lines:
            self._line = line
            raise self.fault("there is more than was announced")

    def fault(self, what: str) -> Exception:
        return unreadable(
            self._name,
            what,
            "write the file again: CSLC, counts, then planes with vertices and components",
            line=self._line,
        )

    def counts(self, count: int, what: str) -> list[int]:
        values = self.next(what)
        if len(values) != count:
            raise self.fault(f"{what} are {count} numbers")
        return [self.count(value) for value in values]

    def count(self, text: str) -> int:
        if not (text.isascii() and text.isdecimal() and len(text) <= 9):
            raise self.fault("a count or index is no whole number of at most 9 digits")
        return int(text)

    def number(self, text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not abs(value) <= _FARTHEST:
            raise self.fault(f"a value is no number of at most {_FARTHEST:g}")
        return value

    def point(self) -> tuple[float, float, float]:
        values = self.next("a vertex")
        if len(values) != 3:
            raise self.fault(f"a vertex has 3 values, here are {len(values)}")
        x, y, z = (self.number(value) for value in values)
        return (x, y, z)

    def component(
        self, points: list[tuple[float, float, float]]
    ) -> tuple[str, tuple[tuple[float, float, float], ...]]:
        values = self.next("a component")
        if len(values) < 2:
            raise self.fault("a component has a count, a label and its vertices")
        count, label = self.count(values[0]), self.count(values[1])
        at = [self.count(value) for value in values[2:]]
        if len(at) != count or count < 3:
            raise self.fault(f"a component announces {count} vertices and has {len(at)}")
        if len(at) > len(points) or max(at) >= len(points):
            raise self.fault(f"a component names vertices that its plane has not ({len(points)})")
        return str(label), tuple(points[k] for k in at)
