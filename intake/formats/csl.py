"""Cross-section files (`.csl`), one for each frame and structure, or with labels of several."""

import re
from collections.abc import Mapping

import numpy as np

from intake.formats.csl_planes import CslPlane, read_planes
from intake.formats.faults import unreadable
from intake.formats.imported import ImportedStudy
from intake.formats.parallel_planes import stack_of
from intake.limits import Limits
from schemas.contour_files import CslSettings
from schemas.study import Contour, ContourStudy, Frame, Slice
from schemas.vocabulary import Structure, View

_NAME = re.compile(
    rf"(?:(?P<frame>[A-Za-z0-9._-]{{1,40}}?)_)??(?P<structure>{'|'.join(Structure)})\.csl",
    re.IGNORECASE | re.ASCII,
)


def read_csl(
    files: Mapping[str, bytes],
    settings: CslSettings | None = None,
    *,
    subject_id: str = "subject",
    limits: Limits | None = None,
) -> ImportedStudy:
    """The study in cross-section files; planes that several files share become one slice.

    A plane without a component of a structure that its file is of says that the structure is not
    there: it is listed absent. The largest family of parallel planes is the short axis.

    Raises:
        InputError: `UNREADABLE_CONTOUR_FILE`, naming file and line, or a file whose structure
            neither its name nor `settings` tells.
    """
    settings, limits = settings or CslSettings(), limits or Limits()
    left = limits.max_points
    frames: dict[str, dict[tuple[float, ...], _Plane]] = {}
    for name, content in sorted(files.items()):
        planes = read_planes(name, content, left)
        left -= sum(len(points) for plane in planes for _, points in plane.components)
        frame, structures = _told(name, planes, settings)
        own = frames.setdefault(frame, {})
        for plane in planes:
            _key(own, plane).add(plane, structures)
    warnings = [
        "Cross-section files name no views: the largest family of parallel planes was taken for "
        "the short-axis stack, and every other plane is `other`."
    ]
    study = ContourStudy(
        subject_id=subject_id,
        units=settings.units,
        axes=settings.axes,
        frames=[Frame(label=label, slices=_slices(own)) for label, own in frames.items()],
    )
    return ImportedStudy(study, tuple(warnings))


class _Plane:
    """A plane, and what its files say of it."""

    def __init__(self, plane: CslPlane) -> None:
        self.plane = plane
        self.contours: list[Contour] = []
        self.asked: set[Structure] = set()

    def add(self, plane: CslPlane, structures: Mapping[str, Structure]) -> None:
        self.asked |= set(structures.values())
        self.contours += [
            Contour(structure=structures[label], points=list(points))
            for label, points in plane.components
        ]

    @property
    def absent(self) -> list[Structure]:
        outlined = {contour.structure for contour in self.contours}
        return [one for one in Structure if one in self.asked - outlined]


def _key(own: dict[tuple[float, ...], _Plane], plane: CslPlane) -> _Plane:
    normal = np.array(plane.normal)
    length = float(np.linalg.norm(normal))
    key = (plane.number, *(normal / length).round(4).tolist(), round(plane.offset / length, 3))
    return own.setdefault(key, _Plane(plane))


def _told(
    name: str, planes: list[CslPlane], settings: CslSettings
) -> tuple[str, dict[str, Structure]]:
    """The frame of a file, and structures by its labels."""
    match = _NAME.fullmatch(name)
    labels = sorted({label for plane in planes for label, _ in plane.components})
    if settings.structures:
        unknown = [label for label in labels if label not in settings.structures]
        if unknown:
            raise unreadable(
                name,
                f"label {unknown[0]} is not among `csl.structures`",
                "name the structure of every label there",
            )
        frame = match["frame"] if match else _frame_of(name)
        return frame or "ED", dict(settings.structures)
    if match is None or len(labels) > 1:
        why = "several labels" if match else "a name that ends in no structure"
        raise unreadable(
            name,
            f"the file has {why}, so it is not known which structure it outlines",
            "name the structures of its labels in `csl.structures`, as in "
            '{"1": "lv_endo"}, or call it by frame and structure, as in ED_lv_endo.csl',
        )
    structure = Structure(match["structure"].lower())
    return match["frame"] or "ED", {label: structure for label in labels or ["1"]}


def _frame_of(name: str) -> str:
    return re.sub(r"[^A-Za-z0-9._-]+", "-", name.rsplit(".", 1)[0])[:60]


def _slices(own: dict[tuple[float, ...], _Plane]) -> list[Slice]:
    planes = list(own.values())
    in_stack = stack_of(np.array([one.plane.normal for one in planes]))
    slices: list[Slice] = []
    taken: set[str] = set()
    for one, is_sax in zip(planes, in_stack, strict=True):
        a, b, c = one.plane.normal
        scale = -one.plane.offset / (a * a + b * b + c * c)
        name = f"plane-{one.plane.number}"
        while name in taken:
            name += "-b"
        taken.add(name)
        slices.append(
            Slice(
                id=name[:64],
                view=View.SAX if is_sax else View.OTHER,
                origin=(a * scale, b * scale, c * scale),
                normal=(a, b, c),
                contours=one.contours,
                absent=one.absent,
            )
        )
    return slices
