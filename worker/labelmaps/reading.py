"""NIfTI label maps in, contour study out: the room's one verb."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from intake.label_maps import CheckedMap, check_label_maps
from intake.limits import Limits
from schemas.labels import LabelRequest
from schemas.problem import InputError, ProblemType
from schemas.study import ContourStudy, Frame
from schemas.vocabulary import Axes, Structure, Units, View
from worker.labelmaps.check import check_labels
from worker.labelmaps.findings import Finding, as_warnings
from worker.labelmaps.planes import PlaneStack, plane_stack
from worker.labelmaps.scheme import tissue_labels
from worker.labelmaps.slices import known_structures, slices_of_frame
from worker.labelmaps.views import check_same_place, labelled_extent
from worker.labelmaps.volume import Tissues, read_frames, to_tissues

_LEAST_PLANES = 2


@dataclass(frozen=True, eq=False)
class _ViewMap:
    """A view's map, read: its planes, its tissues a frame, the structures that it speaks of."""

    stack: PlaneStack
    frames: list[Tissues]
    known: tuple[Structure, ...]


def read_label_maps(
    files: Mapping[View, Path], request: LabelRequest, limits: Limits
) -> tuple[ContourStudy, list[str]]:
    """Outline the label maps of a subject.

    Returns the study, in mm and RAS (the world of NIfTI), and sentences on what had to be decided
    or looks doubtful. Frames in which no view has a label are left out.

    Raises:
        InputError: as `check_label_maps` and `check_labels`; `UNSUPPORTED_LABEL_MAP` for voxels
            that are no labels; `MISMATCHED_VIEWS` for views apart in space; `TOO_FEW_SLICES` for a
            frame with fewer than two labelled planes; `TOO_LARGE` for too many contour points.
    """
    checked = check_label_maps(files, request, limits)
    maps = {view: _read(view, files[view], checked[view], request) for view in files}
    check_same_place({v: labelled_extent(m.stack, m.frames) for v, m in maps.items()})
    findings: list[Finding] = []
    frames = []
    for index in range(next(iter(checked.values())).header.frames):
        frame = _frame(index, maps, checked, request, findings)
        if frame is not None:
            frames.append(frame)
    study = ContourStudy(
        subject_id=request.subject_id, units=Units.MM, axes=Axes.RAS, frames=frames
    )
    _check_points(study, limits, next(iter(files)))
    decided = [warning for map_ in checked.values() for warning in map_.geometry.warnings]
    return study, decided + as_warnings(findings)


def _read(view: View, path: Path, checked: CheckedMap, request: LabelRequest) -> _ViewMap:
    stack = plane_stack(checked)
    labels = list(read_frames(path, checked.header, view))
    check_labels(view, labels, stack.slice_axis, request)
    frames = [to_tissues(frame, tissue_labels(request, view)) for frame in labels]
    return _ViewMap(stack, frames, known_structures(frames))


def _frame(
    index: int,
    maps: Mapping[View, _ViewMap],
    checked: Mapping[View, CheckedMap],
    request: LabelRequest,
    findings: list[Finding],
) -> Frame | None:
    name = request.frame_labels[index] if request.frame_labels else f"t{index:02d}"
    slices = []
    for view, map_ in maps.items():
        found = slices_of_frame(
            view,
            map_.stack,
            map_.frames[index],
            map_.known,
            frame=name,
            beyond_range=request.beyond_range,
        )
        if not found.slices:
            findings.append(Finding(view, "frames without a label were left out", name))
        slices += found.slices
        findings += found.findings
    if not slices:
        return None
    _check_planes(name, sum(bool(slice_.contours) for slice_ in slices), next(iter(maps)))
    steps = (map_.header.time_step_ms for map_ in checked.values())
    step_ms = next((step for step in steps if step is not None), None)
    multiple = len(next(iter(maps.values())).frames) > 1
    return Frame(
        label=name,
        time_ms=index * step_ms if step_ms is not None and multiple else None,
        slices=slices,
    )


def _check_planes(frame: str, outlined: int, pointer: View) -> None:
    if outlined < _LEAST_PLANES:
        raise InputError(
            ProblemType.TOO_FEW_SLICES,
            f"frame {frame} has {outlined} labelled slices, and a surface takes at least "
            f"{_LEAST_PLANES}. Remedy: send the whole short-axis stack, or add long-axis views.",
            pointer=pointer,
        )


def _check_points(study: ContourStudy, limits: Limits, pointer: View) -> None:
    points = sum(len(c.points) for f in study.frames for s in f.slices for c in s.contours)
    if points > limits.max_points:
        raise InputError(
            ProblemType.TOO_LARGE,
            f"the outlines of the label maps have {points} points; at most {limits.max_points} "
            "are accepted. Remedy: send fewer frames a job.",
            pointer=pointer,
            status=413,
        )
