"""How well a labelled heart agrees with anatomy: what of its cavities lies on LV wall.

The LV wall surrounds the LV cavity, and the RV cavity only lies against it.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import UInt8
from scipy.ndimage import binary_dilation

from schemas.label_schemes import published_labels
from schemas.labels import LabelScheme
from schemas.vocabulary import View
from worker.labelmaps.scheme import Tissue, values_by_tissue
from worker.labelmaps.volume import Labels, Tissues, to_tissues

_LEAST_ENCLOSED = 0.5
"""Share of the LV cavity's boundary that lies on LV wall. In 13 maps (ACDC, M&Ms, MM-WHS) it is
0.72 to 1 read rightly, and up to 0.44 with LV and RV exchanged (a two-chamber view)."""
_IN_PLANE = np.array([[0, 1, 0], [1, 1, 1], [0, 1, 0]], dtype=bool)[:, :, None]
_ALL, _FIRST, _SECOND = slice(None), slice(None, -1), slice(1, None)
_NEIGHBOURS = (
    ((_FIRST, _ALL), (_SECOND, _ALL)),
    ((_SECOND, _ALL), (_FIRST, _ALL)),
    ((_ALL, _FIRST), (_ALL, _SECOND)),
    ((_ALL, _SECOND), (_ALL, _FIRST)),
)
"""Index pairs of pixels that share an edge, both ways along either axis of the plane."""


@dataclass(frozen=True)
class AnatomicalFit:
    """Shares of a cavity's boundary, 0 to 1, that lie on LV wall; None without that cavity."""

    lv: float | None
    rv: float | None

    @property
    def is_anatomical(self) -> bool:
        return self.lv is not None and self.lv >= _LEAST_ENCLOSED and self.lv > (self.rv or 0.0)


def fitting_schemes(
    view: View, frames: Sequence[Labels], slice_axis: int, found: frozenset[int]
) -> list[LabelScheme]:
    """Published schemes that know every value found and give an anatomical heart, best first."""
    fits: dict[LabelScheme, float] = {}
    for scheme in LabelScheme:
        labels = published_labels(scheme, view)
        known = {v for values in values_by_tissue(labels).values() for v in values}
        if found <= known | set(labels.ignored):
            fit = anatomical_fit([to_tissues(frame, labels) for frame in frames], slice_axis)
            if fit.is_anatomical:
                fits[scheme] = (fit.rv or 0.0) - (fit.lv or 0.0)
    return sorted(fits, key=lambda scheme: fits[scheme])


def anatomical_fit(frames: Iterable[Tissues], slice_axis: int) -> AnatomicalFit:
    """Shares of the cavities' boundaries within slices, over all frames."""
    on_wall = {Tissue.LV_CAVITY: 0, Tissue.RV_CAVITY: 0}
    boundary = dict(on_wall)
    for tissues in frames:
        heart = _cropped(np.moveaxis(tissues, slice_axis, 2))
        # One pixel of slack: some maps leave a gap between cavity and wall.
        wall = binary_dilation(heart == Tissue.LV_WALL, _IN_PLANE)
        for cavity in on_wall:
            inside = heart == cavity
            for here, there in _NEIGHBOURS:
                edge = inside[here] & ~inside[there]
                boundary[cavity] += int(edge.sum())
                on_wall[cavity] += int((edge & wall[there]).sum())
    lv, rv = (
        on_wall[cavity] / boundary[cavity] if boundary[cavity] else None for cavity in on_wall
    )
    return AnatomicalFit(lv=lv, rv=rv)


def _cropped(tissues: Tissues) -> UInt8[np.ndarray, "_ _ _"]:
    """The box of the labelled voxels, with a margin of background in plane."""
    box = tuple(
        slice(used[0], used[-1] + 1)
        if len(used := np.flatnonzero(tissues.any(axis=others)))
        else slice(0, 0)
        for others in ((1, 2), (0, 2), (0, 1))
    )
    return np.pad(tissues[box], ((2, 2), (2, 2), (0, 0)))
