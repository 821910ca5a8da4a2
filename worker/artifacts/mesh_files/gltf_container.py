"""Binary glTF 2.0 as a container: a document and the bytes that it speaks of."""

import json
import struct
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

FLOAT, UINT32 = 5126, 5125
ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER = 34962, 34963

_JSON_CHUNK, _BINARY_CHUNK = b"JSON", b"BIN\0"


def write_container(path: Path, document: Mapping[str, Any], buffers: Sequence[np.ndarray]) -> None:
    """The document, and the buffers one after the other as its only one."""
    text = json.dumps(document, separators=(",", ":"))
    chunks = _chunk(_JSON_CHUNK, text.encode("ascii"), b" ")
    chunks += _chunk(_BINARY_CHUNK, b"".join(part.tobytes() for part in buffers), b"\0")
    path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)


def _chunk(kind: bytes, data: bytes, padding: bytes) -> bytes:
    """Length, kind and data, which must end on a multiple of four bytes."""
    data += padding * (-len(data) % 4)
    return struct.pack("<I4s", len(data), kind) + data
