"""Real label maps, where they are at hand: every trap that they hold is handled or told.

The files are not part of the project (licences differ); see docs/label-maps.md for their sources.
"""

from pathlib import Path

import igl
import nibabel
import numpy as np
import pytest
import trimesh

from intake.limits import Limits
from intake.study import admit
from schemas.labels import LabelRequest
from schemas.options import Options
from schemas.problem import InputError, ProblemType
from schemas.study import ContourStudy, Slice
from schemas.vocabulary import Structure, View
from worker.labelmaps.reading import read_label_maps

MAPS = Path(__file__).parents[4] / "shared" / "data" / "nifti"
pytestmark = pytest.mark.skipif(not MAPS.is_dir(), reason="no real label maps beside the checkout")

ACDC = ("patient101_frame01_gt", "patient101_frame14_gt")
MNMS = tuple(
    f"{name}_sa_{frame}_gt" for name in ("B9G4U2", "G8R0Z9", "H1N8S6") for frame in ("ED", "ES")
)


def read(scheme: str, **names: str) -> tuple[ContourStudy, list[str]]:
    files = {View(view): MAPS / f"{name}.nii.gz" for view, name in names.items()}
    return read_label_maps(files, LabelRequest(subject_id="s", label_scheme=scheme), Limits())


def area_mm2(slice_: Slice, structure: Structure) -> float:
    """Of all outlines of a structure, holes taken off by their sense."""
    total = np.zeros(3)
    for contour in slice_.contours:
        if contour.structure is structure:
            points = np.array(contour.points) - slice_.origin
            total += np.cross(points, np.roll(points, -1, axis=0)).sum(axis=0) / 2
    return abs(float(total @ slice_.normal))


def volume_ml(study: ContourStudy, structure: Structure) -> float:
    """Areas times spacing."""
    stack = [s for s in study.frames[0].slices if s.view is View.SAX]
    step_mm = abs(np.subtract(stack[1].origin, stack[0].origin) @ np.array(stack[0].normal))
    return float(sum(area_mm2(s, structure) for s in stack) * step_mm / 1000)


def voxel_volume_ml(path: Path, *labels: int) -> float:
    """Voxels of these labels times the voxel size in pixdim, by nibabel alone."""
    image = nibabel.load(path)
    count = np.isin(np.asarray(image.dataobj), labels).sum()
    return float(count * np.prod(image.header.get_zooms()[:3]) / 1000)


def test_acdc_is_scaled_by_pixdim_and_says_so() -> None:
    study, warnings = read("acdc", sax=f"acdc/{ACDC[0]}")
    counted_ml = voxel_volume_ml(MAPS / f"acdc/{ACDC[0]}.nii.gz", 3)
    assert counted_ml == pytest.approx(222.6, abs=0.1)
    assert volume_ml(study, Structure.LV_ENDO) == pytest.approx(counted_ml, rel=0.01)
    assert any("1 x 1 x 1 mm" in w and "1.641 x 1.641 x 10 mm" in w for w in warnings)
    assert any("base is likely cut off" in w for w in warnings)


def test_acdc_contracts() -> None:
    diastole, systole = (
        volume_ml(read("acdc", sax=f"acdc/{name}")[0], Structure.LV_ENDO) for name in ACDC
    )
    assert 0.2 < (diastole - systole) / diastole < 0.45


@pytest.mark.parametrize("name", MNMS)
def test_mnms_outlines_enclose_what_the_voxels_fill(name: str) -> None:
    study, warnings = read("mnms", sax=f"mnms/{name}")
    path = MAPS / "mnms" / f"{name}.nii.gz"
    for structure, labels in (
        (Structure.LV_ENDO, (1,)),
        (Structure.LV_EPI, (1, 2)),
        (Structure.RV_ENDO, (3,)),
    ):
        found_ml, counted_ml = volume_ml(study, structure), voxel_volume_ml(path, *labels)
        assert found_ml == pytest.approx(counted_ml, rel=0.01)
    assert warnings == []


@pytest.mark.parametrize(
    ("right", "wrong", "name"),
    [("acdc", "mnms", f"acdc/{ACDC[0]}"), ("mnms", "acdc", "mnms/H1N8S6_sa_ED_gt")],
)
def test_the_other_scheme_is_refused_and_the_right_one_named(
    right: str, wrong: str, name: str
) -> None:
    with pytest.raises(InputError, match=f"`{right}`") as raised:
        read(wrong, sax=name)
    assert raised.value.type is ProblemType.WRONG_LABEL_SCHEME


def whole_heart(gap: int) -> ContourStudy:
    study, _ = read(
        "mmwhs_7",
        sax=f"mmwhs/SA_gap{gap}",
        lax_2ch="mmwhs/LA_2CH",
        lax_3ch="mmwhs/LA_3CH",
        lax_4ch="mmwhs/LA_4CH",
    )
    return study


@pytest.mark.parametrize("gap", [8, 10])
@pytest.mark.parametrize("structure", ["LV_endo", "LV_epi", "RV_endo"])
def test_mmwhs_contours_lie_on_the_true_surfaces(gap: int, structure: str) -> None:
    """Within a fraction of the 1.5 mm pixel, in every view."""
    truth = trimesh.load(MAPS / "mmwhs" / f"gt_{structure}.ply", process=False)
    study = whole_heart(gap)
    for view in (View.SAX, View.LAX_2CH, View.LAX_3CH, View.LAX_4CH):
        points_mm = np.concatenate(
            [
                contour.points
                for slice_ in study.frames[0].slices
                for contour in slice_.contours
                if slice_.view is view and contour.structure == structure.lower()
            ]
        )
        squared = igl.point_mesh_squared_distance(
            points_mm, np.asarray(truth.vertices), np.asarray(truth.faces, dtype=np.int64)
        )[0]
        assert np.sqrt(squared).mean() < 0.3


@pytest.mark.parametrize("gap", [8, 10])
def test_mmwhs_is_admitted(gap: int) -> None:
    assert admit(whole_heart(gap), Options()) == []


@pytest.mark.parametrize(
    ("scheme", "name"),
    [("acdc", f"acdc/{name}") for name in ACDC] + [("mnms", f"mnms/{name}") for name in MNMS],
)
def test_every_stack_is_admitted(scheme: str, name: str) -> None:
    assert admit(read(scheme, sax=name)[0], Options()) == []
