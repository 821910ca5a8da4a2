"""One frame of one view: its planes outlined, and what its empty planes say."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from schemas.study import Contour, Slice
from schemas.vocabulary import Structure, View
from worker.labelmaps.findings import Finding
from worker.labelmaps.planes import PlaneStack
from worker.labelmaps.scheme import STRUCTURE_TISSUES, Tissue
from worker.labelmaps.structures import outline_slice
from worker.labelmaps.volume import TissueImage, Tissues

_BASE_CUT = 0.5
_APEX_CUT = 0.15
"""Shares of the largest cross-section at the last image of a stack, above which it goes on."""


@dataclass(frozen=True, eq=False)
class ViewFrame:
    """Slices found in one frame of one view, and what was noticed."""

    slices: list[Slice] = field(default_factory=list)
    findings: list[Finding] = field(default_factory=list)


def known_structures(frames: Sequence[Tissues]) -> tuple[Structure, ...]:
    """Structures that a view's map speaks of: those whose outer tissue occurs in any frame.

    Of any other the map says nothing, not even that it is absent.
    """
    present = {t for t in Tissue if any((frame == t).any() for frame in frames)}
    return tuple(s for s, tissues in STRUCTURE_TISSUES.items() if tissues[-1] in present)


def slices_of_frame(
    view: View,
    stack: PlaneStack,
    tissues: Tissues,
    known: Sequence[Structure],
    *,
    frame: str,
    beyond_range: bool,
) -> ViewFrame:
    """Outline every labelled plane of one frame.

    Within a labelled plane, a known structure without a pixel is absent: the segmenter looked. An
    empty short-axis plane between labelled ones has every known structure absent; beyond the
    labelled range only when `beyond_range`. Empty long-axis planes say nothing.
    """
    images = np.moveaxis(tissues, stack.slice_axis, 0)
    labelled = np.flatnonzero(images.any(axis=(1, 2)))
    if not len(labelled):
        return ViewFrame()
    result = ViewFrame()
    is_stack = view is View.SAX
    for index, image in enumerate(images):
        if image.any():
            slice_, notes = _outlined(view, stack, image, index, known)
        elif is_stack and (beyond_range or labelled[0] < index < labelled[-1]):
            slice_, notes = _slice(view, stack, index, [], known), []
        else:
            continue
        if slice_ is not None:
            result.slices.append(slice_)
        name = slice_id(view, stack, index)
        result.findings.extend(Finding(view, note, f"{frame} {name}") for note in notes)
    if is_stack and stack.count > 1:
        result.findings.extend(_cut_ends(images, frame))
    return result


def slice_id(view: View, stack: PlaneStack, index: int) -> str:
    """`sax-00`, `lax_4ch`; a long-axis map of several planes numbers them too."""
    return view.value if view.is_long_axis and stack.count == 1 else f"{view.value}-{index:02d}"


def _outlined(
    view: View, stack: PlaneStack, image: TissueImage, index: int, known: Sequence[Structure]
) -> tuple[Slice | None, list[str]]:
    found = outline_slice(image, known, stack.pixel_mm)
    contours = [
        Contour(structure=structure, points=stack.to_space(ring, index).round(4).tolist())
        for structure, rings in found.outlines.items()
        for ring in rings
    ]
    notes = list(found.notes)
    if image[[0, -1]].any() or image[:, [0, -1]].any():
        notes.append("a contour touches the border of the image and may be cut off there")
    if not contours and not found.absent:
        return None, notes
    return _slice(view, stack, index, contours, found.absent), notes


def _slice(
    view: View,
    stack: PlaneStack,
    index: int,
    contours: list[Contour],
    absent: Sequence[Structure],
) -> Slice:
    return Slice(
        id=slice_id(view, stack, index),
        view=view,
        origin=tuple(stack.centre_mm(index).tolist()),
        normal=tuple(stack.normal.tolist()),
        contours=contours,
        absent=list(absent),
    )


def _cut_ends(images: Tissues, frame: str) -> list[Finding]:
    """A ventricle that is still there on the first or last image goes on beyond the stack."""
    findings = []
    for name, tissue in (("LV cavity", Tissue.LV_CAVITY), ("RV cavity", Tissue.RV_CAVITY)):
        areas = (images == tissue).sum(axis=(1, 2))
        for end in (0, len(areas) - 1):
            share = areas[end] / areas.max() if areas.max() else 0.0
            if share < _APEX_CUT:
                continue
            part = "base" if share >= _BASE_CUT else "end"
            findings.append(
                Finding(
                    View.SAX,
                    f"the stack ends inside the {name}, whose {part} is likely cut off; the "
                    "surface beyond the last slice is extrapolated",
                    f"{frame} {View.SAX.value}-{end:02d}, {share:.0%} of its largest section",
                )
            )
    return findings
