"""Headers of several views, against one another and the request."""

import io
from collections.abc import Callable

import numpy as np
import pytest

from intake.label_maps import check_label_maps
from intake.limits import Limits
from schemas.labels import LabelRequest, LabelScheme, TissueLabels
from schemas.problem import InputError, ProblemType
from schemas.vocabulary import View
from tests.labelmaps.heart_maps import LAX_AFFINE, SAX_AFFINE
from tests.labelmaps.nifti_bytes import nifti

VOXELS = np.zeros((4, 3, 2), np.uint8)
CINE = np.zeros((4, 3, 2, 3), np.uint8)


def request(**fields: object) -> LabelRequest:
    return LabelRequest.model_validate({"subject_id": "s", "label_scheme": "acdc", **fields})


def check(files: dict[View, bytes], **fields: object) -> dict:
    streams = {view: io.BytesIO(data) for view, data in files.items()}
    return check_label_maps(streams, request(**fields), Limits())


def test_every_view_is_returned_with_its_geometry() -> None:
    checked = check({View.SAX: nifti(VOXELS, SAX_AFFINE), View.LAX_4CH: nifti(VOXELS, LAX_AFFINE)})
    assert list(checked) == [View.SAX, View.LAX_4CH]
    np.testing.assert_allclose(checked[View.LAX_4CH].geometry.affine_mm, LAX_AFFINE)


def test_no_file() -> None:
    with pytest.raises(InputError, match="one file part a view") as raised:
        check({})
    assert raised.value.type is ProblemType.INVALID_REQUEST


def test_one_stack_without_orientation_is_taken_with_a_warning() -> None:
    checked = check({View.SAX: nifti(VOXELS, None, pixdim=(1.5, 1.5, 8.0))})
    assert checked[View.SAX].geometry.warnings


@pytest.mark.parametrize("views", [(View.LAX_4CH,), (View.SAX, View.LAX_2CH)])
def test_other_views_need_orientation(views: tuple[View, ...]) -> None:
    with pytest.raises(InputError) as raised:
        check(dict.fromkeys(views, nifti(VOXELS, None, pixdim=(1.5, 1.5, 8.0))))
    assert (raised.value.type, raised.value.pointer) == (ProblemType.INVALID_AFFINE, views[0])


def test_views_share_their_frames() -> None:
    cine = {view: nifti(CINE, SAX_AFFINE) for view in (View.SAX, View.LAX_2CH)}
    assert check(cine)[View.SAX].header.frames == 3
    with pytest.raises(InputError) as raised:
        check({**cine, View.LAX_3CH: nifti(VOXELS, LAX_AFFINE)})
    assert (raised.value.type, raised.value.pointer) == (ProblemType.MISMATCHED_VIEWS, "lax_3ch")


@pytest.mark.parametrize(("count", "fits"), [(2, False), (3, True), (4, False)])
def test_frame_labels_are_as_many_as_frames(count: int, fits: bool) -> None:
    labels = [f"f{i}" for i in range(count)]
    if fits:
        assert check({View.SAX: nifti(CINE, SAX_AFFINE)}, frame_labels=labels)
    else:
        with pytest.raises(InputError) as raised:
            check({View.SAX: nifti(CINE, SAX_AFFINE)}, frame_labels=labels)
        assert raised.value.pointer == "/frame_labels"


@pytest.mark.parametrize("side", ["lv", "rv"])
def test_a_wall_needs_its_cavity(side: str) -> None:
    def scheme(**lists: list[int]) -> Callable[[], dict]:
        return lambda: check(
            {View.SAX: nifti(VOXELS, SAX_AFFINE)}, label_scheme=TissueLabels(**lists)
        )

    assert scheme(**{f"{side}_wall": [2], f"{side}_cavity": [1]})()
    with pytest.raises(InputError) as raised:
        scheme(**{f"{side}_wall": [2]})()
    assert raised.value.pointer == f"/label_scheme/{side}_cavity"


def test_every_published_scheme_is_one() -> None:
    for scheme in LabelScheme:
        assert check({View.SAX: nifti(VOXELS, SAX_AFFINE)}, label_scheme=scheme)
