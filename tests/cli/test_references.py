from pathlib import Path

import pytest

from cli.references import reference_files
from schemas.problem import InputError


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("truth.ply", "ED_lv_endo.stl", "a=b/ES_rv_endo.obj"):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.touch()


@pytest.mark.parametrize(
    ("argument", "surface", "file"),
    [
        ("ED_lv_endo=truth.ply", "ED_lv_endo", "truth.ply"),
        ("ED_lv_endo.stl", "ED_lv_endo", "ED_lv_endo.stl"),
        ("ES_epi=ED_lv_endo.stl", "ES_epi", "ED_lv_endo.stl"),
        ("./a=b/ES_rv_endo.obj", "ES_rv_endo", "a=b/ES_rv_endo.obj"),
    ],
)
def test_a_reference_is_named_or_called_after_its_surface(
    argument: str, surface: str, file: str
) -> None:
    assert reference_files([argument]) == {surface: Path(file)}


def test_there_may_be_several_or_none() -> None:
    assert list(reference_files(["ED_lv_endo.stl", "ED_lv_epi=truth.ply"])) == [
        "ED_lv_endo",
        "ED_lv_epi",
    ]
    assert reference_files([]) == {}


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["truth.ply"], "--reference ED_lv_endo=truth.ply"),
        (["lv_endo=truth.ply"], "names no surface"),
        (["ED_la=truth.ply"], "lv_endo, lv_epi, rv_endo, rv_epi, epi"),
        (["=truth.ply"], "names no surface"),
        (["ED_lv_endo="], "no file"),
        (["ED_lv_endo=gone.ply"], "check the path"),
        (["ED_lv_endo.stl", "ED_lv_endo=truth.ply"], "keep one of them"),
    ],
)
def test_what_cannot_be_meant_is_refused_with_the_remedy(arguments: list[str], said: str) -> None:
    with pytest.raises(InputError) as refused:
        reference_files(arguments)
    assert said in refused.value.detail
