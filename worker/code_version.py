"""Which code computes, as one hash: results are promised to be the same only where it is."""

import hashlib
import platform
from pathlib import Path

from worker.provenance import provenance

_PACKAGES = ("intake", "schemas", "worker")
"""Whose files decide about a result."""


def code_version(threads: int) -> str:
    """SHA-256 over this program's files, libraries' versions, the kind of machine and threads."""
    versions = provenance(seed=0, threads=threads, input_sha256="")
    digest = hashlib.sha256(f"{platform.machine()} {versions.model_dump_json()}".encode())
    root = Path(__file__).parents[1]
    for path in sorted(path for name in _PACKAGES for path in (root / name).rglob("*.py")):
        digest.update(f"\n{path.relative_to(root)} ".encode())
        digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()
