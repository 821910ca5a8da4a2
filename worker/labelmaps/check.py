"""Whether a map's labels are what the request says they are. A scheme is never guessed.

The anatomy decides: the LV wall surrounds the LV cavity, and the RV cavity only lies against it.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import UInt8
from scipy.ndimage import binary_dilation

from schemas.labels import LabelRequest, LabelScheme
from schemas.problem import InputError, ProblemType
from schemas.vocabulary import View
from worker.labelmaps.scheme import Tissue, published_labels, tissue_labels, values_by_tissue
from worker.labelmaps.volume import Labels, Tissues, label_values, to_tissues

_LEAST_ENCLOSED = 0.5
"""Share of the LV cavity's boundary that lies on LV wall. ACDC, M&Ms and MM-WHS maps have 0.7 to 1
read rightly, and at most 0.37 with LV and RV exchanged."""
_IN_PLANE = np.array([[0, 1, 0], [1, 1, 1], [0, 1, 0]], dtype=bool)[:, :, None]
_SHOWN = 16


@dataclass(frozen=True)
class Fit:
    """Shares of a cavity's boundary, 0 to 1, that lie on LV wall; None without that cavity."""

    lv: float | None
    rv: float | None

    @property
    def is_anatomical(self) -> bool:
        return self.lv is not None and self.lv >= _LEAST_ENCLOSED and self.lv > (self.rv or 0.0)


def check_labels(
    view: View, frames: Sequence[Labels], slice_axis: int, request: LabelRequest
) -> None:
    """Hold one view's map, all frames, against the scheme of the request.

    Raises:
        InputError: `UNKNOWN_LABELS`, `EMPTY_LABEL_MAP` or `WRONG_LABEL_SCHEME`.
    """
    scheme = tissue_labels(request, view)
    found = frozenset[int]().union(*(label_values(frame) for frame in frames))
    declared = frozenset(v for values in values_by_tissue(scheme).values() for v in values)
    unknown = found - declared - frozenset(scheme.ignored)
    if unknown:
        better = _fitting(view, frames, slice_axis, found)
        raise InputError(
            ProblemType.UNKNOWN_LABELS,
            f"`{view}` holds the label values {_list(unknown)}, which the label scheme "
            f"{_name(request)} does not have in this view. Remedy: "
            + (f"`label_scheme` {_or(better)} fits this map; otherwise " if better else "")
            + "send `label_scheme` as an object that gives each tissue its values and lists under "
            "`ignored` those that are no ventricle, such as "
            f"{_with_ignored(request, view, unknown)}.",
            pointer="/label_scheme",
        )
    if not found & declared:
        raise InputError(
            ProblemType.EMPTY_LABEL_MAP,
            f"`{view}` holds no voxel of a ventricle"
            + (f", only the ignored values {_list(found)}" if found else "")
            + ". Remedy: leave this view out, or send the map of the frames that were segmented.",
            pointer=view,
        )
    if any(frame.all() for frame in frames):
        raise InputError(
            ProblemType.UNSUPPORTED_LABEL_MAP,
            f"every voxel of `{view}` is labelled, so nothing has an outline. Remedy: send a map "
            "with the background as 0.",
            pointer=view,
        )
    _check_anatomy(view, frames, slice_axis, request, found)


def _check_anatomy(
    view: View,
    frames: Sequence[Labels],
    slice_axis: int,
    request: LabelRequest,
    found: frozenset[int],
) -> None:
    scheme = tissue_labels(request, view)
    tissues = [to_tissues(frame, scheme) for frame in frames]
    present = {t for t in Tissue if any((frame == t).any() for frame in tissues)}
    if Tissue.RV_WALL in present and Tissue.RV_CAVITY not in present:
        raise _wrong(
            view,
            request,
            "the map has rv_wall around no rv_cavity",
            _fitting(view, frames, slice_axis, found),
        )
    published = isinstance(request.label_scheme, LabelScheme)
    missing = [t for t in (Tissue.LV_CAVITY, Tissue.LV_WALL) if t not in present]
    if missing:
        if published:
            what = " and ".join(t.name.lower() for t in missing)
            raise _wrong(
                view, request, f"the map has no {what}", _fitting(view, frames, slice_axis, found)
            )
        return
    fit = _fit(tissues, slice_axis)
    if not fit.is_anatomical:
        shares = f"{fit.lv:.0%} of the LV cavity's boundary lies on the LV wall"
        if fit.rv is not None:
            shares += f", and {fit.rv:.0%} of the RV cavity's"
        raise _wrong(view, request, shares, _fitting(view, frames, slice_axis, found))


