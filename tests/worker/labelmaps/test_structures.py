"""Which structures an image shows, lacks, or leaves unknown."""

import numpy as np
import pytest
import shapely

from schemas.vocabulary import Structure
from worker.labelmaps.scheme import Tissue
from worker.labelmaps.structures import ImageStructures, outline_slice

LV_ENDO, LV_EPI, RV_ENDO, RV_EPI = (
    Structure.LV_ENDO,
    Structure.LV_EPI,
    Structure.RV_ENDO,
    Structure.RV_EPI,
)
KNOWN = (LV_ENDO, LV_EPI, RV_ENDO)
PIXEL_MM = np.array([1.5, 1.5])
ROW, COLUMN = np.indices((64, 64))
RADIUS = np.hypot(ROW - 31.5, COLUMN - 31.5)


def image(**where: np.ndarray) -> np.ndarray:
    painted = np.zeros((64, 64), np.uint8)
    for tissue, mask in where.items():
        painted[mask] = Tissue[tissue.upper()]
    return painted


def outlined(painted: np.ndarray, known: tuple[Structure, ...] = KNOWN) -> ImageStructures:
    return outline_slice(painted, known, PIXEL_MM)


def area(ring: np.ndarray) -> float:
    return float(shapely.Polygon(ring).area)


WALL = (RADIUS < 18) & (RADIUS >= 12)
CAVITY = RADIUS < 12
RV = (np.hypot(ROW - 31.5, COLUMN - 50) < 16) & (RADIUS >= 18)


def test_a_middle_slice() -> None:
    found = outlined(image(lv_wall=WALL, lv_cavity=CAVITY, rv_cavity=RV))
    assert set(found.outlines) == set(KNOWN)
    assert (found.absent, found.notes) == ((), ())
    assert area(found.outlines[LV_EPI][0]) == pytest.approx((RADIUS < 18).sum(), rel=0.01)
    assert area(found.outlines[LV_ENDO][0]) == pytest.approx(CAVITY.sum(), rel=0.01)
    assert area(found.outlines[RV_ENDO][0]) == pytest.approx(RV.sum(), rel=0.02)


def test_the_apex_is_a_cap_of_wall() -> None:
    found = outlined(image(lv_wall=RADIUS < 7))
    assert set(found.outlines) == {LV_EPI}
    assert found.absent == (LV_ENDO, RV_ENDO)


def test_an_open_wall_around_its_cavity_is_outlined_with_it() -> None:
    found = outlined(image(lv_wall=WALL & (COLUMN < 34), lv_cavity=CAVITY))
    assert set(found.outlines) == {LV_ENDO, LV_EPI}
    union = (WALL & (COLUMN < 34)) | CAVITY
    assert sum(map(area, found.outlines[LV_EPI])) == pytest.approx(union.sum(), rel=0.02)


def test_a_wall_in_pieces_is_outlined_with_its_cavity() -> None:
    gaps = (np.abs(ROW - COLUMN) < 3) | (np.abs(ROW + COLUMN - 63) < 3)
    found = outlined(image(lv_wall=WALL & ~gaps, lv_cavity=CAVITY))
    assert set(found.outlines) == {LV_ENDO, LV_EPI}


def test_a_gap_between_cavity_and_wall_is_closed() -> None:
    found = outlined(image(lv_wall=WALL, lv_cavity=RADIUS < 10))
    assert len(found.outlines[LV_EPI]) == 1
    assert area(found.outlines[LV_EPI][0]) == pytest.approx((RADIUS < 18).sum(), rel=0.01)


def test_a_cavity_without_wall_does_not_tell_the_epicardium() -> None:
    found = outlined(image(lv_cavity=CAVITY))
    assert set(found.outlines) == {LV_ENDO}
    assert found.absent == (RV_ENDO,)
    assert "without its wall" in found.notes[0]


@pytest.mark.parametrize("wall", [WALL, WALL & (COLUMN < 34)], ids=["ring", "horseshoe"])
def test_a_wall_around_an_unlabelled_cavity_tells_nothing_of_the_lv(wall: np.ndarray) -> None:
    found = outlined(image(lv_wall=wall, rv_cavity=RV))
    assert set(found.outlines) == {RV_ENDO}
    assert found.absent == ()
    assert "no cavity labelled" in found.notes[0]


def test_specks_are_neither_outline_nor_absence() -> None:
    speck = np.zeros((64, 64), bool)
    speck[3, 3:5] = True
    found = outlined(image(lv_wall=WALL, lv_cavity=CAVITY, rv_cavity=speck))
    assert set(found.outlines) == {LV_ENDO, LV_EPI}
    assert found.absent == ()
    assert "rv_endo" in found.notes[0]


def test_an_rv_wall_makes_an_rv_epicardium() -> None:
    outer = (np.hypot(ROW - 31.5, COLUMN - 50) < 19) & (RADIUS >= 18)
    found = outlined(
        image(rv_wall=outer, rv_cavity=RV, lv_wall=WALL, lv_cavity=CAVITY), (*KNOWN, RV_EPI)
    )
    assert area(found.outlines[RV_EPI][0]) == pytest.approx((outer | RV).sum(), rel=0.02)
    assert area(found.outlines[RV_ENDO][0]) == pytest.approx(RV.sum(), rel=0.02)


def test_points_are_a_millimetre_or_a_pixel_apart() -> None:
    for pixel_mm, apart_mm in ((0.5, 1.0), (1.5, 1.5)):
        found = outline_slice(image(lv_cavity=CAVITY), (LV_ENDO,), np.array([pixel_mm] * 2))
        ring_mm = found.outlines[LV_ENDO][0] * pixel_mm
        lengths = np.linalg.norm(np.roll(ring_mm, -1, axis=0) - ring_mm, axis=1)
        assert lengths.mean() == pytest.approx(apart_mm, rel=0.05)
