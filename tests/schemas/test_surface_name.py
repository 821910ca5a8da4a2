import pytest
from hypothesis import given
from hypothesis import strategies as st

from schemas.surface_name import SurfaceName, parse_surface_name
from schemas.vocabulary import Structure


@given(st.from_regex(r"[A-Z0-9.-]{1,64}", fullmatch=True), st.sampled_from(list(Structure)))
def test_a_name_is_read_as_it_is_written(frame: str, structure: Structure) -> None:
    name = SurfaceName(frame, structure)
    assert parse_surface_name(str(name)) == name


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("ED_lv_epi", SurfaceName("ED", Structure.LV_EPI)),
        ("ED_epi", SurfaceName("ED", Structure.EPI)),
        ("t_00_rv_endo", SurfaceName("t_00", Structure.RV_ENDO)),
        ("lv_endo", None),
        ("_lv_endo", None),
        ("lv_epi", SurfaceName("lv", Structure.EPI)),
        ("ED", None),
        ("ED_lv_endo.stl", None),
        ("E D_lv_endo", None),
        ("../ED_lv_endo", None),
        ("ED\n_lv_endo", None),
        ("x" * 65 + "_lv_endo", None),
        ("", None),
    ],
)
def test_the_longest_structure_is_meant(text: str, name: SurfaceName | None) -> None:
    assert parse_surface_name(text) == name