def _fitting(
    view: View, frames: Sequence[Labels], slice_axis: int, found: frozenset[int]
) -> list[LabelScheme]:
    """Published schemes that know every value found and give an anatomical heart, best first."""
    fits: dict[LabelScheme, float] = {}
    for scheme in LabelScheme:
        labels = published_labels(scheme, view)
        known = {v for values in values_by_tissue(labels).values() for v in values}
        if found <= known | set(labels.ignored):
            fit = _fit([to_tissues(frame, labels) for frame in frames], slice_axis)
            if fit.is_anatomical:
                fits[scheme] = (fit.rv or 0.0) - (fit.lv or 0.0)
    return sorted(fits, key=lambda scheme: fits[scheme])


def _fit(frames: Iterable[Tissues], slice_axis: int) -> Fit:
    on_wall = {Tissue.LV_CAVITY: 0, Tissue.RV_CAVITY: 0}
    boundary = dict(on_wall)
    for tissues in frames:
        heart = _cropped(np.moveaxis(tissues, slice_axis, 2))
        # One pixel of slack: some maps leave a gap between cavity and wall.
        wall = binary_dilation(heart == Tissue.LV_WALL, _IN_PLANE)
        for cavity in on_wall:
            inside = heart == cavity
            for here, there in _neighbours(2):
                edge = inside[here] & ~inside[there]
                boundary[cavity] += int(edge.sum())
                on_wall[cavity] += int((edge & wall[there]).sum())
    lv, rv = (
        on_wall[cavity] / boundary[cavity] if boundary[cavity] else None for cavity in on_wall
    )
    return Fit(lv=lv, rv=rv)


def _cropped(tissues: Tissues) -> UInt8[np.ndarray, "_ _ _"]:
    """The box of the labelled voxels, with a margin of background in plane."""
    box = tuple(
        slice(used[0], used[-1] + 1)
        if len(used := np.flatnonzero(tissues.any(axis=others)))
        else slice(0, 0)
        for others in ((1, 2), (0, 2), (0, 1))
    )
    return np.pad(tissues[box], ((2, 2), (2, 2), (0, 0)))


def _neighbours(axes: int) -> list[tuple[tuple[slice, ...], tuple[slice, ...]]]:
    """Index pairs of voxels that share a face, both ways along each of the first `axes` axes."""
    pairs = []
    for axis in range(axes):
        first = (*(slice(None),) * axis, slice(None, -1))
        second = (*(slice(None),) * axis, slice(1, None))
        pairs += [(first, second), (second, first)]
    return pairs


def _wrong(
    view: View, request: LabelRequest, what: str, better: Sequence[LabelScheme]
) -> InputError:
    remedy = (
        f"`label_scheme` {_or(better)} fits this map"
        if better
        else "no published scheme fits; send `label_scheme` as an object that gives each tissue "
        "its values (a map without LV wall lists none)"
    )
    return InputError(
        ProblemType.WRONG_LABEL_SCHEME,
        f"`{view}` read with the label scheme {_name(request)} is no heart: {what}. "
        f"Remedy: {remedy}.",
        pointer="/label_scheme",
    )


def _name(request: LabelRequest) -> str:
    scheme = request.label_scheme
    return f"`{scheme.value}`" if isinstance(scheme, LabelScheme) else "given"


def _or(schemes: Sequence[LabelScheme]) -> str:
    return " or ".join(f"`{scheme.value}`" for scheme in schemes)


def _list(values: Iterable[int]) -> str:
    ordered = sorted(values)
    shown = ", ".join(map(str, ordered[:_SHOWN]))
    return shown + (f" and {len(ordered) - _SHOWN} more" if len(ordered) > _SHOWN else "")


def _with_ignored(request: LabelRequest, view: View, unknown: Iterable[int]) -> str:
    """The scheme of the request as an object, with the unknown values ignored, as JSON."""
    labels = tissue_labels(request, view)
    ignored = sorted({*labels.ignored, *unknown})[:_SHOWN]
    return labels.model_copy(update={"ignored": ignored}).model_dump_json()
