"""A contour study as cross-section files (`.csl`): one for each frame and structure."""

import numpy as np

from intake.formats.csl_planes import HEADER
from intake.formats.exported import Exported
from intake.planes import slice_plane
from schemas.study import ContourStudy, Frame
from schemas.vocabulary import Structure

_LABELS = 2  # inside and outside


def write_csl(study: ContourStudy) -> Exported:
    """Files `{frame}_{structure}.csl`, in the study's own units and axes.

    A plane stands in the files of those structures that it shows. Open contours are closed by their
    chord.
    """
    files, warnings = {}, []
    opened = absent = 0
    for frame in study.frames:
        opened += sum(not c.closed for s in frame.slices for c in s.contours)
        absent += sum(len(s.absent) for s in frame.slices)
        for structure in Structure:
            content = _file(frame, structure)
            if content is not None:
                files[f"{frame.label}_{structure.value}.csl"] = content
    if opened:
        warnings.append(
            f"{opened} open contours are closed by a chord, which a reader takes for a border."
        )
    if absent:
        warnings.append(
            f"{absent} times a slice lists a structure absent; planes without a contour are not "
            "written, since readers of the format refuse them."
        )
    return Exported(files, tuple(warnings))


def _file(frame: Frame, structure: Structure) -> bytes | None:
    planes = []
    for number, slice_ in enumerate(frame.slices, start=1):
        contours = [c for c in slice_.contours if c.structure is structure]
        if not contours:
            continue
        plane = slice_plane(slice_, 1.0)
        offset = -float(plane.normal @ plane.origin)
        points = [point for contour in contours for point in contour.points]
        numbers = " ".join(repr(v) for v in (*plane.normal.tolist(), offset))
        lines = [f"{number} {len(points)} {len(contours)} {numbers}", ""]
        lines += [f"{x!r} {y!r} {z!r}" for x, y, z in points]
        lines.append("")
        first = 0
        for contour in contours:
            at = np.arange(first, first + len(contour.points)).tolist()
            lines.append(" ".join(map(str, [len(at), 1, *at])))
            first += len(at)
        planes.append("\n".join(lines))
    if not planes:
        return None
    return "\n\n".join([f"{HEADER}\n{len(planes)} {_LABELS}", *planes, ""]).encode()
