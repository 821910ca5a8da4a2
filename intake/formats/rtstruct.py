"""DICOM RT Structure Sets (PS3.3, A.19) as a contour study."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import PurePath

from intake.formats.assembled import assembled, check_counts
from intake.formats.clinical_faults import unusable
from intake.formats.companions import read_companions
from intake.formats.dicom_file import is_dicom
from intake.formats.found_contour import FoundContour
from intake.formats.found_planes import found_planes
from intake.formats.image_geometry import Images
from intake.formats.imported import ImportedStudy
from intake.formats.roi_names import listed, understood
from intake.formats.rtstruct_file import StructureSet, is_structure_set, read_structure_set
from intake.limits import Limits
from schemas.study import ContourStudy
from schemas.vocabulary import Structure

DEFAULT_LIMITS = Limits()
NOTHING_GIVEN: Mapping[str, Structure] = {}

_NAMES_REMEDY = (
    "say which name is which structure (LV endocardium, LV_ENDO, RV epicardium and their like "
    "are known)"
)


def read_rtstruct(
    files: Mapping[str, bytes],
    *,
    structures: Mapping[str, Structure] = NOTHING_GIVEN,
    subject_id: str = "subject",
    limits: Limits = DEFAULT_LIMITS,
) -> ImportedStudy:
    """The study in the RT Structure Sets among `files` (by name); the others tell of their images.

    Names of regions that mean nothing are left out with a warning, never guessed. Frames come
    from ED and ES in their names, else from the times of the images (their DICOM headers or a
    geometry table), else from ED and ES in the names of all files, else each file is a frame
    where files outline the same planes. Of the patient nothing is taken: the subject is
    `subject_id`.

    Args:
        files: RT Structure Sets, and as wished DICOM images or geometry tables.
        structures: what names mean, whole and in any case; goes before the names known here.
        subject_id: the study's.
        limits: of the study.

    Raises:
        InputError: no region with a known name, a file that cannot be read, too much of it, or
            contours whose instants cannot be told apart.
    """
    sets = {name: data for name, data in files.items() if looks_like_rtstruct(data)}
    rest = {name: data for name, data in files.items() if name not in sets}
    if not sets:
        # Another kind of file is refused for what it is.
        for name, data in files.items():
            read_structure_set(data, name, structures, limits)
        raise unusable("there is no RT Structure Set", "send at least one DICOM RTSTRUCT file")
    images, warnings = read_companions(rest, limits)
    read = {n: read_structure_set(d, n, structures, limits) for n, d in sets.items()}
    _check_names(read.values(), structures)
    contours = _by_file(read, images, limits)
    if not contours:
        raise unusable(
            "the regions of the ventricles have no planar contours", "outline them, export anew"
        )
    warnings += _left_out(read.values())
    once = _without_copies(contours)
    if len(once) < len(contours):
        warnings.append(f"{len(contours) - len(once)} contours stand twice and were read once.")
    imported = assembled(once, images, warnings, subject_id=subject_id, limits=limits)
    return replace(imported, warnings=(*imported.warnings, *_readings(imported.study)))


def looks_like_rtstruct(data: bytes) -> bool:
    """Whether a file is an RT Structure Set, by what it begins with."""
    return is_dicom(data) and is_structure_set(data)


def _check_names(sets: Iterable[StructureSet], structures: Mapping[str, Structure]) -> None:
    found = list(sets)
    known = [name for one in found for name in one.known]
    unknown = [name for one in found for name in one.unknown]
    if not known and not unknown:
        raise unusable("the RT Structure Set has no regions", "outline the ventricles, export anew")
    if not known:
        raise unusable(f"no region's name is known; the names are {listed(unknown)}", _NAMES_REMEDY)
    there = {name.casefold() for name in (*known, *unknown)}
    missing = [name for name in structures if name.strip().casefold() not in there]
    if missing:
        raise unusable(
            f"no region is called {listed(missing)}; the names are {listed(known + unknown)}",
            "give the names as the file has them",
        )


def _by_file(
    read: Mapping[str, StructureSet], images: Images, limits: Limits
) -> list[FoundContour]:
    """All contours; where neither regions nor images tell instants apart, labelled by their file:
    as all files are called, else by number where files outline the same planes.
    """
    by_file = [one.contours for one in read.values()]
    contours = [contour for one in by_file for contour in one]
    check_counts([len(c.points_mm) for c in contours], limits)
    if any(c.instant for c in contours) or all(_is_timed(c, images) for c in contours):
        return contours
    called = [one.instant or understood(PurePath(n).stem, {}).instant for n, one in read.items()]
    labels = [label or "" for label in called]
    if not all(labels):
        if not _share_planes(by_file, images):
            return contours
        labels = [f"t{number:02d}" for number in range(len(by_file))]
    return [
        replace(c, instant=label) for label, one in zip(labels, by_file, strict=True) for c in one
    ]


def _is_timed(contour: FoundContour, images: Images) -> bool:
    image = images.get(contour.image)
    return image is not None and (
        image.temporal_position is not None or image.trigger_ms is not None
    )


def _share_planes(by_file: Sequence[Sequence[FoundContour]], images: Images) -> bool:
    """Whether two files outline the same structure in the same plane."""
    contours = [contour for one in by_file for contour in one]
    file_of = [number for number, one in enumerate(by_file) for _ in one]
    planes, _ = found_planes(contours, images)
    outlined = {
        (contours[i].structure, number, file_of[i])
        for number, plane in enumerate(planes)
        for i in plane.contours
    }
    return len(outlined) > len({(structure, plane) for structure, plane, _ in outlined})


def _left_out(sets: Iterable[StructureSet]) -> list[str]:
    found = list(sets)
    unknown = [name for one in found for name in one.unknown]
    warnings = []
    if unknown:
        warnings.append(f"Regions of no known structure were left out: {listed(unknown)}.")
    for why, count in sum((one.left_out for one in found), Counter()).items():
        warnings.append(f"{count} contours {why}; they were left out.")
    return warnings


def _without_copies(contours: list[FoundContour]) -> list[FoundContour]:
    """Each outline once: one that stands twice would leave itself out as its own hole."""
    seen = {(c.structure, c.instant, c.image, c.points_mm.tobytes()): c for c in reversed(contours)}
    kept = set(map(id, seen.values()))
    return [contour for contour in contours if id(contour) in kept]


def _readings(study: ContourStudy) -> list[str]:
    """What of the study rests on a reading that the standard does not settle."""
    slices = [s for frame in study.frames for s in frame.slices]
    several = sum(
        max(Counter(c.structure for c in s.contours if c.closed).values(), default=0) > 1
        for s in slices
    )
    across = sum(c.closed for s in slices if s.view.is_long_axis for c in s.contours)
    warnings = []
    if several:
        warnings.append(
            f"{several} slices have several contours of one structure: one within another is "
            "taken for a hole."
        )
    if across:
        warnings.append(
            f"{across} long-axis contours are closed: their line across the valve is taken for a "
            "border of the structure."
        )
    return warnings
