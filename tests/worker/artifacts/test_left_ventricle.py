"""A ventricle of spheres measures as the formulas say; what is missing is named."""

import numpy as np
import pytest
import trimesh

from schemas.vocabulary import Structure, View
from worker.artifacts.left_ventricle import left_ventricle_report, ventricle_place
from worker.evaluation.support import AlignedOutline
from worker.surface_mesh import SurfaceMesh

UP = np.array([0.0, 0.0, 1.0])
ENDO, EPI, RV = Structure.LV_ENDO, Structure.LV_EPI, Structure.RV_ENDO


def sphere(radius_mm: float, centre: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> SurfaceMesh:
    ball = trimesh.creation.icosphere(subdivisions=5, radius=radius_mm)
    return SurfaceMesh(
        np.asarray(ball.vertices) + np.array(centre), np.asarray(ball.faces, dtype=np.int64)
    )


def circle(slice_id: str, radius_mm: float, height_mm: float, view: View = View.SAX):
    angle = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)
    within = np.sqrt(radius_mm**2 - height_mm**2)
    points = np.column_stack(
        [within * np.cos(angle), within * np.sin(angle), np.full(60, height_mm)]
    )
    return AlignedOutline(slice_id, view, points, True)


def measured(surfaces, closed, outlines, toward_base):
    place = ventricle_place(surfaces, outlines, toward_base)
    return left_ventricle_report(surfaces, closed, toward_base, place)


SURFACES = {ENDO: sphere(25.0), EPI: sphere(35.0), RV: sphere(15.0, (-52.0, 0.0, 0.0))}
OUTLINES = {
    ENDO: [circle("sax-00", 25.0, -10.0), circle("sax-01", 25.0, 10.0)],
    EPI: [circle(f"sax-0{i}", 35.0, z) for i, z in ((0, -10.0), (1, 10.0), (2, 20.0))],
}


def test_spheres_measure_as_the_formulas_say() -> None:
    found = measured(SURFACES, SURFACES, OUTLINES, UP)
    assert found.not_measured == {}
    assert found.long_axis_length_mm == pytest.approx(50.0, abs=0.1)
    assert found.sphericity == pytest.approx(1.0, abs=0.01)
    assert found.mid_area_cm2 == pytest.approx(np.pi * 6.25, rel=5e-3)
    assert found.mid_perimeter_mm == pytest.approx(np.pi * 50.0, rel=5e-3)
    expected_g = 1.05 * 4e-3 / 3 * np.pi * (35.0**3 - 25.0**3)
    assert found.wall_mass_g == pytest.approx(expected_g, rel=5e-3)
    assert sorted(found.wall_thickness_mm) == list(range(1, 18))
    for number in range(1, 17):
        assert found.wall_thickness_mm[number].mean_mm == pytest.approx(10.0, abs=0.03)
    assert found.wall_thickness_mm[8].name == "mid anteroseptal"


def test_the_wall_ends_at_the_most_basal_slice_that_shows_both() -> None:
    """Thick above 10 mm only, where no slice shows the cavity: no segment sees it."""
    bump = SURFACES[EPI]
    high = bump.vertices_mm[:, 2] > 18.0
    lifted = SurfaceMesh(
        np.where(high[:, None], 1.5 * bump.vertices_mm, bump.vertices_mm), bump.faces
    )
    found = measured(SURFACES | {EPI: lifted}, SURFACES, OUTLINES, UP)
    assert max(part.max_mm for n, part in found.wall_thickness_mm.items() if n < 17) < 11.0


def test_a_slice_that_grazes_the_base_is_no_ring() -> None:
    """There the outer surface is in two outlines, and the wall between them has no thickness."""
    grazing = circle("sax-03", 25.0, 22.0)
    halves = [
        AlignedOutline("sax-03", View.SAX, circle("", 35.0, 22.0).points_mm + step, True)
        for step in ([30.0, 0.0, 0.0], [-30.0, 0.0, 0.0])
    ]
    grazed = {ENDO: [*OUTLINES[ENDO], grazing], EPI: [*OUTLINES[EPI], *halves]}
    found, without = (measured(SURFACES, SURFACES, o, UP) for o in (grazed, OUTLINES))
    assert found.wall_thickness_mm == without.wall_thickness_mm


@pytest.mark.parametrize(
    ("without", "outlines", "toward_base", "missing"),
    [
        ({ENDO}, OUTLINES, UP, {"all"}),
        ({EPI}, OUTLINES, UP, {"wall_mass_g", "wall_thickness_mm"}),
        ({RV}, OUTLINES, UP, {"wall_thickness_mm"}),
        (set(), {}, UP, {"wall_thickness_mm"}),
        (
            set(),
            OUTLINES,
            None,
            {
                "long_axis_length_mm",
                "sphericity",
                "mid_area_cm2",
                "mid_perimeter_mm",
                "wall_thickness_mm",
            },
        ),
    ],
)
def test_what_is_missing_is_null_with_its_reason(without, outlines, toward_base, missing) -> None:
    surfaces = {s: mesh for s, mesh in SURFACES.items() if s not in without}
    found = measured(surfaces, surfaces, outlines, toward_base)
    values = found.model_dump(exclude={"not_measured"})
    wanted = set(values) if missing == {"all"} else missing
    assert {name for name, value in values.items() if value is None} == wanted
    assert set(found.not_measured) == wanted
    assert all(reason.endswith(".") for reason in found.not_measured.values())


def test_an_open_cavity_has_a_length_and_no_volume() -> None:
    endo = SURFACES[ENDO]
    below = (endo.vertices_mm[endo.faces, 2] < 15.0).all(axis=1)
    cut = SurfaceMesh(endo.vertices_mm, endo.faces[below])
    opened = SURFACES | {ENDO: cut}
    closed = {s: mesh for s, mesh in SURFACES.items() if s is not ENDO}
    found = measured(opened, closed, OUTLINES, UP)
    assert {"sphericity", "mid_area_cm2", "wall_mass_g"} <= set(found.not_measured)
    assert "closed base" in found.not_measured["sphericity"]


def test_a_right_ventricle_above_the_left_shows_no_septum() -> None:
    above = SURFACES | {RV: sphere(15.0, (0.0, 0.0, 60.0))}
    found = measured(above, above, OUTLINES, UP)
    assert "not beside" in found.not_measured["wall_thickness_mm"]
