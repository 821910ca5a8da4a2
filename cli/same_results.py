"""Two runs of one request, artifact by artifact: the same, or not."""

import hashlib
import json
import re
from enum import StrEnum
from pathlib import Path

from schemas.base import WireModel
from schemas.report import Provenance

_READABLE = (".stl", ".obj", ".ply")
_TIME_ROW = re.compile(rb"<tr><th>(time|software|libraries)</th>.*?</tr>", re.DOTALL)
_OF_THE_RUN = ("software", "python", "libraries")


class Verdict(StrEnum):
    """How two artifacts of one name compare."""

    SAME = "same"
    """Byte for byte; a report but for its timings and versions."""
    SAME_GEOMETRY = "same geometry"
    """Other bytes, the same vertices and triangles."""
    DIFFERENT = "different"
    MISSING = "missing"
    """Not made again."""
    NEW = "new"
    """Made now, and not before."""

    @property
    def is_same(self) -> bool:
        return self in (Verdict.SAME, Verdict.SAME_GEOMETRY)


class ArtifactComparison(WireModel):
    """One artifact then and now."""

    name: str
    verdict: Verdict
    sha256_then: str | None
    sha256_now: str | None


class VersionDifference(WireModel):
    """One program that is not what it was; null for one that was not there."""

    name: str
    then: str | None
    now: str | None


def compare(name: str, then: Path, now: Path) -> ArtifactComparison:
    """The artifact of that name in two folders; one of them may lack it."""
    before, after = then / name, now / name
    return ArtifactComparison(
        name=name,
        verdict=_verdict(before, after),
        sha256_then=_sha256(before),
        sha256_now=_sha256(after),
    )


def version_differences(then: Provenance, now: Provenance) -> list[VersionDifference]:
    """What computed, where it is not the same."""
    before, after = _versions(then), _versions(now)
    return [
        VersionDifference(name=name, then=before.get(name), now=after.get(name))
        for name in sorted({*before, *after})
        if before.get(name) != after.get(name)
    ]


def _verdict(before: Path, after: Path) -> Verdict:
    if not after.is_file():
        return Verdict.MISSING
    if not before.is_file():
        return Verdict.NEW
    if _essence(before) == _essence(after):
        return Verdict.SAME
    if before.suffix in _READABLE and _is_same_surface(before, after):
        return Verdict.SAME_GEOMETRY
    return Verdict.DIFFERENT


def _essence(path: Path) -> object:
    """What should be the same again: not how long it took, nor with which versions."""
    content = path.read_bytes()
    if path.name == "report.json":
        report = json.loads(content)
        del report["timings_s"]
        for name in _OF_THE_RUN:
            del report["provenance"][name]
        return report
    if path.name == "report.html":
        return _TIME_ROW.sub(b"", content)
    return content


def _is_same_surface(before: Path, after: Path) -> bool:
    import numpy as np

    from worker.mesh_file import read_surface

    one, other = read_surface(before), read_surface(after)
    return np.array_equal(one.vertices_mm, other.vertices_mm) and np.array_equal(
        one.faces, other.faces
    )


def _versions(provenance: Provenance) -> dict[str, str]:
    name, _, version = provenance.software.partition(" ")
    return {name: version, "python": provenance.python, **provenance.libraries}


def _sha256(path: Path) -> str | None:
    if not path.is_file():
        return None
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
