"""Which code computes, as one hash: results are promised to be the same only where it is."""

import hashlib

from worker.fingerprint import code_sha256, processor
from worker.provenance import provenance


def code_version(threads: int) -> str:
    """SHA-256 over this program's files, libraries' versions, the kind of processor and threads."""
    versions = provenance(seed=0, threads=threads, input_sha256="")
    parts = (processor(), versions.model_dump_json(), code_sha256())
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()
