"""Label maps of a heart with a formula, read into a study: geometry, evidence, frames."""

import numpy as np
import pytest

from intake.limits import Limits
from schemas.problem import InputError, ProblemType
from schemas.study import ContourStudy, Slice
from schemas.vocabulary import Axes, Structure, Units, View
from tests.labelmaps.heart_maps import (
    LAX_AFFINE,
    LV_SEMI_AXES_MM,
    SAX_AFFINE,
    WALL_MM,
    labels_on,
    lax,
    sax,
)
from tests.worker.labelmaps.conftest import Read

LV_ENDO, LV_EPI, RV_ENDO = Structure.LV_ENDO, Structure.LV_EPI, Structure.RV_ENDO


def slices(study: ContourStudy, frame: int = 0) -> dict[str, Slice]:
    return {s.id: s for s in study.frames[frame].slices}


def points_mm(slice_: Slice, structure: Structure) -> np.ndarray:
    return np.concatenate([c.points for c in slice_.contours if c.structure == structure])


def off_ellipsoid_mm(points: np.ndarray, semi_axes_mm: np.ndarray) -> np.ndarray:
    """Distance to a centred ellipsoid, to first order."""
    level = np.linalg.norm(points / semi_axes_mm, axis=1)
    return np.abs(level * (level - 1) / np.linalg.norm(points / semi_axes_mm**2, axis=1))


def test_contours_lie_on_the_heart(read: Read) -> None:
    study, warnings = read({View.SAX: (sax(), SAX_AFFINE), View.LAX_4CH: (lax(), LAX_AFFINE)})
    assert (study.subject_id, study.units, study.axes) == ("s", Units.MM, Axes.RAS)
    assert warnings == []
    for slice_ in study.frames[0].slices:
        for structure, grown_mm in ((LV_ENDO, 0.0), (LV_EPI, WALL_MM)):
            if structure in slice_.absent:
                continue
            off_mm = off_ellipsoid_mm(points_mm(slice_, structure), LV_SEMI_AXES_MM + grown_mm)
            assert off_mm.mean() < 0.35, slice_.id
            assert off_mm.max() < 1.5, slice_.id


def test_planes_are_explicit_and_exact(read: Read) -> None:
    study, _ = read({View.SAX: (sax(), SAX_AFFINE), View.LAX_4CH: (lax(), LAX_AFFINE)})
    found = slices(study)
    assert found["sax-07"].view is View.SAX
    assert found["sax-07"].origin[2] == pytest.approx(-64.0 + 7 * 8.0)
    assert found["sax-07"].normal == pytest.approx((0.0, 0.0, 1.0))
    assert found["lax_4ch"].view is View.LAX_4CH
    assert np.abs(found["lax_4ch"].normal) == pytest.approx((0.0, 1.0, 0.0))
    for slice_ in found.values():
        points = np.concatenate([c.points for c in slice_.contours])
        off = (points - np.array(slice_.origin)) @ np.array(slice_.normal)
        assert np.abs(off).max() < 1e-3


@pytest.mark.parametrize("flip", [0, 1, 2])
def test_flipped_voxels_with_their_affine_are_the_same_heart(read: Read, flip: int) -> None:
    """A left-handed map is the same study."""
    affine = SAX_AFFINE.copy()
    affine[:3, 3] += affine[:3, flip] * (sax().shape[flip] - 1)
    affine[:3, flip] *= -1
    one, _ = read({View.SAX: (sax(), SAX_AFFINE)})
    other, _ = read({View.SAX: (np.flip(sax(), flip), affine)})
    a, b = (
        sorted(tuple(np.round(np.mean(c.points, axis=0), 1)) for s in f.slices for c in s.contours)
        for f in (one.frames[0], other.frames[0])
    )
    np.testing.assert_allclose(a, b, atol=0.15)


def test_permuted_axes_with_their_affine_are_the_same_heart(read: Read) -> None:
    """Slices counted by the first voxel axis."""
    moved = SAX_AFFINE[:, [2, 0, 1, 3]]
    one, _ = read({View.SAX: (sax(), SAX_AFFINE)})
    other, _ = read({View.SAX: (np.moveaxis(sax(), 2, 0), moved)})
    assert [s.id for s in other.frames[0].slices] == [s.id for s in one.frames[0].slices]
    for a, b in zip(one.frames[0].slices, other.frames[0].slices, strict=True):
        assert a.origin == pytest.approx(b.origin)
        for left, right in zip(a.contours, b.contours, strict=True):
            np.testing.assert_allclose(
                np.mean(left.points, axis=0), np.mean(right.points, axis=0), atol=1e-3
            )


def test_units_of_the_file_become_millimetres(read: Read) -> None:
    affine = SAX_AFFINE.copy()
    affine[:3] /= 1000.0
    metres, _ = read({View.SAX: (sax(), affine)}, header={"units": 1})
    millimetres, _ = read({View.SAX: (sax(), SAX_AFFINE)})
    for a, b in zip(metres.frames[0].slices, millimetres.frames[0].slices, strict=True):
        for left, right in zip(a.contours, b.contours, strict=True):
            np.testing.assert_allclose(left.points, right.points, atol=1e-3)


def test_empty_slices_inside_the_range_are_evidence_and_others_are_not(read: Read) -> None:
    labels = sax()
    labels[:, :, 7] = 0
    found = slices(read({View.SAX: (labels, SAX_AFFINE)})[0])
    assert set(found["sax-07"].absent) == {LV_ENDO, LV_EPI, RV_ENDO}
    assert found["sax-07"].contours == []
    assert found["sax-07"].origin is not None
    assert "sax-00" not in found
    assert "sax-15" not in found


