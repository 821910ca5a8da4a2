"""A job's folder becomes a study, and the reference meshes that came with it."""

from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest
import trimesh

from intake.limits import Limits
from jobs.disk_folder import DiskFolder
from jobs.folder import JobFolder
from jobs.store import JobStore
from schemas.job import JobKind
from schemas.labels import LabelRequest, LabelScheme
from schemas.messages import ContourRequest, JobRequest
from schemas.problem import InputError, ProblemType
from schemas.vocabulary import View
from tests.studies.ellipsoid import ELLIPSOIDS, good_request
from worker.evaluation.size import volume_ml
from worker.phantom.analytic_heart import heart
from worker.phantom.label_map import write_label_maps
from worker.provenance import label_maps_sha256, study_sha256
from worker.reading import read_job
from worker.surface_mesh import SurfaceMesh

STAGING = Path("not", "needed")
"""On a disk an input is read where it lies."""
REQUEST = ContourRequest.model_validate(good_request())


def ellipsoid(structure: str, scale: float = 1.0, moved_mm: float = 0.0) -> bytes:
    """PLY of one of the study's own ellipsoids."""
    centre, half_axes = ELLIPSOIDS[structure]
    solid = trimesh.creation.icosphere(subdivisions=3)
    solid.apply_scale(half_axes)
    solid.apply_translation(np.array(centre) + moved_mm)
    solid.apply_scale(scale)
    content: bytes = solid.export(file_type="ply")
    return content


@pytest.fixture
def new_folder(tmp_path: Path) -> DiskFolder:
    return DiskFolder(tmp_path, "1" * 32)


def contour_job(
    folder: DiskFolder, references: dict[str, bytes], request: ContourRequest = REQUEST
) -> DiskFolder:
    folder.create(
        JobRequest(
            job_id=folder.job_id,
            kind=JobKind.CONTOURS,
            created_at=datetime.now(UTC),
            contours=request,
            references={surface: f"reference_{surface}.ply" for surface in references},
        ),
        {f"reference_{surface}.ply": content for surface, content in references.items()},
    )
    return folder


def test_without_references_a_job_is_read_as_ever(new_folder: DiskFolder) -> None:
    reading = read_job(contour_job(new_folder, {}), Limits(), STAGING)
    assert reading.study == REQUEST.study
    assert reading.references == {}
    assert reading.warnings == ()
    assert reading.input_sha256 == study_sha256(REQUEST.study)


def test_warnings_of_the_reading_of_other_files_go_on_into_the_report(
    new_folder: DiskFolder,
) -> None:
    asked = REQUEST.model_copy(update={"warnings": ["Half was guessed."]})
    folder = contour_job(new_folder, {}, asked)
    reading = read_job(folder, Limits(), STAGING)
    assert reading.warnings == ("Half was guessed.",)
    assert reading.input_sha256 == study_sha256(REQUEST.study)


def test_references_are_read_by_surface_in_mm(new_folder: DiskFolder) -> None:
    sent = {"ED_lv_endo": ellipsoid("lv_endo"), "ED_rv_endo": ellipsoid("rv_endo")}
    reading = read_job(contour_job(new_folder, sent), Limits(), STAGING)
    assert list(reading.references) == ["ED_lv_endo", "ED_rv_endo"]
    mesh = reading.references["ED_lv_endo"]
    assert isinstance(mesh, SurfaceMesh)
    whole_ml = 4.0 / 3.0 * np.pi * 20.0 * 20.0 * 40.0 / 1000.0
    assert volume_ml(mesh) == pytest.approx(whole_ml, rel=0.01)
    assert reading.warnings == ()


def test_references_are_in_mm_whatever_the_units_of_the_study(new_folder: DiskFolder) -> None:
    document = good_request()
    document["study"]["units"] = "cm"
    for slice_ in document["study"]["frames"][0]["slices"]:
        slice_["origin"] = [x / 10.0 for x in slice_["origin"]]
        for contour in slice_["contours"]:
            contour["points"] = [[x / 10.0 for x in point] for point in contour["points"]]
    request = ContourRequest.model_validate(document)
    reading = read_job(
        contour_job(new_folder, {"ED_lv_endo": ellipsoid("lv_endo")}, request), Limits(), STAGING
    )
    assert reading.warnings == ()


def test_what_is_read_has_one_digest_with_and_another_without(tmp_path: Path) -> None:
    ball, other = ellipsoid("lv_endo"), ellipsoid("lv_endo", moved_mm=1.0)
    jobs = [{}, {"ED_lv_endo": ball}, {"ED_lv_endo": other}, {"ED_lv_epi": ball}]
    digests = []
    for number, references in enumerate([*jobs, {"ED_lv_endo": ball}]):
        folder = contour_job(DiskFolder(tmp_path, f"{number:032x}"), references)
        digests.append(read_job(folder, Limits(), STAGING).input_sha256)
    assert len(set(digests)) == len(jobs)
    assert digests[-1] == digests[1]


