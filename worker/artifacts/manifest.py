"""The manifest: every artifact of a folder, with sizes and checksums."""

import hashlib
from datetime import datetime
from pathlib import Path

from schemas.artifacts import MANIFEST_NAME, Artifact, Manifest
from schemas.media_types import ARTIFACT_MEDIA_TYPES
from schemas.vocabulary import Axes


def describe(
    out_dir: Path,
    *,
    subject_id: str,
    axes: Axes,
    software: str,
    created_at: datetime,
    complete: bool = True,
) -> Manifest:
    """The manifest of a folder: every file in it but a manifest.

    Args:
        out_dir: Holds the finished artifacts and nothing else.
        subject_id: Whose they are.
        axes: The axes of every mesh; the unit is always mm.
        software: Name and version of what wrote them.
        created_at: When they were made, timezone-aware.
        complete: Whether no frame is missing because the job was cancelled.
    """
    names = sorted(p.name for p in out_dir.iterdir() if p.name != MANIFEST_NAME)
    return Manifest(
        subject_id=subject_id,
        axes=axes,
        created_at=created_at,
        software=software,
        complete=complete,
        artifacts=[_described(out_dir / name) for name in names],
    )


def write_manifest(out_dir: Path, manifest: Manifest) -> None:
    """Write `manifest.json` beside what it describes."""
    text = manifest.model_dump_json(indent=1)
    (out_dir / MANIFEST_NAME).write_text(text, encoding="utf-8")


def _described(path: Path) -> Artifact:
    with path.open("rb") as file:
        sha256 = hashlib.file_digest(file, "sha256").hexdigest()
    return Artifact(
        name=path.name,
        media_type=ARTIFACT_MEDIA_TYPES[path.suffix],
        bytes=path.stat().st_size,
        sha256=sha256,
    )
