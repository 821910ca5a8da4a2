"""What is needed to produce the same result again."""

import hashlib
import platform
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path

from schemas.labels import LabelRequest
from schemas.report import Provenance
from schemas.study import ContourStudy
from schemas.vocabulary import View

_LIBRARIES = ("libigl", "numpy", "scikit-image", "scipy", "torch", "trimesh")


def software() -> str:
    """Name and version of this program."""
    return f"neuralmri {version('neuralmri')}"


def provenance(*, seed: int, threads: int, input_sha256: str) -> Provenance:
    """Versions of everything that computes, beside what the caller chose."""
    return Provenance(
        software=software(),
        python=platform.python_version(),
        libraries={name: version(name) for name in _LIBRARIES},
        seed=seed,
        threads=threads,
        input_sha256=input_sha256,
    )


def study_sha256(study: ContourStudy) -> str:
    """SHA-256 of a contour study, whatever spaces its JSON was written with."""
    return hashlib.sha256(study.model_dump_json().encode()).hexdigest()


def label_maps_sha256(files: Mapping[View, Path], request: LabelRequest) -> str:
    """SHA-256 of label maps as uploaded, and of how they were to be read (options aside)."""
    digest = hashlib.sha256(request.model_dump_json(exclude={"options"}).encode())
    for view in sorted(files):
        digest.update(f"{view}={_file_sha256(files[view])}\n".encode())
    return digest.hexdigest()


def with_references_sha256(input_sha256: str, references: Mapping[str, Path]) -> str:
    """SHA-256 of a study, given its own, and of the reference meshes that came with it, by name."""
    digest = hashlib.sha256(input_sha256.encode())
    for name in sorted(references):
        digest.update(f"\n{name}={_file_sha256(references[name])}".encode())
    return digest.hexdigest()


def _file_sha256(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
