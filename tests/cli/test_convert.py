"""`neuralmri convert`, and contour files where a study is taken."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from cli.inputs import ContourInput, read_input
from cli.label_arguments import LabelArguments
from cli.main import app
from schemas.problem import InputError
from schemas.study import ContourStudy
from tests.intake.formats.guide_point_files import heart


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    inputs = tmp_path / "in"
    inputs.mkdir()
    for name, body in heart().items():
        (inputs / name).write_bytes(body)
    (inputs / ".hidden").write_bytes(b"\0")
    return inputs


def converted(*arguments: object) -> dict[str, object]:
    result = CliRunner().invoke(app, ["convert", *map(str, arguments), "--json"])
    assert result.exit_code == 0, result.output
    document: dict[str, object] = json.loads(result.stdout)
    return document


def test_there_and_back(folder: Path, tmp_path: Path) -> None:
    study = tmp_path / "study.json"
    converted(folder, "--out", study, "--subject-id", "case-01")
    read = ContourStudy.model_validate_json(study.read_bytes())
    assert read.subject_id == "case-01"
    converted(study, "--out", tmp_path / "points", "--to", "guide-points")
    said = converted(study, "--out", tmp_path / "sections", "--to", "csl")
    assert len(said["files"]) == 3  # type: ignore[arg-type]
    converted(study, "--out", tmp_path / "dicom", "--to", "rtstruct")
    for there in ("points", "sections", "dicom"):
        again = tmp_path / f"{there}.json"
        converted(*sorted((tmp_path / there).iterdir()), "--out", again)
        back = ContourStudy.model_validate_json(again.read_bytes())
        assert len(back.frames[0].slices) == 4


def test_commands_that_take_a_study_take_files(folder: Path, tmp_path: Path) -> None:
    settings = tmp_path / "settings.json"
    settings.write_text('{"subject_id": "told", "guide_points": {"views": {"4": "lax_3ch"}}}')
    given = read_input([folder], LabelArguments(), None, format_settings=settings)
    assert isinstance(given, ContourInput)
    assert given.subject_id == "told"
    assert given.request.warnings
    assert given.request.study.frames[0].slices[-1].view == "lax_3ch"


def test_what_cannot_be_read_is_named(tmp_path: Path) -> None:
    stray = tmp_path / "notes.txt"
    stray.write_text("nothing")
    with pytest.raises(InputError, match=r"notes\.txt"):
        read_input([stray], LabelArguments(), None)
    with pytest.raises(InputError, match="subject-id"):
        read_input([stray], LabelArguments(subject_id="a b"), None)
