"""The structures of one image: tissue labels in, nested sub-pixel outlines out."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from skimage.measure import regionprops

from schemas.vocabulary import Structure
from worker.labelmaps.outline import Mask, Region, Ring, outlines, smooth_region, without_specks
from worker.labelmaps.scheme import STRUCTURE_TISSUES
from worker.labelmaps.volume import TissueImage

_SOLID = 0.8
"""Share of its convex hull that a cap of wall fills. A horseshoe or ring fills less."""
_SPACING_MM = 1.0
"""Distance between contour points, unless the pixels are larger."""
_OUTER = (Structure.LV_EPI, Structure.RV_EPI)


@dataclass(frozen=True, eq=False)
class ImageStructures:
    """What one image shows: closed outlines in pixel coordinates, known absences, remarks."""

    outlines: Mapping[Structure, list[Ring]]
    absent: tuple[Structure, ...]
    notes: tuple[str, ...]


def outline_slice(
    image: TissueImage,
    known: Sequence[Structure],
    pixel_mm: Float[np.ndarray, "2"],
) -> ImageStructures:
    """Outline the known structures of an image that has a label.

    A structure is absent when none of its tissues has a pixel, and unknown when its pixels do not
    tell its outline: specks only, a cavity without wall, a wall that is open around no cavity.
    """
    masks: dict[Structure, Mask] = {}
    absent: list[Structure] = []
    notes: list[str] = []
    unclear = _unclear(image, known, notes)
    for structure in known:
        tissues = STRUCTURE_TISSUES[structure]
        mask = np.isin(image, tissues)
        if structure in unclear:
            continue
        if not mask.any():
            absent.append(structure)
            continue
        mask, dropped = without_specks(mask, fill_holes=structure in _OUTER)
        if dropped:
            notes.append(f"specks of a few pixels were left out of {structure.value}")
        if mask.any():
            masks[structure] = mask
    regions = _nested(masks)
    size = float(pixel_mm.mean())
    found = {
        structure: outlines(region, max(_SPACING_MM / size, 1.0))
        for structure, region in regions.items()
    }
    return ImageStructures(
        {s: rings for s, rings in found.items() if rings}, tuple(absent), tuple(notes)
    )


def _unclear(image: TissueImage, known: Sequence[Structure], notes: list[str]) -> set[Structure]:
    """Structures whose pixels are there but do not tell where they end."""
    unclear = set()
    for inner, outer in (
        (Structure.LV_ENDO, Structure.LV_EPI),
        (Structure.RV_ENDO, Structure.RV_EPI),
    ):
        cavity, wall = (image == tissue for tissue in STRUCTURE_TISSUES[outer])
        if outer not in known or cavity.any() == wall.any():
            continue
        if cavity.any():
            notes.append(f"{outer.value} is unknown where a cavity is labelled without its wall")
            unclear.add(outer)
        elif not _is_cap(wall) and outer is Structure.LV_EPI:
            notes.append("lv_endo and lv_epi are unknown where an open wall has no cavity labelled")
            unclear |= {inner, outer}
    return unclear


def _is_cap(wall: Mask) -> bool:
    """Whether a wall is the tip of the apex, one solid patch: the cavity has ended."""
    kept, _ = without_specks(wall, fill_holes=False)
    return not kept.any() or bool(regionprops(kept.astype(np.uint8))[0].solidity >= _SOLID)


def _nested(masks: Mapping[Structure, Mask]) -> dict[Structure, Region]:
    """Regions in which cavities lie inside walls and the ventricles are apart.

    Each mask is smoothed for itself, so that outlines which share a border might cross by a tenth
    of a pixel; the left ventricle keeps its border, the right gives way.
    """
    if not masks:
        return {}
    union = np.logical_or.reduce(list(masks.values()))
    box = tuple(
        slice(int(used[0]), int(used[-1]) + 1)
        for used in (np.flatnonzero(union.any(axis=axis)) for axis in (1, 0))
    )
    regions = {s: smooth_region(mask, (box[0], box[1])) for s, mask in masks.items()}
    left = regions.get(Structure.LV_EPI, regions.get(Structure.LV_ENDO))
    if left is not None:
        for structure in (Structure.RV_EPI, Structure.RV_ENDO):
            if structure in regions:
                regions[structure] = regions[structure].outside(left)
    for inner, outer in (
        (Structure.LV_ENDO, Structure.LV_EPI),
        (Structure.RV_ENDO, Structure.RV_EPI),
    ):
        if inner in regions and outer in regions:
            regions[inner] = regions[inner].within(regions[outer])
    return regions
