"""Slice by slice: the contours that were given, and where the surfaces cross the same plane.

Panels are small static SVG, not plotly: thirty subplots of plotly are a hundred times as heavy,
cannot reflow into a phone's columns, and are blank without a script.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from shapely import LineString

from schemas.vocabulary import Axes, Structure, View
from worker.arrays import PlanePoints, SomePoints
from worker.artifacts.measured import MeasuredFrame, MeasuredSlice
from worker.artifacts.page.orientation import Orientation, orientation

_PER_MM = 10.0
"""User units of the SVG in one mm: whole numbers are short, and a tenth of a mm is enough."""

_TOLERANCE_MM = 0.05
_BEFORE_MM, _AFTER_MM = np.array([6.0, 12.0]), np.array([14.0, 12.0])
"""Left of and above the contours, right of and below: room for letters and the bar."""


@dataclass(frozen=True)
class Stroke:
    """A line of a panel: what it is (`observed`, `section`, `reference`), of what, and its path."""

    kind: str
    structure: Structure
    path: str


@dataclass(frozen=True)
class Panel:
    """One slice. left, top, width, height: the view box, in tenths of mm. right_letters,
    up_letters: where the patient's sides are.
    """

    slice_id: str
    view: View
    left: int
    top: int
    width: int
    height: int
    right_letters: str
    up_letters: str
    strokes: tuple[Stroke, ...]


def panels(frame: MeasuredFrame, axes: Axes) -> list[Panel]:
    """One for every slice, in order. Short-axis slices share one box, so that the eye can follow
    the heart through the stack; those of other views lie across each other and share its size only.
    """
    drawn = [_drawn(frame, one, axes) for one in frame.slices]
    boxes = [_box(lines) for _, lines in drawn]
    stack = [b for b, s in zip(boxes, frame.slices, strict=True) if s.view is View.SAX]
    others = [b for b, s in zip(boxes, frame.slices, strict=True) if s.view is not View.SAX]
    shared = _around(stack)
    size = _largest(others)
    return [
        _panel(one, way, lines, shared if one.view is View.SAX else _centred(box, size))
        for one, (way, lines), box in zip(frame.slices, drawn, boxes, strict=True)
    ]


@dataclass(frozen=True, eq=False)
class _Line:
    kind: str
    structure: Structure
    points: PlanePoints
    closed: bool


_Box = np.ndarray
"""(2, 2): least and largest x and y, mm."""


def _drawn(frame: MeasuredFrame, one: MeasuredSlice, axes: Axes) -> tuple[Orientation, list[_Line]]:
    way = orientation(one.normal, axes)
    lines = [
        _Line("observed", structure, way.drawn(r.outline.points_mm), r.outline.closed)
        for structure, surface in frame.surfaces.items()
        for r in surface.residuals
        if r.outline.slice_id == one.id
    ]
    for kind, sections in (("section", one.sections), ("reference", one.reference_sections)):
        for structure, polylines in sections.items():
            lines += [_section(kind, structure, way, points) for points in polylines]
    return way, lines


def _section(kind: str, structure: Structure, way: Orientation, points_mm: SomePoints) -> _Line:
    closed = len(points_mm) > 1 and bool(np.allclose(points_mm[0], points_mm[-1]))
    return _Line(kind, structure, way.drawn(points_mm[:-1] if closed else points_mm), closed)


def _panel(one: MeasuredSlice, way: Orientation, lines: Sequence[_Line], box: _Box) -> Panel:
    left, top = np.floor(box[0] * _PER_MM).astype(int).tolist()
    right, bottom = np.ceil(box[1] * _PER_MM).astype(int).tolist()
    return Panel(
        slice_id=one.id,
        view=one.view,
        left=left,
        top=top,
        width=right - left,
        height=bottom - top,
        right_letters=way.right_letters,
        up_letters=way.up_letters,
        strokes=tuple(Stroke(x.kind, x.structure, _path(x)) for x in lines if len(x.points) > 1),
    )


def _path(line: _Line) -> str:
    points = np.concatenate([line.points, line.points[:1]]) if line.closed else line.points
    thinned = np.array(LineString(points).simplify(_TOLERANCE_MM).coords)
    corners = np.rint(thinned[: -1 if line.closed else None] * _PER_MM).astype(int).tolist()
    return "M" + "L".join(f"{x} {y}" for x, y in corners) + ("Z" if line.closed else "")


def _box(lines: Sequence[_Line]) -> _Box | None:
    if not lines:
        return None
    points = np.concatenate([line.points for line in lines])
    return np.stack([points.min(axis=0) - _BEFORE_MM, points.max(axis=0) + _AFTER_MM])


def _around(boxes: Iterable[_Box | None]) -> _Box:
    known = [box for box in boxes if box is not None]
    if not known:
        return np.array([[-40.0, -40.0], [40.0, 40.0]])
    return np.stack([np.min([b[0] for b in known], axis=0), np.max([b[1] for b in known], axis=0)])


def _largest(boxes: Iterable[_Box | None]) -> np.ndarray:
    sizes = [box[1] - box[0] for box in boxes if box is not None]
    return np.max(sizes, axis=0) if sizes else np.array([80.0, 80.0])


def _centred(box: _Box | None, size: np.ndarray) -> _Box:
    middle = np.zeros(2) if box is None else box.mean(axis=0)
    return np.stack([middle - size / 2.0, middle + size / 2.0])
