"""The format is told by the content; what goes with contours may come along, and nothing else."""

import json
from collections.abc import Callable

import pytest

from intake.formats.csl_out import write_csl
from intake.formats.guide_points_out import write_guide_points
from intake.formats.registry import FORMATS, import_study, told_format
from intake.formats.rtstruct_writing import write_rtstruct
from intake.limits import Limits
from schemas.contour_files import ContourFilesRequest, ContourFormat
from schemas.problem import InputError, ProblemType
from schemas.study import ContourStudy
from schemas.vocabulary import Structure, View
from tests.intake.formats.clinical_bytes import workspace
from tests.intake.formats.guide_point_files import heart

Files = dict[str, bytes]

WRITTEN: dict[ContourFormat, Callable[[ContourStudy], Files]] = {
    ContourFormat.GUIDE_POINTS: lambda study: dict(write_guide_points(study).files),
    ContourFormat.CSL: lambda study: dict(write_csl(study).files),
    ContourFormat.RTSTRUCT: lambda study: {
        f"{label}.dcm": content for label, content in write_rtstruct(study).items()
    },
    ContourFormat.CVI42: lambda _: {"work.cvi42wsx": workspace({})},
}
TABLE = json.dumps({"images": []}).encode()


def refused(files: Files) -> InputError:
    with pytest.raises(InputError) as caught:
        told_format(files)
    assert caught.value.type is ProblemType.UNREADABLE_CONTOUR_FILE
    return caught.value


def test_every_format_is_told() -> None:
    assert set(FORMATS) == set(WRITTEN) == set(ContourFormat)


@pytest.mark.parametrize("format_", ContourFormat)
def test_the_content_tells_the_format(beat: ContourStudy, format_: ContourFormat) -> None:
    files = {f"{number}.bin": body for number, body in enumerate(WRITTEN[format_](beat).values())}
    assert told_format(files) is format_


def test_a_table_of_images_goes_with_clinical_files_alone(beat: ContourStudy) -> None:
    clinical = WRITTEN[ContourFormat.RTSTRUCT](beat)
    assert told_format({"table.json": TABLE, **clinical}) is ContourFormat.RTSTRUCT
    assert refused({"table.json": TABLE, **heart()}).pointer == "table.json"
    assert refused({"table.json": TABLE}).pointer == "table.json"
    assert refused({**clinical, "notes.txt": b"hello"}).pointer == "notes.txt"


def test_two_formats_are_no_subject(beat: ContourStudy) -> None:
    both = {**WRITTEN[ContourFormat.RTSTRUCT](beat), **heart()}
    assert "several formats" in refused(both).detail


def test_settings_of_a_format_reach_it(beat: ContourStudy) -> None:
    files = WRITTEN[ContourFormat.RTSTRUCT](beat)
    plain = import_study(files, ContourFilesRequest(), Limits())
    assert [frame.label for frame in plain.study.frames] == ["ED", "ES"]
    # In one view, so that it is seen to be taken for another.
    other = {"structures": {"rv_endo_sax": Structure.RV_EPI}}
    request = ContourFilesRequest.model_validate({"subject_id": "case-01", "rtstruct": other})
    study = import_study(files, request, Limits()).study
    assert study.subject_id == "case-01"
    found = {(s.view, c.structure) for f in study.frames for s in f.slices for c in s.contours}
    assert (View.SAX, Structure.RV_EPI) in found
    assert (View.SAX, Structure.RV_ENDO) not in found
