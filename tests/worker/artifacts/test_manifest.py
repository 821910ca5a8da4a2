import hashlib
from datetime import UTC, datetime
from pathlib import Path

from schemas.artifacts import MANIFEST_NAME, Manifest
from schemas.vocabulary import Axes
from worker.artifacts.manifest import describe, write_manifest


def _describe(out_dir: Path) -> Manifest:
    return describe(
        out_dir,
        subject_id="case-01",
        axes=Axes.LPS,
        software="neuralmri 0",
        created_at=datetime(2026, 1, 2, tzinfo=UTC),
    )


def test_lists_every_file_with_size_and_checksum(tmp_path: Path) -> None:
    (tmp_path / "ED_lv_endo.stl").write_bytes(b"mesh")
    (tmp_path / "report.html").write_text("<p>")
    (tmp_path / "report.json").write_text("{}")

    manifest = _describe(tmp_path)

    assert [a.name for a in manifest.artifacts] == ["ED_lv_endo.stl", "report.html", "report.json"]
    mesh = manifest.artifacts[0]
    assert mesh.bytes == 4
    assert mesh.sha256 == hashlib.sha256(b"mesh").hexdigest()
    assert mesh.media_type == "model/stl"


def test_a_written_manifest_reads_back_and_does_not_list_itself(tmp_path: Path) -> None:
    (tmp_path / "report.json").write_text("{}")
    manifest = _describe(tmp_path)
    write_manifest(tmp_path, manifest)
    assert Manifest.model_validate_json((tmp_path / MANIFEST_NAME).read_text()) == manifest
    assert _describe(tmp_path) == manifest
