import json
from pathlib import Path
from typing import Any

import pytest

from cli.inputs import ContourInput, LabelInput, read_input
from cli.label_arguments import LabelArguments
from schemas.labels import LabelScheme, Spacing, TissueLabels
from schemas.options import Preset
from schemas.problem import InputError
from schemas.vocabulary import View

STUDY: dict[str, Any] = {
    "subject_id": "case-01",
    "units": "cm",
    "axes": "RAS",
    "frames": [
        {
            "label": "ED",
            "slices": [
                {
                    "id": "sax-00",
                    "contours": [
                        {"structure": "lv_endo", "points": [[0, 0, 0], [1, 0, 0], [0, 1, 0]]}
                    ],
                }
            ],
        }
    ],
}


def maps(**given: Any) -> LabelArguments:
    nothing = dict.fromkeys(("scheme", "sax", "lax_2ch", "lax_3ch", "lax_4ch", "frame_labels"))
    return LabelArguments(**{**nothing, "subject_id": "subject", "spacing": Spacing.AUTO, **given})


def written(path: Path, document: object) -> Path:
    path.write_text(json.dumps(document))
    return path


@pytest.mark.parametrize(("wrapped", "pointer"), [(False, ""), (True, "/study")])
def test_a_study_alone_and_a_whole_request_are_both_read(
    wrapped: bool, pointer: str, tmp_path: Path
) -> None:
    document = {"study": STUDY, "options": {"preset": "fast"}} if wrapped else STUDY
    given = read_input([written(tmp_path / "in.json", document)], maps(), None)
    assert isinstance(given, ContourInput)
    assert given.pointer == pointer
    assert given.request.study.subject_id == "case-01"
    assert (given.request.options.preset is Preset.FAST) == wrapped


def test_an_options_file_wins_over_the_requests_own(tmp_path: Path) -> None:
    request = {"study": STUDY, "options": {"preset": "fast", "seed": 5}}
    options = written(tmp_path / "options.json", {"preset": "paper"})
    given = read_input([written(tmp_path / "in.json", request)], maps(), options)
    assert given.request.options.preset is Preset.PAPER
    assert given.request.options.seed == 0


def test_label_maps_are_read_by_view_with_a_published_scheme(tmp_path: Path) -> None:
    sax, lax = tmp_path / "sax.nii", tmp_path / "lax.nii.gz"
    options = written(tmp_path / "options.json", {"seed": 5})
    arguments = maps(scheme="acdc", sax=sax, lax_4ch=lax, frame_labels="ED,ES", subject_id="x")
    given = read_input(None, arguments, options)
    assert isinstance(given, LabelInput)
    assert given.files == {View.SAX: sax, View.LAX_4CH: lax}
    assert given.request.label_scheme is LabelScheme.ACDC
    assert given.request.frame_labels == ["ED", "ES"]
    assert (given.subject_id, given.request.options.seed) == ("x", 5)


def test_a_scheme_of_ones_own_is_a_json_object(tmp_path: Path) -> None:
    given = read_input(None, maps(scheme='{"lv_cavity": [7]}', sax=tmp_path / "sax.nii"), None)
    assert isinstance(given, LabelInput)
    assert given.request.label_scheme == TissueLabels(lv_cavity=[7])


@pytest.mark.parametrize(
    ("study", "arguments", "words"),
    [
        (None, maps(), "--sax"),
        ("in.json", maps(scheme="acdc", sax=Path("sax.nii")), "either"),
        (None, maps(sax=Path("sax.nii")), "--label-scheme"),
        (None, maps(scheme="unheard-of", sax=Path("sax.nii")), "label_scheme"),
        (None, maps(scheme="{", sax=Path("sax.nii")), "JSON"),
        (None, maps(scheme="acdc", sax=Path("sax.nii"), frame_labels="ED,ed"), "frame_labels"),
        (None, maps(scheme="acdc", sax=Path("sax.nii"), subject_id="a b"), "subject_id"),
    ],
)
def test_what_cannot_be_meant_is_refused_with_the_remedy(
    study: str | None, arguments: LabelArguments, words: str, tmp_path: Path
) -> None:
    path = written(tmp_path / study, STUDY) if study else None
    with pytest.raises(InputError) as refused:
        read_input([path] if path else None, arguments, None)
    assert words in refused.value.detail


def test_references_go_with_either_kind_of_input(tmp_path: Path) -> None:
    study = written(tmp_path / "in.json", STUDY)
    truth = tmp_path / "ED_lv_endo.ply"
    truth.touch()
    for given in (
        read_input([study], maps(), None, [str(truth)]),
        read_input(None, maps(scheme="acdc", sax=tmp_path / "sax.nii"), None, [str(truth)]),
    ):
        assert given.references == {"ED_lv_endo": truth}
    assert read_input([study], maps(), None).references == {}


@pytest.mark.parametrize("text", ["", "{", "[1, 2]", '{"study": 3}', '{"subject_id": "a"}'])
def test_a_file_that_is_no_study_is_refused(text: str, tmp_path: Path) -> None:
    path = tmp_path / "in.json"
    path.write_text(text)
    with pytest.raises(InputError):
        read_input([path], maps(), None)
