import itertools

import numpy as np
import pytest

from schemas.problem import InputError
from schemas.vocabulary import Structure
from worker.evaluation.size import volume_ml
from worker.evaluation.topology import euler_number, is_outward
from worker.evaluation.triangle_crossings import crossings, self_intersections
from worker.phantom.beating import Beat, BeatingHeart, CardiacCycle, Infarct

LV = (Structure.LV_ENDO, Structure.LV_EPI)
COUNT = 12


@pytest.fixture(scope="module")
def times_ms(beating):
    return beating.beat.cycle.frame_times_ms(COUNT)


@pytest.fixture(scope="module")
def surfaces(beating, times_ms):
    return beating.surfaces(times_ms, 2.0)


def normals_and_areas(mesh) -> tuple[np.ndarray, np.ndarray]:
    corners = mesh.triangles_mm
    doubled = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(doubled, axis=1)
    return doubled / length[:, None], length / 2.0


def test_at_end_diastole_every_point_is_where_it_began(beating, surfaces):
    beat_ms = beating.beat.cycle.duration_ms
    for structure, moving in surfaces.items():
        began = beating.rest.meshes(2.0)[structure]
        np.testing.assert_array_equal(moving.faces, began.faces)
        np.testing.assert_allclose(moving.vertices_mm[0], began.vertices_mm, atol=1e-12)
        later = beating.trajectories_mm(began.vertices_mm, beat_ms * np.array([1.0, -2.0]))
        np.testing.assert_allclose(later[0], began.vertices_mm, atol=1e-9)
        np.testing.assert_allclose(later[1], began.vertices_mm, atol=1e-9)


def test_every_frame_is_closed_and_outward(surfaces):
    for moving in surfaces.values():
        for i in range(COUNT):
            assert is_outward(moving.frame(i))
            assert euler_number(moving.frame(i)) == 2


def test_no_face_turns_over(beating, times_ms, surfaces):
    """Each face looks where Nanson's formula carries its normal."""
    for moving in surfaces.values():
        normals, _ = normals_and_areas(moving.frame(0))
        middle = moving.frame(0).triangles_mm.mean(axis=1)
        for i, time_ms in enumerate(times_ms.tolist()):
            expected = beating.carried_areas(middle, normals, time_ms)
            now, _ = normals_and_areas(moving.frame(i))
            assert np.sum(now * expected, axis=1).min() > 0.0


def test_surfaces_do_not_pass_through_themselves_or_each_other(beating):
    """Where they are closest: at end-systole."""
    end_ms = np.array([beating.beat.cycle.end_systole_ms])
    found = [moving.frame(0) for moving in beating.surfaces(end_ms, 2.5).values()]
    for one, other in itertools.combinations(found, 2):
        assert not len(crossings(one, other))
    for one in found:
        assert not len(self_intersections(one))


def test_normals_are_those_of_the_faces_at_rest_and_carried(healthy):
    time_ms = healthy.beat.cycle.end_systole_ms
    for structure, moving in healthy.surfaces(np.array([0.0, time_ms]), 1.5).items():
        before, after = moving.frame(0), moving.frame(1)
        middle = before.triangles_mm.mean(axis=1)
        normals = healthy.rest_normals(structure, middle)
        carried = healthy.carried_areas(middle, normals, time_ms)
        carried /= np.linalg.norm(carried, axis=1, keepdims=True)
        for found, mesh in ((normals, before), (carried, after)):
            cosine = np.sum(found * normals_and_areas(mesh)[0], axis=1)
            assert np.median(cosine) > 0.9995, structure
            assert np.percentile(cosine, 2) > 0.95, structure


def test_trajectories_stay_on_the_surface(beating, times_ms, surfaces):
    for structure, moving in surfaces.items():
        for i, time_ms in enumerate(times_ms.tolist()):
            off = beating.implicit_mm(structure, moving.vertices_mm[i], time_ms)
            assert np.abs(off).max() < 1e-3


def test_mesh_volumes_go_to_the_exact_ones(beating):
    times_ms = np.array([0.0, 200.0, beating.beat.cycle.end_systole_ms])
    exact = beating.lv_volumes_ml(times_ms)
    coarse, fine = (beating.surfaces(times_ms, edge) for edge in (2.4, 1.2))
    for structure in LV:
        for i, expected in enumerate(exact[structure]):
            off = [abs(volume_ml(s[structure].frame(i)) - expected) for s in (coarse, fine)]
            assert off[1] < 2e-3 * expected
            assert off[1] < off[0] / 2.5


