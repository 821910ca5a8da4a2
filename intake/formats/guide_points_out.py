"""A contour study as guide points: `GPFile*.txt`, one a frame, and `SliceInfoFile.txt`."""

import numpy as np
from numpy.typing import NDArray

from intake.formats.exported import Exported
from intake.formats.frame_order import frame_number
from intake.formats.guide_point_types import SEPTUM
from intake.planes import Plane, slice_plane
from schemas.study import Contour, ContourStudy, Frame, Slice
from schemas.vocabulary import Axes, Structure, View

Array = NDArray[np.float64]
Point = tuple[float, float, float]

_HEADER = "x\ty\tz\tcontour type\tframeID\tweight\ttime frame"
_LEAST_SEPTUM = 0.08
"""Of the points of a right ventricle's outline."""

_KINDS = {
    Structure.LV_ENDO: "LV_ENDOCARDIAL",
    Structure.LV_EPI: "LV_EPICARDIAL",
    Structure.RV_EPI: "RV_EPICARDIAL",
}


def write_guide_points(study: ContourStudy) -> Exported:
    """Files of guide points, LPS mm, every weight 1.

    Points that the right ventricle shares with the left one's outer outline are the septum, written
    once; without any, its outline is `RV_ENDOCARDIAL`. Slices are numbered by their ids where all
    of these are numbers.
    """
    planes = _numbered_planes(study)
    files: dict[str, bytes] = {}
    for place, frame in enumerate(study.frames):
        rows = [_HEADER]
        for slice_ in frame.slices:
            number = planes[frame.label, slice_.id][0]
            for kind, points in _pieces(slice_, study):
                rows += [
                    f"{x!r}\t{y!r}\t{z!r}\t{kind}\t{number}\t1.0\t{place}" for x, y, z in points
                ]
        files[_file_name(frame)] = ("\n".join(rows) + "\n").encode()
    infos = dict(planes.values())
    lines = [_info(number, plane) for number, plane in sorted(infos.items())]
    files["SliceInfoFile.txt"] = ("\n".join(lines) + "\n").encode()
    return Exported(files, _lost(study))


def _numbered_planes(study: ContourStudy) -> dict[tuple[str, str], tuple[int, Plane]]:
    """Number and plane (LPS mm) of each slice of each frame; one number, one plane."""
    flip = np.array([-1.0, -1.0, 1.0]) if study.axes is Axes.RAS else np.ones(3)
    ids = [s.id for f in study.frames for s in f.slices]
    keep_ids = all(one.isascii() and one.isdecimal() and len(one) < 9 for one in ids)
    found: dict[tuple[str, str], tuple[int, Plane]] = {}
    by_id: dict[str, list[tuple[int, Plane]]] = {}
    taken = {int(one) for one in ids} if keep_ids else set()
    for frame in study.frames:
        for slice_ in frame.slices:
            placed = slice_plane(slice_, study.units.millimetres)
            plane = Plane.through(placed.origin * flip, placed.normal * flip)
            known = by_id.setdefault(slice_.id, [])
            same = [one for one in known if _is_same(one[1], plane)]
            if not same:
                own = int(slice_.id) if keep_ids and not known else max(taken, default=0) + 1
                taken.add(own)
                known.append((own, plane))
                same = known[-1:]
            found[frame.label, slice_.id] = same[0]
    return found


def _is_same(a: Plane, b: Plane) -> bool:
    return bool(
        np.allclose(a.normal, b.normal, atol=1e-6) and np.allclose(a.origin, b.origin, atol=1e-4)
    )


def _pieces(slice_: Slice, study: ContourStudy) -> list[tuple[str, list[Point]]]:
    sign = -1.0 if study.axes is Axes.RAS else 1.0
    unit = study.units.millimetres

    def points(structure: Structure) -> list[Point]:
        return [
            (sign * unit * x + 0.0, sign * unit * y + 0.0, unit * z)
            for contour in _of(slice_, structure)
            for x, y, z in contour.points
        ]

    view = "SAX" if slice_.view is View.SAX else "LAX"
    endo = points(Structure.RV_ENDO)
    shared = set(points(Structure.LV_EPI) or points(Structure.RV_EPI))
    septum = _longest_run(endo, [point in shared for point in endo])
    if len(septum) < _LEAST_SEPTUM * len(endo):
        septum = []  # two outlines that touch
    rest = set(septum)
    kind = "RV_FREEWALL" if septum else "RV_ENDOCARDIAL"
    found = [(kind, [point for point in endo if point not in rest]), (SEPTUM, septum)]
    for structure, name in _KINDS.items():
        own = points(structure)
        if structure is not Structure.LV_ENDO:
            own = [point for point in own if point not in rest]
        found.append((name, own))
    valves = [
        (valve, [own[0], own[-1]])
        for structure, valve in (
            (Structure.LV_ENDO, "MITRAL_VALVE"),
            (
                Structure.RV_ENDO,
                "TRICUSPID_VALVE" if slice_.view is View.LAX_4CH else "PULMONARY_VALVE",
            ),
        )
        if view == "LAX" and (own := points(structure)) and not _of(slice_, structure)[0].closed
    ]
    return [(f"{view}_{name}", own) for name, own in found if own] + valves


def _longest_run(points: list[Point], chosen: list[bool]) -> list[Point]:
    """The most chosen points that follow one another, round the ring."""
    if all(chosen):
        return points
    start = chosen.index(False)
    runs: list[list[Point]] = [[]]
    for k in range(len(points)):
        at = (start + k) % len(points)
        if chosen[at]:
            runs[-1].append(points[at])
        elif runs[-1]:
            runs.append([])
    return max(runs, key=len)


def _of(slice_: Slice, structure: Structure) -> list[Contour]:
    return [c for c in slice_.contours if c.structure is structure]


def _file_name(frame: Frame) -> str:
    if frame_number(frame.label) is not None:
        return f"GPFile_{frame.label[1:]}.txt"
    return f"GPFile_{frame.label}.txt"


def _info(number: int, plane: Plane) -> str:
    values = [
        "ImagePositionPatient",
        *map(repr, plane.origin.tolist()),
        "ImageOrientationPatient",
        *map(repr, [*plane.u.tolist(), *plane.v.tolist()]),
        "PixelSpacing",
        "1.0",
        "1.0",
    ]
    return "\t".join([f"slice-{number}", "sliceID: ", str(number), *values])


def _lost(study: ContourStudy) -> tuple[str, ...]:
    slices = [s for f in study.frames for s in f.slices]
    said = [
        "Valve points are the ends of open contours; the aortic valve is not written, so that a "
        "three-chamber view is not told by the files."
    ]
    if any(s.absent for s in slices):
        said.append("What slices list as absent is lost: guide points cannot say it.")
    if any(len(_of(s, one)) > 1 for s in slices for one in _KINDS):
        said.append("Several contours of a structure on one slice are read back as one.")
    if any(c.structure is Structure.EPI for s in slices for c in s.contours):
        said.append("Contours of `epi` are left out: guide points have no type for them.")
    if any(f.time_ms is not None for f in study.frames):
        said.append("The times of frames are lost: guide points number frames.")
    return tuple(said)
