"""What `reconstruct` and `submit` are given, read: contours in some format, or label maps."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TypeVar

from cli.label_arguments import LabelArguments
from cli.references import reference_files
from schemas.base import WireModel
from schemas.labels import LabelRequest, LabelScheme, TissueLabels
from schemas.messages import ContourRequest
from schemas.options import Options
from schemas.problem import InputError, ProblemType
from schemas.study import ContourStudy
from schemas.vocabulary import View

M = TypeVar("M", bound=WireModel)


@dataclass(frozen=True)
class ContourInput:
    """A contour study. pointer: where it stands in its file, for messages."""

    request: ContourRequest
    pointer: str
    references: Mapping[str, Path] = field(default_factory=dict)
    """Mesh files by the surface that each is the truth of."""

    @property
    def subject_id(self) -> str:
        return self.request.study.subject_id


@dataclass(frozen=True)
class LabelInput:
    """Label maps by view, and how to read them."""

    request: LabelRequest
    files: Mapping[View, Path]
    references: Mapping[str, Path] = field(default_factory=dict)
    """Mesh files by the surface that each is the truth of."""

    @property
    def subject_id(self) -> str:
        return self.request.subject_id


def read_input(
    inputs: Sequence[Path] | None,
    maps: LabelArguments,
    options_file: Path | None,
    references: Sequence[str] = (),
    format_settings: Path | None = None,
) -> ContourInput | LabelInput:
    """What the command line names. Raises InputError, also for both or neither.

    `references` are the arguments that name meshes, see `reference_files`.
    """
    files = reference_files(references)
    read = _read_subject(inputs or (), maps, options_file, format_settings)
    return replace(read, references=files)


def _read_subject(
    inputs: Sequence[Path],
    maps: LabelArguments,
    options_file: Path | None,
    format_settings: Path | None,
) -> ContourInput | LabelInput:
    options = None
    if options_file is not None:
        options = _parsed(options_file.read_bytes(), Options)
    if inputs and not maps.files:
        return read_contours(inputs, maps.subject_id, options, format_settings)
    if maps.files and not inputs:
        return LabelInput(_label_request(maps, options or Options()), maps.files)
    raise InputError(
        ProblemType.INVALID_REQUEST,
        "give either a contour study, or contour files, as INPUT, or label maps with "
        "--label-scheme and --sax (and --lax-2ch, --lax-3ch, --lax-4ch)",
    )


def _parsed(raw: bytes, model: type[M]) -> M:
    """By the parser of the service, with its words and limits."""
    # Loads numpy, which looks up its thread count then: not before the command has said it.
    from intake.json_body import parse_json
    from intake.settings import LimitSettings

    return parse_json(raw, model, LimitSettings().limits())


def read_contours(
    inputs: Sequence[Path], subject_id: str, options: Options | None, settings: Path | None
) -> ContourInput:
    """A JSON document, or contour files of another program. Raises InputError."""
    from cli.contour_files import read_contour_files

    if len(inputs) == 1 and inputs[0].is_file():
        raw = inputs[0].read_bytes()
        if raw.lstrip()[:1] in (b"{", b"[", b"") or inputs[0].suffix.lower() == ".json":
            return _contours(raw, options)
    imported = read_contour_files(inputs, subject_id, settings)
    request = ContourRequest(
        study=imported.study, options=options or Options(), warnings=list(imported.warnings)
    )
    return ContourInput(request, "/study")


def _contours(raw: bytes, options: Options | None) -> ContourInput:
    """A study alone, or a whole request; `options` replaces the request's own."""
    if _is_request(raw):
        request = _parsed(raw, ContourRequest)
        pointer = "/study"
    else:
        request = ContourRequest(study=_parsed(raw, ContourStudy))
        pointer = ""
    if options is not None:
        request = request.model_copy(update={"options": options})
    return ContourInput(request, pointer)


def _is_request(raw: bytes) -> bool:
    try:
        document = json.loads(raw)
    except ValueError:
        return False  # the strict parser says what is wrong with it
    return isinstance(document, dict) and "study" in document


def _label_request(maps: LabelArguments, options: Options) -> LabelRequest:
    if maps.scheme is None:
        raise InputError(
            ProblemType.INVALID_REQUEST,
            "label maps need --label-scheme: it is never guessed, since ACDC and M&Ms swap the "
            f"values 1 and 3; one of {', '.join(LabelScheme)}, or a JSON object",
        )
    # Through JSON, so that a bad value is refused in the words of the service.
    document = {
        "subject_id": maps.subject_id,
        "label_scheme": _scheme(maps.scheme),
        "frame_labels": maps.frame_labels.split(",") if maps.frame_labels else None,
        "spacing": maps.spacing.value,
    }
    request = _parsed(json.dumps(document).encode(), LabelRequest)
    return request.model_copy(update={"options": options})


def _scheme(text: str) -> object:
    if not text.lstrip().startswith("{"):
        return text
    return _parsed(text.encode(), TissueLabels).model_dump(mode="json")
