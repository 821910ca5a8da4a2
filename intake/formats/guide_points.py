"""Guide points, as biv-me and the Cardiac Atlas Project write them: `GPFile*.txt`, `SliceInfo`."""

from collections import Counter, defaultdict
from collections.abc import Mapping

from intake.formats.faults import unreadable
from intake.formats.frame_order import frame_labels, frame_number
from intake.formats.guide_point_rows import GuidePoint, read_rows
from intake.formats.guide_point_slice import GuideSlice
from intake.formats.guide_point_types import MARKERS, PIECES, SEPTUM, view_and_kind
from intake.formats.imported import ImportedStudy
from intake.formats.slice_info import ImagePlane, looks_like_slice_info, read_slice_info
from intake.formats.told_views import told_view
from intake.limits import Limits
from schemas.contour_files import GuidePointSettings
from schemas.problem import InputError, ProblemType
from schemas.study import ContourStudy, Frame, Slice
from schemas.vocabulary import Axes, Units, View

_KNOWN = {kind for pieces in PIECES.values() for kind in pieces.wall} | {SEPTUM, *MARKERS}


def read_guide_points(
    files: Mapping[str, bytes],
    settings: GuidePointSettings | None = None,
    *,
    subject_id: str = "subject",
    limits: Limits | None = None,
) -> ImportedStudy:
    """The study of one subject in its guide-point files, one a frame, and its slice info.

    Frames come in time: see `frame_labels`. A slice on which a frame has no point is unknown in
    it, not empty. Lengths are mm, axes LPS.

    Raises:
        InputError: `UNREADABLE_CONTOUR_FILE`, naming file and line; `TOO_LARGE` as `check_size`.
    """
    settings, limits = settings or GuidePointSettings(), limits or Limits()
    planes = _planes(files)
    frames = _frames(files, limits)
    _check_count(frames, limits)
    warnings = _about_rows(frames)
    views, unsure = _views(frames, settings)
    warnings += unsure
    if not planes:
        warnings.append(
            "No SliceInfo file was sent: the planes of the slices are fitted to their points."
        )
    times_ms = _times_ms(list(frames), settings.rr_interval_ms)
    made: list[Frame] = []
    for label, (name, rows) in frames.items():
        by_slice: defaultdict[str, list[GuidePoint]] = defaultdict(list)
        for row in rows:
            by_slice[row.slice].append(row)
        slices: list[Slice] = []
        for slice_, own in sorted(by_slice.items(), key=lambda item: _natural(item[0])):
            if planes and slice_ not in planes:
                raise unreadable(
                    name,
                    f"slice {slice_} is not in the SliceInfo file",
                    "send the SliceInfo file that belongs to these points",
                    line=own[0].line,
                )
            guide_slice = GuideSlice(label, slice_, views[slice_], planes.get(slice_), name)
            contours, found = guide_slice.contours(own)
            warnings += found
            if contours:
                slices.append(guide_slice.with_contours(contours))
        if slices:
            made.append(Frame(label=label, time_ms=times_ms.get(label), slices=slices))
        else:
            warnings.append(f"Frame {label}: no contour is in it; the frame is left out.")
    if not made:
        raise unreadable(
            next(iter(files)),
            "no contour can be made of these points",
            "send the contour points too, not the valves alone",
        )
    study = ContourStudy(subject_id=subject_id, units=Units.MM, axes=Axes.LPS, frames=made)
    return ImportedStudy(study, tuple(warnings))


def _planes(files: Mapping[str, bytes]) -> dict[str, ImagePlane]:
    infos = [name for name, content in files.items() if looks_like_slice_info(content)]
    if len(infos) > 1:
        raise unreadable(infos[1], "a second SliceInfo file", "send the one of this subject")
    return read_slice_info(infos[0], files[infos[0]]) if infos else {}


def _frames(files: Mapping[str, bytes], limits: Limits) -> dict[str, tuple[str, list[GuidePoint]]]:
    """Name and rows of each frame's file, in time."""
    points = {name: body for name, body in files.items() if not looks_like_slice_info(body)}
    if not points:
        raise unreadable(
            next(iter(files), "SliceInfoFile.txt"),
            "no file of guide points came with it",
            "send the GPFile of each frame too",
        )
    left = limits.max_points
    frames: dict[str, tuple[str, list[GuidePoint]]] = {}
    for label, name in frame_labels(points).items():
        rows = read_rows(name, points[name], left)
        left -= len(rows)
        frames[label] = (name, rows)
    return frames


def _check_count(frames: Mapping[str, tuple[str, list[GuidePoint]]], limits: Limits) -> None:
    """Refuse more frames or pieces of outlines than a study may have, before any is ordered."""
    pieces = {(f, row.slice, row.contour_type) for f, (_, rows) in frames.items() for row in rows}
    for found, most, what in (
        (len(frames), limits.max_frames, "frames"),
        (len(pieces), 2 * limits.max_contours, "pieces of outlines"),
    ):
        if found > most:
            raise InputError(
                ProblemType.TOO_LARGE,
                f"{found} {what}; at most {most} are accepted. Remedy: send fewer frames a job.",
                pointer="file",
                status=413,
            )


def _about_rows(frames: Mapping[str, tuple[str, list[GuidePoint]]]) -> list[str]:
    rows = [row for _, own in frames.values() for row in own]
    warnings = []
    weighted = sum(row.weight != 1.0 for row in rows)
    if weighted:
        warnings.append(
            f"{weighted} of {len(rows)} guide points have a weight other than 1; weights are not "
            "used, but for points of weight 0, which are left out."
        )
    kinds = Counter(row.contour_type for row in rows)
    for kind, count in sorted(kinds.items()):
        if view_and_kind(kind)[1] not in _KNOWN:
            warnings.append(f"{count} points of type {kind} are left out: no ventricle's outline.")
    markers = sum(count for kind, count in kinds.items() if kind in MARKERS)
    if markers:
        warnings.append(
            f"{markers} valve, apex and insertion points are not part of the contours; valve "
            "points only tell views and where outlines are open."
        )
    return warnings


def _views(
    frames: Mapping[str, tuple[str, list[GuidePoint]]], settings: GuidePointSettings
) -> tuple[dict[str, View], list[str]]:
    """One view a slice, over all frames."""
    seen: defaultdict[str, set[str]] = defaultdict(set)
    for _, rows in frames.values():
        for row in rows:
            seen[row.slice].add(row.contour_type)
    views, warnings = {}, []
    for slice_, types in seen.items():
        view, sure = told_view(types)
        views[slice_] = settings.views.get(slice_, view)
        if not sure and slice_ not in settings.views:
            warnings.append(
                f"Slice {slice_}: which long-axis view it is cannot be told, it is `other`; name "
                "it in `guide_points.views`."
            )
    return views, warnings


def _times_ms(labels: list[str], rr_interval_ms: float | None) -> dict[str, float]:
    """Times of numbered frames, spread evenly over the cycle."""
    numbers = {label: frame_number(label) for label in labels}
    counted = [number for number in numbers.values() if number is not None]
    if rr_interval_ms is None or len(counted) < 2 or len(counted) != len(labels):
        return {}
    first, count = min(counted), max(counted) - min(counted) + 1
    return {
        label: round(rr_interval_ms * (number - first) / count, 6)
        for label, number in numbers.items()
        if number is not None
    }


def _natural(slice_: str) -> tuple[int, int, str]:
    return (0, int(slice_), "") if slice_.isdecimal() else (1, 0, slice_)