@pytest.mark.parametrize(
    ("surface", "content", "type_", "said"),
    [
        ("ES_lv_endo", ellipsoid("lv_endo"), ProblemType.INVALID_REQUEST, "no frame ES"),
        ("ED_epi", ellipsoid("lv_endo"), ProblemType.INVALID_REQUEST, "too few contours of epi"),
        ("ED_lv_endo", b"a letter", ProblemType.INVALID_REQUEST, "convert it"),
        ("ED_lv_endo", ellipsoid("lv_endo", 0.001), ProblemType.IMPLAUSIBLE_SIZE, "millimetres"),
        ("ED_lv_endo", ellipsoid("lv_endo", 1000), ProblemType.IMPLAUSIBLE_SIZE, "millimetres"),
    ],
)
def test_a_reference_that_cannot_be_used_is_the_callers_fault(
    new_folder: DiskFolder, surface: str, content: bytes, type_: ProblemType, said: str
) -> None:
    with pytest.raises(InputError, match=said) as caught:
        read_job(contour_job(new_folder, {surface: content}), Limits(), STAGING)
    assert caught.value.pointer == f"reference_{surface}"
    assert caught.value.type is type_
    assert "Remedy" in caught.value.detail


def test_a_reference_that_lies_elsewhere_is_doubted(new_folder: DiskFolder) -> None:
    sent = {"ED_lv_endo": ellipsoid("lv_endo", moved_mm=200.0)}
    (warning,) = read_job(contour_job(new_folder, sent), Limits(), STAGING).warnings
    assert "ED_lv_endo" in warning
    assert "axes (LPS)" in warning


def test_more_triangles_than_allowed_are_refused(new_folder: DiskFolder) -> None:
    folder = contour_job(new_folder, {"ED_lv_endo": ellipsoid("lv_endo")})
    with pytest.raises(InputError, match="at most 1000 are accepted"):
        read_job(folder, Limits(max_mesh_triangles=1000), STAGING)


def test_a_study_that_is_not_sound_is_refused_before_its_references(new_folder: DiskFolder) -> None:
    frame = REQUEST.study.frames[0]
    alone = REQUEST.study.model_copy(
        update={"frames": [frame.model_copy(update={"slices": frame.slices[:1]})]}
    )
    request = REQUEST.model_copy(update={"study": alone})
    with pytest.raises(InputError) as caught:
        read_job(contour_job(new_folder, {"ED_lv_endo": b"?"}, request), Limits(), STAGING)
    assert caught.value.type is ProblemType.TOO_FEW_SLICES
    assert caught.value.pointer == "/study/frames/0/slices"


@pytest.fixture(scope="module")
def maps(tmp_path_factory: pytest.TempPathFactory) -> dict[View, Path]:
    return write_label_maps(heart(), tmp_path_factory.mktemp("maps"), LabelScheme.ACDC)


def label_job(folder: JobFolder, maps: dict[View, Path], references: dict[str, bytes]) -> JobFolder:
    names = {view: f"{view}{''.join(path.suffixes)}" for view, path in maps.items()}
    folder.create(
        JobRequest(
            job_id=folder.job_id,
            kind=JobKind.LABELS,
            created_at=datetime.now(UTC),
            labels=LabelRequest(subject_id="a", label_scheme=LabelScheme.ACDC, frame_labels=["ED"]),
            files=names,
            references={surface: f"reference_{surface}.ply" for surface in references},
        ),
        {names[view]: path for view, path in maps.items()}
        | {f"reference_{surface}.ply": content for surface, content in references.items()},
    )
    return folder


def test_label_maps_may_have_references_too(new_folder: DiskFolder, maps: dict[View, Path]) -> None:
    folder = label_job(new_folder, maps, {"ED_lv_endo": ellipsoid("lv_endo")})
    reading = read_job(folder, Limits(), STAGING)
    assert list(reading.references) == ["ED_lv_endo"]
    labels = folder.request().labels
    assert labels is not None
    assert reading.input_sha256 != label_maps_sha256(maps, labels)


def test_what_the_maps_do_not_show_is_found_out_here(
    new_folder: DiskFolder, maps: dict[View, Path]
) -> None:
    with pytest.raises(InputError, match=r"no frame ES.*after a frame of the study \(ED\)"):
        read_job(
            label_job(new_folder, maps, {"ES_lv_endo": ellipsoid("lv_endo")}), Limits(), STAGING
        )


def test_a_job_is_read_alike_from_a_disk_and_from_a_bucket(
    new_folder: DiskFolder, bucket_store: JobStore, maps: dict[View, Path]
) -> None:
    references = {"ED_lv_endo": ellipsoid("lv_endo")}
    from_disk = read_job(label_job(new_folder, maps, references), Limits(), STAGING)
    folder = label_job(bucket_store.folder(bucket_store.new_id()), maps, references)
    staging = folder.staging(1)
    from_bucket = read_job(folder, Limits(), staging)
    assert from_bucket.input_sha256 == from_disk.input_sha256
    assert from_bucket.study == from_disk.study
    assert list(staging.iterdir()) == [], "what was fetched is not among the results"
    folder.drop_staging(staging)
    assert not staging.parent.exists()
