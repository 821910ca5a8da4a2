"""Names of regions: what they mean, and what means nothing."""

import pytest

from intake.formats.roi_names import WELL_KNOWN, listed, understood, view_told
from schemas.vocabulary import Structure, View

S = Structure


@pytest.mark.parametrize(
    ("name", "structure", "instant", "view"),
    [
        ("LV_ENDO", S.LV_ENDO, None, None),
        ("lvendo", S.LV_ENDO, None, None),
        ("Left Ventricle Endocardium", S.LV_ENDO, None, None),
        ("LV blood-pool contour", S.LV_ENDO, None, None),
        ("LV Epicardial, ED", S.LV_EPI, "ED", None),
        ("RV cavity (end systole)", S.RV_ENDO, "ES", None),
        ("RVEPI_ES_SAX", S.RV_EPI, "ES", View.SAX),
        ("LV_ENDO_LAX_2CH", S.LV_ENDO, None, View.LAX_2CH),
        ("4ch rv endo", S.RV_ENDO, None, View.LAX_4CH),
        ("BIV_EPI", S.EPI, None, None),
        ("LV", None, None, None),
        ("myocardium", None, None, None),
        ("epi", None, None, None),
        ("LV wall ED", None, "ED", None),
        ("LA endo", None, None, None),
        ("not LV endo", None, None, None),
        ("LV endo 2", None, None, None),
        ("", None, None, None),
        ("ÉPI", None, None, None),
    ],
)
def test_names(
    name: str, structure: Structure | None, instant: str | None, view: View | None
) -> None:
    found = understood(name, {})
    assert (found.structure, found.instant, found.view) == (structure, instant, view)


@pytest.mark.parametrize("name", sorted(WELL_KNOWN))
def test_every_known_name_is_found_however_it_is_spelled(name: str) -> None:
    for spelled in (name, name.upper(), name.replace(" ", "_"), f" {name.title()} ES"):
        assert understood(spelled, {}).structure is WELL_KNOWN[name]


def test_a_given_name_is_whole_and_in_any_case() -> None:
    given = {"LV": S.LV_EPI, "lv_endo": S.RV_ENDO}
    assert understood(" lv ", given).structure is S.LV_EPI
    assert understood("LV_Endo", given).structure is S.RV_ENDO
    assert understood("LV_Endo ED", given).structure is S.LV_ENDO


def test_series_descriptions() -> None:
    assert view_told("cine_4CH bSSFP") is View.LAX_4CH
    assert view_told("CINE_retro SAX 8mm") is View.SAX
    assert view_told("localizer") is None


def test_listed_names_are_short_printable_and_few() -> None:
    said = listed(["a\nb", "x" * 500, "x" * 500, *map(str, range(50))])
    assert "\n" not in said
    assert len(said) < 400
    assert said.endswith("and 32 more")
