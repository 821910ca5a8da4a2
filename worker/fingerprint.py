"""What decides a result to the last bit, in one hash: a state of one fit is none of another's."""

import hashlib
import platform
from functools import cache
from pathlib import Path

from schemas.options import Options
from schemas.report import Provenance

_CODE = ("worker", "intake", "schemas")
"""What the science is made of. A release number would not tell two checkouts apart."""

_CPU_INFO = Path("/proc/cpuinfo")


def fingerprint(options: Options, made_by: Provenance) -> str:
    """Of options, input, seed, threads, versions, code, and the kind of processor."""
    parts = (options.model_dump_json(), made_by.model_dump_json(), code_sha256(), processor())
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()


@cache
def code_sha256() -> str:
    """SHA-256 of the program's own source, as it lies beside this file."""
    root = Path(__file__).parent.parent
    digest = hashlib.sha256()
    for path in sorted(path for room in _CODE for path in (root / room).rglob("*.py")):
        digest.update(f"{path.relative_to(root)}\n".encode())
        digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()


@cache
def processor() -> str:
    """The kind of processor: on another, sums may round otherwise."""
    described = _CPU_INFO.read_text(encoding="utf-8") if _CPU_INFO.is_file() else ""
    told = {
        line
        for line in described.splitlines()
        if line.startswith(("model name", "flags", "Features"))
    }
    return "\n".join([platform.machine(), platform.processor(), *sorted(told)])