def test_beyond_range_makes_outer_empty_slices_evidence(read: Read) -> None:
    maps = {View.SAX: (sax(), SAX_AFFINE), View.LAX_4CH: (lax(), LAX_AFFINE)}
    found = slices(read(maps, beyond_range=True)[0])
    assert set(found["sax-00"].absent) == {LV_ENDO, LV_EPI, RV_ENDO}
    assert len([name for name in found if name.startswith("sax")]) == sax().shape[2]


def test_a_structure_without_a_pixel_on_a_labelled_slice_is_absent(read: Read) -> None:
    labels = sax()
    found = slices(read({View.SAX: (labels, SAX_AFFINE)})[0])
    lowest = found[min(found)]
    assert set(lowest.absent) == {LV_ENDO, RV_ENDO}
    assert {c.structure for c in lowest.contours} == {LV_EPI}


def test_what_a_map_never_holds_is_unknown(read: Read) -> None:
    labels = np.where(sax() == 3, 0, sax())
    study, _ = read({View.SAX: (labels, SAX_AFFINE)})
    for slice_ in study.frames[0].slices:
        assert RV_ENDO not in slice_.absent
        assert {c.structure for c in slice_.contours} <= {LV_ENDO, LV_EPI}


def test_each_view_speaks_for_itself(read: Read) -> None:
    """A two-chamber map without RV says nothing of it, though the stack has it."""
    labels = np.where(lax() == 3, 0, lax())
    study, _ = read({View.SAX: (sax(), SAX_AFFINE), View.LAX_2CH: (labels, LAX_AFFINE)})
    assert slices(study)["lax_2ch"].absent == []


def test_holes_of_the_cavity_are_kept(read: Read) -> None:
    """A papillary muscle labelled as wall."""
    labels = sax()
    labels[28:33, 25:29, 7] = 2
    study, _ = read({View.SAX: (labels, SAX_AFFINE)})
    endo = [c for c in slices(study)["sax-07"].contours if c.structure is LV_ENDO]
    epi = [c for c in slices(study)["sax-07"].contours if c.structure is LV_EPI]
    assert (len(endo), len(epi)) == (2, 1)


def cine(*kept: int, count: int = 3) -> np.ndarray:
    frames = np.stack([sax()] * count, axis=-1)
    for index in set(range(count)) - set(kept):
        frames[..., index] = 0
    return frames


def test_frames_are_named_and_timed(read: Read) -> None:
    header = {"units": 10, "time_step": 0.04}
    study, _ = read({View.SAX: (cine(0, 1, 2), SAX_AFFINE)}, header=header)
    assert [f.label for f in study.frames] == ["t00", "t01", "t02"]
    assert [f.time_ms for f in study.frames] == pytest.approx([0.0, 40.0, 80.0])
    named, _ = read({View.SAX: (cine(0, 1, 2), SAX_AFFINE)}, frame_labels=["ED", "mid", "ES"])
    assert [f.label for f in named.frames] == ["ED", "mid", "ES"]
    assert [f.time_ms for f in named.frames] == [None] * 3


def test_frames_without_a_label_are_left_out_and_said(read: Read) -> None:
    study, warnings = read({View.SAX: (cine(0, 2), SAX_AFFINE)}, frame_labels=["ED", "x", "ES"])
    assert [f.label for f in study.frames] == ["ED", "ES"]
    assert warnings == ["sax: frames without a label were left out (x)."]


def test_each_frame_has_its_own_labelled_range(read: Read) -> None:
    frames = cine(0, 1, count=2)
    frames[:, :, :6, 1] = 0
    study, _ = read({View.SAX: (frames, SAX_AFFINE)})
    assert "sax-05" in slices(study, 0)
    assert "sax-05" not in slices(study, 1)


def test_several_long_axis_planes_are_numbered(read: Read) -> None:
    affine = LAX_AFFINE.copy()
    labels = labels_on((64, 64, 3), affine)
    study, _ = read({View.SAX: (sax(), SAX_AFFINE), View.LAX_4CH: (labels, affine)})
    assert {"lax_4ch-00", "lax_4ch-01", "lax_4ch-02"} <= set(slices(study))


def test_a_stack_that_ends_inside_the_heart_is_said(read: Read) -> None:
    _, warnings = read({View.SAX: (sax()[:, :, :9], SAX_AFFINE)})
    assert any("LV cavity" in w and "base is likely cut off" in w for w in warnings)
    assert any("sax-08" in w for w in warnings)


def test_a_contour_at_the_border_is_said(read: Read) -> None:
    affine = SAX_AFFINE.copy()
    affine[0, 3] += 20 * SAX_AFFINE[0, 0]
    _, warnings = read({View.SAX: (sax()[20:], affine)})
    assert any("border" in w for w in warnings)


def test_labels_of_the_atria_are_ignored(read: Read) -> None:
    atria = lax()
    atria[10:40, 60:] = 4
    maps = {View.SAX: (sax(), SAX_AFFINE), View.LAX_4CH: (lax(), LAX_AFFINE)}
    without, _ = read(maps, label_scheme="ukbb")
    with_atria, _ = read({**maps, View.LAX_4CH: (atria, LAX_AFFINE)}, label_scheme="ukbb")
    assert with_atria.frames == without.frames


def test_too_many_points_for_one_job(read: Read) -> None:
    with pytest.raises(InputError, match="fewer frames") as raised:
        read({View.SAX: (sax(), SAX_AFFINE)}, limits=Limits(max_points=1000))
    assert (raised.value.type, raised.value.status) == (ProblemType.TOO_LARGE, 413)