def test_the_wall_keeps_its_volume(beating, surfaces):
    exact = beating.lv_volumes_ml(np.linspace(0.0, 3000.0, 200))
    wall = exact[Structure.LV_EPI] - exact[Structure.LV_ENDO]
    np.testing.assert_allclose(wall, wall[0], rtol=1e-12)
    meshed = [np.subtract(*(volume_ml(surfaces[s].frame(i)) for s in LV[::-1])) for i in range(3)]
    assert np.ptp(meshed) < 2e-3 * wall[0]


def test_the_rv_has_its_share_of_volume(beating, times_ms, surfaces):
    moving = surfaces[Structure.RV_ENDO]
    volumes = np.array([volume_ml(moving.frame(i)) for i in range(COUNT)])
    np.testing.assert_allclose(volumes / volumes[0], beating.rv_shares(times_ms), rtol=2e-3)
    at_end = beating.rv_shares(np.array([beating.beat.cycle.end_systole_ms]))[0]
    assert 1.0 - at_end == pytest.approx(beating.beat.rv_ejection_fraction_percent / 100.0)


def test_lv_wall_and_rv_are_apart(beating, times_ms, surfaces):
    for i, time_ms in enumerate(times_ms.tolist()):
        rv = surfaces[Structure.RV_ENDO].vertices_mm[i]
        assert beating.implicit_mm(Structure.LV_EPI, rv, time_ms).min() > 0.0
        lv = surfaces[Structure.LV_EPI].vertices_mm[i]
        assert beating.implicit_mm(Structure.RV_ENDO, lv, time_ms).min() > 0.0


@pytest.mark.parametrize(
    ("fraction", "infarct"),
    [
        (10.0, None),
        (25.0, Infarct()),
        (45.0, Infarct(half_width_deg=20.0)),
        (60.0, None),
        (70.0, None),
    ],
)
def test_ejection_fraction_and_volume_are_those_asked_for(fraction, infarct):
    beat = Beat(edv_ml=140.0, ejection_fraction_percent=fraction, infarct=infarct)
    beating = BeatingHeart(beat=beat)
    times_ms = np.array([0.0, beat.cycle.end_systole_ms])
    moving = beating.surfaces(times_ms, 1.2)[Structure.LV_ENDO]
    full, emptied = (volume_ml(moving.frame(i)) for i in range(2))
    assert full == pytest.approx(140.0, rel=2e-3)
    assert 100.0 * (1.0 - emptied / full) == pytest.approx(fraction, abs=0.1)


def test_the_axis_shortens_as_asked(healthy):
    times_ms = np.array([0.0, healthy.beat.cycle.end_systole_ms])
    moving = healthy.surfaces(times_ms, 3.0)[Structure.LV_EPI]
    lengths = [np.ptp(healthy.pose.to_heart(p)[:, 2]) for p in moving.vertices_mm]
    assert lengths[1] / lengths[0] == pytest.approx(0.85, abs=1e-12)


def test_the_twist_is_linear_along_the_axis_and_opposite_at_the_ends(healthy):
    heights = np.linspace(healthy.profile.apex_mm, healthy.profile.base_mm, 7)
    points = np.column_stack([np.full(7, 0.01), np.zeros(7), heights])
    end_ms = np.array([healthy.beat.cycle.end_systole_ms])
    there = healthy.trajectories_mm(healthy.pose.to_patient(points), end_ms)[0]
    own = healthy.pose.to_heart(there)
    turns = -np.degrees(np.arctan2(own[:, 1], own[:, 0]))
    np.testing.assert_allclose(turns, np.linspace(8.0, -4.0, 7), atol=1e-9)


def test_a_healthy_wall_thickens_by_a_third_to_two_thirds(healthy):
    wall = np.array([[24.5, 0.0, 0.0], [33.5, 0.0, 0.0]])
    end_ms = np.array([healthy.beat.cycle.end_systole_ms])
    there = healthy.trajectories_mm(healthy.pose.to_patient(wall), end_ms)[0]
    assert 9.0 * 4 / 3 < np.linalg.norm(there[1] - there[0]) < 9.0 * 5 / 3


