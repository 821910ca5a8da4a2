import json
from pathlib import Path

from schemas.labels import LabelRequest, LabelScheme
from schemas.options import Options
from schemas.study import ContourStudy
from schemas.vocabulary import View
from worker.provenance import (
    label_maps_sha256,
    provenance,
    study_sha256,
    with_references_sha256,
)

STUDY = {
    "subject_id": "case-01",
    "units": "mm",
    "axes": "LPS",
    "frames": [
        {
            "label": "ED",
            "slices": [
                {
                    "id": "sax-00",
                    "contours": [
                        {"structure": "lv_endo", "points": [[0, 0, 0], [1, 0, 0], [0, 1, 0]]}
                    ],
                }
            ],
        }
    ],
}


def digest(document: object, indent: int | None = None) -> str:
    text = json.dumps(document, indent=indent)
    return study_sha256(ContourStudy.model_validate_json(text))


def test_a_study_has_one_digest_however_it_is_written() -> None:
    assert digest(STUDY) == digest(STUDY, indent=4)
    assert digest(STUDY) != digest({**STUDY, "axes": "RAS"})


def test_label_maps_are_known_by_their_bytes_their_views_and_how_they_are_read(
    tmp_path: Path,
) -> None:
    one, other = tmp_path / "one.nii", tmp_path / "other.nii"
    one.write_bytes(b"one")
    other.write_bytes(b"other")
    acdc = LabelRequest(subject_id="a", label_scheme=LabelScheme.ACDC)
    mnms = LabelRequest(subject_id="a", label_scheme=LabelScheme.MNMS)
    digests = [
        label_maps_sha256({View.SAX: one}, acdc),
        label_maps_sha256({View.SAX: other}, acdc),
        label_maps_sha256({View.LAX_4CH: one}, acdc),
        label_maps_sha256({View.SAX: one}, mnms),
    ]
    assert len(set(digests)) == len(digests)
    with_options = acdc.model_copy(update={"options": Options(seed=7)})
    assert label_maps_sha256({View.SAX: one}, with_options) == digests[0]


def test_references_are_known_by_their_bytes_and_their_surfaces(tmp_path: Path) -> None:
    one, other = tmp_path / "one.ply", tmp_path / "other.ply"
    one.write_bytes(b"one")
    other.write_bytes(b"other")
    digests = [
        with_references_sha256("a", {"ED_epi": one}),
        with_references_sha256("b", {"ED_epi": one}),
        with_references_sha256("a", {"ED_epi": other}),
        with_references_sha256("a", {"ES_epi": one}),
        with_references_sha256("a", {"ED_epi": one, "ES_epi": other}),
    ]
    assert len(set(digests)) == len(digests)
    assert with_references_sha256("a", {"ES_epi": other, "ED_epi": one}) == digests[-1]


def test_every_library_that_computes_is_named_with_its_version() -> None:
    made = provenance(seed=3, threads=2, input_sha256="0" * 64)
    assert {"torch", "numpy", "libigl"} <= set(made.libraries)
    assert all(made.libraries.values())
    assert made.software.startswith("neuralmri ")
    assert (made.seed, made.threads) == (3, 2)
