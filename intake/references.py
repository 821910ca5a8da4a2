"""Reference meshes beside a study: what their parts are called, and whether they fit it.

A reference has the name of the surface that it is the truth of, `ED_lv_endo`; the part of a form
that carries it is `reference_ED_lv_endo`.
"""

from collections.abc import Iterable, Mapping
from typing import BinaryIO

from intake.limits import Limits
from intake.mesh_header import check_mesh_file
from intake.support import frame_surfaces
from schemas.options import Options
from schemas.problem import InputError, ProblemType
from schemas.study import ContourStudy, Frame
from schemas.surface_name import SurfaceName, parse_surface_name

_PREFIX = "reference_"


def reference_part(surface: str) -> str:
    """The part of a form that carries the reference of a surface, and its place in messages."""
    return f"{_PREFIX}{surface}"


def referenced_surface(part: str) -> str | None:
    """The surface whose reference a part of a form carries; None for any other part."""
    surface = part.removeprefix(_PREFIX)
    return surface if surface != part and parse_surface_name(surface) else None


def judge_references(files: Mapping[str, BinaryIO], limits: Limits) -> dict[str, str]:
    """Judge meshes, by surface, and say what each is called in the job's inputs.

    Raises:
        InputError: as `check_mesh_file`, at the part of the form.
    """
    return {
        surface: f"{part}.{check_mesh_file(file, part, limits.max_mesh_triangles)}"
        for surface, file in files.items()
        for part in [reference_part(surface)]
    }


def check_reference_surfaces(
    study: ContourStudy, options: Options, surfaces: Iterable[str]
) -> dict[str, Frame]:
    """Refuse a reference of a surface that a job of this study does not make.

    The study must have been admitted. Returns the frame of each surface.

    Raises:
        InputError: `INVALID_REQUEST`, at the part of the form.
    """
    by_label = {frame.label: frame for frame in study.frames}
    frames = {}
    for surface in surfaces:
        name = parse_surface_name(surface)
        if name is None:
            raise _refused(surface, "it names no surface", "name it as in ED_lv_endo")
        if name.frame not in by_label:
            raise _refused(
                surface,
                f"the study has no frame {name.frame}",
                f"name it after a frame of the study ({', '.join(by_label)}), or leave it out",
            )
        frames[surface] = by_label[name.frame]
        _check_structure(name, frames[surface], options)
    return frames


def _check_structure(name: SurfaceName, frame: Frame, options: Options) -> None:
    made = frame_surfaces(frame, options)
    if name.structure in made:
        return
    if options.surfaces is not None and name.structure not in options.surfaces:
        why = f"{name.structure} is not among the requested surfaces"
        remedy = "add it to `options.surfaces`, or leave the reference out"
    else:
        why = f"frame {frame.label} has too few contours of {name.structure} to reconstruct it"
        remedy = f"send references of what is made of the frame only ({', '.join(made)})"
    raise _refused(str(name), why, remedy)


def _refused(surface: str, why: str, remedy: str) -> InputError:
    part = reference_part(surface)
    return InputError(
        ProblemType.INVALID_REQUEST,
        f"`{part}` is a reference of nothing that this job makes: {why}. Remedy: {remedy}.",
        pointer=part,
    )
