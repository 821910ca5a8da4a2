"""Voxel sizes that disagree: settled when the file tells, refused when only the caller can."""

import io

import nibabel
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from intake.limits import Limits
from intake.nifti_file import read_nifti_header
from intake.nifti_header import NiftiHeader
from intake.voxel_size import VoxelGeometry, check_voxel_size
from schemas.labels import Spacing
from schemas.problem import InputError, ProblemType
from tests.labelmaps.nifti_bytes import nifti

VOXELS = np.zeros((4, 3, 2), np.uint8)
SIZES = (1.5, 2.0, 8.0)


def header(voxels: np.ndarray = VOXELS, affine: np.ndarray | None = None, **fields) -> NiftiHeader:
    return read_nifti_header(io.BytesIO(nifti(voxels, affine, **fields)), Limits(), "sax")


def settle(head: NiftiHeader, spacing: Spacing = Spacing.AUTO) -> VoxelGeometry:
    return check_voxel_size(head, spacing, "sax")


def scaled(*sizes: float) -> np.ndarray:
    affine = np.diag([-sizes[0], -sizes[1], sizes[2], 1.0])
    affine[:3, 3] = 10.0, -20.0, 30.0
    return affine


def test_agreement_keeps_the_affine() -> None:
    geometry = settle(header(affine=scaled(*SIZES)))
    np.testing.assert_allclose(geometry.affine_mm, scaled(*SIZES))
    assert geometry.spacing_mm == pytest.approx(SIZES)
    assert (geometry.directions_known, geometry.warnings) == (True, ())


@pytest.mark.parametrize("units", [(1, 1000.0), (3, 0.001), (0, 1.0)])
def test_units_reach_scale_and_position(units: tuple[int, float]) -> None:
    geometry = settle(header(affine=scaled(*SIZES), units=units[0]))
    np.testing.assert_allclose(np.array(geometry.affine_mm)[:3], scaled(*SIZES)[:3] * units[1])


def test_unit_scale_takes_pixdim_and_says_so() -> None:
    geometry = settle(header(affine=scaled(1, 1, 1), pixdim=SIZES))
    np.testing.assert_allclose(geometry.affine_mm, scaled(*SIZES))
    assert geometry.warnings[0].startswith("sax: ")
    assert "1.5 x 2 x 8 mm" in geometry.warnings[0]


def test_unit_scale_with_a_qform_takes_the_qform() -> None:
    half = np.sqrt(0.5)
    head = header(
        affine=np.eye(4), pixdim=SIZES, quaternion=[half, 0, 0, 5, 6, 7]
    )  # a quarter turn about x
    geometry = settle(head)
    expected = [[1.5, 0, 0, 5], [0, 0, -8, 6], [0, 2, 0, 7], [0, 0, 0, 1]]
    np.testing.assert_allclose(geometry.affine_mm, expected, atol=1e-6)
    assert "qform" in geometry.warnings[0]


def test_the_caller_settles_any_disagreement_without_a_warning() -> None:
    head = header(affine=scaled(1.2, 1.2, 5.0), pixdim=SIZES)
    with pytest.raises(InputError) as raised:
        settle(head)
    assert raised.value.type is ProblemType.AMBIGUOUS_VOXEL_SIZE
    assert settle(head, Spacing.AFFINE).spacing_mm == pytest.approx((1.2, 1.2, 5.0))
    by_pixdim = settle(head, Spacing.PIXDIM)
    np.testing.assert_allclose(by_pixdim.affine_mm, scaled(*SIZES))
    assert by_pixdim.warnings == ()


@pytest.mark.parametrize(("factor", "agrees"), [(1.009, True), (0.991, True), (1.012, False)])
def test_one_percent_is_the_tolerance(factor: float, agrees: bool) -> None:
    head = header(affine=scaled(*SIZES), pixdim=(1.5 * factor, 2.0, 8.0))
    if agrees:
        assert settle(head).spacing_mm == pytest.approx(SIZES)
    else:
        with pytest.raises(InputError):
            settle(head)


def test_the_thickness_of_a_single_slice_is_nobodys_concern() -> None:
    head = header(VOXELS[:, :, :1], scaled(*SIZES), pixdim=(1.5, 2.0, 0.0))
    assert settle(head).spacing_mm == pytest.approx(SIZES)


