"""Workspaces of Circle cvi42 (`.cvi42wsx`) as a contour study.

What their elements mean is not published; it is known from programs that read them, and said here
where it is used.
"""

import re
from collections import Counter
from collections.abc import Mapping, Sequence

import numpy as np

from intake.formats.assembled import assembled, check_counts
from intake.formats.clinical_faults import unusable
from intake.formats.companions import read_companions
from intake.formats.cvi42_xml import WorkspaceContour, read_workspace
from intake.formats.found_contour import FoundContour, without_repeats
from intake.formats.image_geometry import Images
from intake.formats.imported import ImportedStudy
from intake.formats.roi_names import listed
from intake.limits import Limits
from schemas.vocabulary import Structure, View

DEFAULT_LIMITS = Limits()

_NAME = re.compile(r"(sa|la)(rv)?(endo|epi)cardial(Open)?Contour(?:\d{1,4})?")
"""Short or long axis, of the right ventricle or the left, and a number where there are several."""

_STRUCTURES = {
    (False, "endo"): Structure.LV_ENDO,
    (False, "epi"): Structure.LV_EPI,
    (True, "endo"): Structure.RV_ENDO,
    (True, "epi"): Structure.RV_EPI,
}


def read_cvi42(
    files: Mapping[str, bytes],
    *,
    subject_id: str = "subject",
    limits: Limits = DEFAULT_LIMITS,
) -> ImportedStudy:
    """The study in the cvi42 workspaces among `files` (by name); the others tell of their images.

    Contours are in pixels of images that the workspace only names, so the images' DICOM headers
    or a geometry table must come along; contours of images without either are left out, with a
    warning that counts them. Short-axis contours are closed, `...Open...` ones and those of the
    long axis are open: they end at the valve. Frames come from the images' times. Of the patient
    nothing is taken: the subject is `subject_id`.

    Raises:
        InputError: no workspace, a file that cannot be read, too much of it, no contour of the
            ventricles, no geometry, or images whose instants cannot be told apart.
    """
    workspaces = {name: data for name, data in files.items() if looks_like_cvi42(data)}
    if not workspaces:
        raise unusable(
            "there is no cvi42 workspace", "send the .cvi42wsx file (XML), unpacked from archives"
        )
    rest = {name: data for name, data in files.items() if name not in workspaces}
    images, warnings = read_companions(rest, limits)
    drawn: list[WorkspaceContour] = []
    for name, data in workspaces.items():
        drawn += read_workspace(data, name, limits)
    ours = _of_ventricles(drawn, warnings)
    check_counts([len(c.x) for c in ours], limits)
    placed = _with_geometry(ours, images, warnings)
    contours = _found(placed, images, warnings)
    return assembled(contours, images, warnings, subject_id=subject_id, limits=limits)


def looks_like_cvi42(data: bytes) -> bool:
    """Whether a file begins as XML does, in any of the encodings that XML may have."""
    head = data[:256].replace(b"\0", b"").lstrip(b"\xef\xbb\xbf\xff\xfe \t\r\n")
    return head.startswith(b"<")


def _of_ventricles(
    drawn: Sequence[WorkspaceContour], warnings: list[str]
) -> list[WorkspaceContour]:
    ours = [c for c in drawn if _NAME.fullmatch(c.name)]
    others = sorted({c.name for c in drawn} - {c.name for c in ours})
    if not ours:
        found = f"; there are {listed(others)}" if others else ""
        raise unusable(
            f"the workspace has no contours of the ventricles{found}",
            "outline the ventricles (saendocardialContour and its like), export the workspace anew",
        )
    if others:
        warnings.append(f"Contours of no structure known here were left out: {listed(others)}.")
    once: dict[tuple[str, str], WorkspaceContour] = {}
    for contour in ours:
        once.setdefault((contour.image, contour.name), contour)
    if len(once) < len(ours):
        warnings.append(
            f"{len(ours) - len(once)} contours stand again for the same image under the same name; "
            "the first of each was read."
        )
    return list(once.values())


def _with_geometry(
    ours: Sequence[WorkspaceContour], images: Images, warnings: list[str]
) -> list[WorkspaceContour]:
    placed = [c for c in ours if c.image in images]
    missing = {c.image for c in ours} - images.keys()
    if not placed:
        raise unusable(
            f"nothing is known of the {len(missing)} images that the contours were drawn on",
            "send their DICOM files (headers are enough), or a table of their geometry, by SOP "
            "instance UID: see docs/clinical-files.md",
        )
    if missing:
        warnings.append(
            f"{len(ours) - len(placed)} contours on {len(missing)} images of unknown geometry "
            "were left out."
        )
    return placed


def _found(
    placed: Sequence[WorkspaceContour], images: Images, warnings: list[str]
) -> list[FoundContour]:
    found = [_one(contour, images) for contour in placed]
    kept = [contour for contour in found if len(contour.points_mm) >= 3]
    if not kept:
        raise unusable("no contour has three points or more", "outline the ventricles anew")
    counts = Counter(
        {
            "have fewer than three points; they were left out": len(found) - len(kept),
            "do not say their SubpixelResolution; it was taken for 1": sum(
                contour.subpixels is None for contour in placed
            ),
        }
    )
    warnings += [f"{count} contours {what}." for what, count in counts.items() if count]
    return kept


def _one(drawn: WorkspaceContour, images: Images) -> FoundContour:
    axis, right, layer, is_open = _NAME.findall(drawn.name)[0]
    # Whole numbers are centres of pixels, as the readers of this format have it.
    pixels = np.array([drawn.x, drawn.y]).T / (drawn.subpixels or 1.0)
    return FoundContour(
        structure=_STRUCTURES[bool(right), layer],
        closed=axis == "sa" and not is_open,
        # An open contour that comes back to its first point does so along the valve.
        points_mm=images[drawn.image].to_patient(without_repeats(pixels)),
        image=drawn.image,
        view=View.SAX if axis == "sa" else None,
    )
