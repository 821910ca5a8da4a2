"""Whether a map's labels are what the request says they are. A scheme is never guessed."""

from collections.abc import Iterable, Sequence

from schemas.labels import LabelRequest, LabelScheme
from schemas.problem import InputError, ProblemType
from schemas.vocabulary import View
from worker.labelmaps.anatomy import anatomical_fit, fitting_schemes
from worker.labelmaps.scheme import Tissue, tissue_labels, values_by_tissue
from worker.labelmaps.volume import Labels, label_values, to_tissues

_SHOWN = 16


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
        better = fitting_schemes(view, frames, slice_axis, found)
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
            fitting_schemes(view, frames, slice_axis, found),
        )
    published = isinstance(request.label_scheme, LabelScheme)
    missing = [t for t in (Tissue.LV_CAVITY, Tissue.LV_WALL) if t not in present]
    if missing:
        if published:
            what = " and ".join(t.name.lower() for t in missing)
            raise _wrong(
                view,
                request,
                f"the map has no {what}",
                fitting_schemes(view, frames, slice_axis, found),
            )
        return
    fit = anatomical_fit(tissues, slice_axis)
    if not fit.is_anatomical:
        shares = f"{fit.lv:.0%} of the LV cavity's boundary lies on the LV wall"
        if fit.rv is not None:
            shares += f", and {fit.rv:.0%} of the RV cavity's"
        raise _wrong(view, request, shares, fitting_schemes(view, frames, slice_axis, found))


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