def test_an_infarcted_wall_does_not_thicken_while_the_rest_does(infarcted):
    profile, window = infarcted.profile, infarcted.beat.infarct
    depth = profile.layout.lv_inner.semi_axes_mm[2]
    times_ms = infarcted.beat.cycle.frame_times_ms(20)

    def thickness_mm(rise: float, degrees: float) -> np.ndarray:
        height = np.array([(rise - 1.0) * depth])
        radii = np.sqrt([profile.cavity_mm2(height)[0][0], profile.outer_mm2(height)[0][0]])
        angle = np.radians(degrees)
        points = np.column_stack([radii * np.cos(angle), radii * np.sin(angle), [height[0]] * 2])
        paths = infarcted.trajectories_mm(infarcted.pose.to_patient(points), times_ms)
        return np.linalg.norm(paths[:, 1] - paths[:, 0], axis=1)

    middle = thickness_mm((window.low + window.high) / 2.0, window.centre_deg)
    np.testing.assert_allclose(middle, middle[0], rtol=1e-12)
    for rise in (window.low, window.high):
        for degrees in (window.centre_deg - window.half_width_deg, window.centre_deg):
            within = thickness_mm(rise, degrees)
            assert np.abs(within / within[0] - 1.0).max() < 0.005
    opposite = thickness_mm(0.6, window.centre_deg + 180.0)
    assert opposite.max() > 1.2 * opposite[0]


def test_area_ratios_are_those_of_fine_faces(healthy):
    """On the walls of cavity and heart, away from the rims, where the strain jumps."""
    time_ms = healthy.beat.cycle.end_systole_ms
    for structure, moving in healthy.surfaces(np.array([0.0, time_ms]), 1.5).items():
        before, after = moving.frame(0), moving.frame(1)
        normals, areas = normals_and_areas(before)
        middle = before.triangles_mm.mean(axis=1)
        below = healthy.pose.to_heart(middle)[:, 2] < healthy.profile.base_mm - 2.0
        # Of the cavity's wall, not of the cavity: a facet's middle lies off the surface.
        carried = healthy.carried_areas(middle + 0.05 * normals, normals, time_ms)
        expected = np.linalg.norm(carried, axis=1)
        found = normals_and_areas(after)[1] / areas
        off = np.abs(found / expected - 1.0)[below]
        assert np.percentile(off, 99) < 0.04, structure
        assert np.median(off) < 0.005, structure


def test_the_deformation_of_the_heart_at_rest_is_none(healthy):
    points = healthy.rest.meshes(4.0)[Structure.LV_EPI].vertices_mm
    gradients = healthy.deformation_gradients(points, 0.0)
    np.testing.assert_allclose(gradients, np.tile(np.eye(3), (len(points), 1, 1)), atol=1e-12)


@pytest.mark.parametrize(
    ("wrong", "remedy"),
    [
        ({"ejection_fraction_percent": 90.0}, "between 0 and 75"),
        ({"twist_deg": 99.0}, "between -40 and 40"),
        ({"edv_ml": 1.0}, "between 30 and 400"),
        ({"longitudinal_shortening_percent": 50.0}, "between 0 and 30"),
        ({"rv_ejection_fraction_percent": float("nan")}, "between 0 and 75"),
    ],
)
def test_a_beat_out_of_bounds_is_refused(wrong, remedy):
    (name,) = wrong
    with pytest.raises(InputError, match=f"{name}.*{remedy}"):
        Beat(**wrong)


def test_more_than_the_sound_wall_can_eject_is_refused():
    beat = Beat(ejection_fraction_percent=75.0, infarct=Infarct(half_width_deg=80.0))
    with pytest.raises(InputError, match=r"lower ejection_fraction_percent, or a smaller infarct"):
        BeatingHeart(beat=beat)


def test_the_heart_rate_is_that_asked_for():
    beating = BeatingHeart(beat=Beat(CardiacCycle(80.0)))
    volumes = beating.lv_volumes_ml(np.array([0.0, 750.0, 375.0]))[Structure.LV_ENDO]
    assert volumes[0] == pytest.approx(volumes[1])
    assert volumes[2] < volumes[0]
