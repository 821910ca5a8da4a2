"""From the wire to arrays: units, planes, outlines."""

import numpy as np
import pytest

from schemas.study import ContourStudy
from schemas.vocabulary import Structure, Units
from worker.reconstruction.stacking import build_stack


def in_units(study: ContourStudy, units: Units) -> ContourStudy:
    """The same study, its numbers in another unit."""
    document = study.model_dump(mode="json")
    document["units"] = units
    scale = 1.0 / units.millimetres
    for slice_ in document["frames"][0]["slices"]:
        slice_["origin"] = [scale * x for x in slice_["origin"]]
        for contour in slice_["contours"]:
            contour["points"] = [[scale * x for x in p] for p in contour["points"]]
    return ContourStudy.model_validate(document)


@pytest.mark.parametrize("units", list(Units))
def test_every_unit_is_millimetres_inside(concentric_spheres, units: Units) -> None:
    study = concentric_spheres()
    expected = build_stack(study, study.frames[0])
    converted = in_units(study, units)
    stack = build_stack(converted, converted.frames[0])
    np.testing.assert_allclose(stack.points_mm, expected.points_mm, atol=1e-9)


def test_points_are_dropped_onto_their_plane(concentric_spheres) -> None:
    study = concentric_spheres()
    document = study.model_dump(mode="json")
    first = next(s for s in document["frames"][0]["slices"] if s["contours"])
    for point in first["contours"][0]["points"][::2]:
        point[2] += 0.3
    crooked = ContourStudy.model_validate(document)
    stack = build_stack(crooked, crooked.frames[0])
    for slice_ in stack.slices:
        for outlines in slice_.outlines.values():
            for outline in outlines:
                off = (outline.points_mm - slice_.origin_mm) @ slice_.normal
                np.testing.assert_allclose(off, 0.0, atol=1e-9)


def test_a_plane_left_out_is_fitted(concentric_spheres) -> None:
    study = concentric_spheres()
    document = study.model_dump(mode="json")
    document["frames"][0]["slices"] = [s for s in document["frames"][0]["slices"] if s["contours"]]
    given = ContourStudy.model_validate(document)
    for slice_ in document["frames"][0]["slices"]:
        del slice_["origin"], slice_["normal"]
    bare = ContourStudy.model_validate(document)
    for a, b in zip(
        build_stack(given, given.frames[0]).slices,
        build_stack(bare, bare.frames[0]).slices,
        strict=True,
    ):
        assert abs(a.normal @ b.normal) == pytest.approx(1.0, abs=1e-9)
        assert (b.origin_mm - a.origin_mm) @ a.normal == pytest.approx(0.0, abs=1e-6)


def test_a_repeated_closing_point_is_dropped(concentric_spheres) -> None:
    study = concentric_spheres()
    document = study.model_dump(mode="json")
    contour = document["frames"][0]["slices"][5]["contours"][0]
    contour["points"].append(contour["points"][0])
    closed_twice = ContourStudy.model_validate(document)
    expected = build_stack(study, study.frames[0]).slices[5].outlines[Structure.LV_ENDO][0]
    found = build_stack(closed_twice, closed_twice.frames[0]).slices[5]
    np.testing.assert_array_equal(
        found.outlines[Structure.LV_ENDO][0].points_mm, expected.points_mm
    )


def test_observed_absent_and_unknown_are_told_apart(concentric_spheres) -> None:
    study = concentric_spheres(endo_mm=20.0, epi_mm=35.0)
    stack = build_stack(study, study.frames[0])
    top = next(s for s in stack.slices if Structure.LV_ENDO in s.absent)
    assert Structure.LV_EPI in top.outlines or Structure.LV_EPI in top.absent
    assert Structure.RV_ENDO not in top.outlines
    assert Structure.RV_ENDO not in top.absent
    assert stack.observed == {Structure.LV_ENDO, Structure.LV_EPI}


def test_an_open_outline_that_meets_itself_keeps_its_last_edge(concentric_spheres) -> None:
    document = concentric_spheres().model_dump(mode="json")
    contour = document["frames"][0]["slices"][4]["contours"][0]
    contour["closed"] = False
    contour["points"].append(contour["points"][0])
    study = ContourStudy.model_validate(document)
    (outline,) = build_stack(study, study.frames[0]).slices[4].outlines[Structure.LV_ENDO]
    np.testing.assert_array_equal(outline.points_mm[0], outline.points_mm[-1])