@pytest.mark.parametrize("bad", [0.0, -1.5, np.nan, np.inf])
@pytest.mark.parametrize("form", ["sform", "qform"])
def test_pixdim_is_positive_where_it_is_needed(bad: float, form: str) -> None:
    place = {"affine": scaled(*SIZES)} if form == "sform" else {"quaternion": [0.0, 0, 0, 0, 0, 0]}
    head = header(**place, pixdim=(bad, 2.0, 8.0))
    with pytest.raises(InputError) as raised:
        settle(head)
    assert raised.value.type is ProblemType.AMBIGUOUS_VOXEL_SIZE
    if form == "sform":
        assert settle(head, Spacing.AFFINE).spacing_mm == pytest.approx(SIZES)


def test_no_orientation_is_said() -> None:
    head = header(pixdim=SIZES)
    geometry = settle(head)
    assert not geometry.directions_known
    assert geometry.spacing_mm == pytest.approx(SIZES)
    assert "no orientation" in geometry.warnings[0]
    with pytest.raises(InputError) as raised:
        settle(head, Spacing.AFFINE)
    assert raised.value.type is ProblemType.INVALID_AFFINE


def test_a_qform_elsewhere_is_said() -> None:
    head = header(affine=np.diag([*SIZES, 1.0]), quaternion=[0.0, 0, 0, 3, 4, 0])
    geometry = settle(head)
    np.testing.assert_allclose(geometry.affine_mm, np.diag([*SIZES, 1.0]))
    assert "5.0 mm apart" in geometry.warnings[0]
    unsound = settle(header(affine=np.diag([*SIZES, 1.0]), quaternion=[1.0, 1, 1, 0, 0, 0]))
    assert "unsound" in unsound.warnings[0]


@given(
    st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: np.linalg.norm(q) > 0.1),
    st.tuples(*[st.floats(-200, 200)] * 3),
    st.sampled_from([1.0, -1.0]),
)
def test_every_qform_is_nibabels(q: tuple, offset: tuple, qfac: float) -> None:
    _, b, c, d = np.array(q) / np.linalg.norm(q) * np.sign(q[0] or 1.0)
    data = nifti(VOXELS, None, pixdim=SIZES, quaternion=[b, c, d, *offset], qfac=qfac)
    mine = settle(read_nifti_header(io.BytesIO(data), Limits(), "sax"))
    theirs = nibabel.Nifti1Image.from_bytes(data).affine
    np.testing.assert_allclose(mine.affine_mm, theirs, atol=1e-9)


@pytest.mark.parametrize("excess", [-1, 0, 1, 2, 3, 4, 5, 6, 7])
def test_a_qform_near_a_half_turn_is_nibabels(excess: int) -> None:
    """Where the fourth number of the quaternion is lost in the rounding of the other three."""
    d = np.sqrt(1.0 - excess * 2.0**-24)
    data = nifti(VOXELS, None, pixdim=SIZES, quaternion=[0.0, 0.0, d, 0.0, 0.0, 0.0])
    mine = settle(read_nifti_header(io.BytesIO(data), Limits(), "sax"))
    np.testing.assert_allclose(
        mine.affine_mm, nibabel.Nifti1Image.from_bytes(data).affine, atol=1e-9
    )


def test_left_handed_is_fine_and_a_small_shear_is_rounding() -> None:
    affine = scaled(*SIZES) @ np.diag([-1.0, 1.0, 1.0, 1.0])
    assert settle(header(affine=affine)).warnings == ()
    affine[0, 1] = 0.005 * SIZES[1]
    assert settle(header(affine=affine)).warnings == ()


@pytest.mark.parametrize(
    ("affine", "says"),
    [
        (np.diag([0.0, 2.0, 8.0, 1.0]), "no length"),
        (np.array([[2, 2, 0, 0], [0, 0, 0, 0], [0, 0, 8, 0], [0, 0, 0, 1.0]]), "coincide"),
        (np.array([[2, 0.1, 0, 0], [0, 2, 0, 0], [0, 0, 8, 0], [0, 0, 0, 1.0]]), "2.9 degrees"),
        (np.diag([2.0, np.inf, 8.0, 1.0]), "infinity"),
    ],
)
def test_unsound_affines(affine: np.ndarray, says: str) -> None:
    with pytest.raises(InputError, match=says) as raised:
        settle(header(affine=affine, pixdim=(2.0, 2.0, 8.0)))
    assert raised.value.type is ProblemType.INVALID_AFFINE
    assert "Remedy" in raised.value.detail
