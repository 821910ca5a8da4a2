"""References fit the study, or are refused at the part that carries them."""

from io import BytesIO

import pytest
import trimesh

from intake.limits import Limits
from intake.references import (
    check_reference_surfaces,
    judge_references,
    reference_part,
    referenced_surface,
)
from schemas.options import Options
from schemas.problem import InputError, ProblemType
from schemas.study import ContourStudy
from schemas.vocabulary import Structure
from tests.studies.ellipsoid import good_request

BALL = trimesh.creation.icosphere(subdivisions=1, radius=20.0)


@pytest.fixture
def study() -> ContourStudy:
    """One frame, ED, with lv_endo, lv_epi and rv_endo."""
    return ContourStudy.model_validate(good_request()["study"])


@pytest.mark.parametrize("surface", ["ED_lv_endo", "t_00_epi", "-_rv_epi"])
def test_a_part_is_named_after_its_surface(surface: str) -> None:
    assert referenced_surface(reference_part(surface)) == surface


@pytest.mark.parametrize(
    "part", ["ED_lv_endo", "reference_", "reference_ED", "reference_ED_la", "Reference_ED_epi", ""]
)
def test_other_parts_carry_no_reference(part: str) -> None:
    assert referenced_surface(part) is None


def test_the_surfaces_of_a_study_may_have_references(study: ContourStudy) -> None:
    names = ["ED_lv_endo", "ED_lv_epi", "ED_rv_endo"]
    found = check_reference_surfaces(study, Options(), names)
    assert found == dict.fromkeys(names, study.frames[0])


@pytest.mark.parametrize(
    ("surface", "surfaces", "said"),
    [
        ("ES_lv_endo", None, "no frame ES.*after a frame of the study \\(ED\\)"),
        ("ed_lv_endo", None, "no frame ed"),
        ("ED_rv_epi", None, "too few contours of rv_epi.*\\(lv_endo, lv_epi, rv_endo\\)"),
        ("ED_lv_epi", [Structure.LV_ENDO], "not among the requested.*options.surfaces"),
        ("lv_endo", None, "names no surface"),
    ],
)
def test_a_reference_of_nothing_is_refused_with_the_remedy(
    study: ContourStudy, surface: str, surfaces: list[Structure] | None, said: str
) -> None:
    with pytest.raises(InputError, match=said) as caught:
        check_reference_surfaces(study, Options(surfaces=surfaces), ["ED_lv_endo", surface])
    assert caught.value.pointer == f"reference_{surface}"
    assert caught.value.type is ProblemType.INVALID_REQUEST


def test_meshes_are_stored_by_surface_and_content() -> None:
    files = {
        "ED_lv_endo": BytesIO(BALL.export(file_type="ply")),
        "ED_lv_epi": BytesIO(BALL.export(file_type="stl")),
        "ES_epi": BytesIO(BALL.export(file_type="obj").encode()),
    }
    assert judge_references(files, Limits()) == {
        "ED_lv_endo": "reference_ED_lv_endo.ply",
        "ED_lv_epi": "reference_ED_lv_epi.stl",
        "ES_epi": "reference_ES_epi.obj",
    }


def test_a_mesh_is_held_against_the_limit_of_its_kind() -> None:
    files = {"ED_lv_endo": BytesIO(BALL.export(file_type="ply"))}
    with pytest.raises(InputError, match="at most 10 are accepted") as caught:
        judge_references(files, Limits(max_mesh_triangles=10))
    assert caught.value.pointer == "reference_ED_lv_endo"
