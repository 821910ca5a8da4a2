"""What a submission asks for, as one hash: two that agree in it are one request sent twice."""

import hashlib
import json
from collections.abc import Mapping
from typing import Any, BinaryIO

from schemas.job import JobKind, Priority
from service.form_upload import FormUpload


def payload_sha256(
    kind: JobKind, priority: Priority, upload: FormUpload, terms: Mapping[str, str]
) -> str:
    """SHA-256 over address, terms, the JSON's content and the bytes of every file by its part.

    terms: what was asked beside the priority, a batch to join among it.

    The JSON has been found good. Its white space and the order of its keys do not count, nor do
    the form's order, boundary and file names; a default that is spelled out does.
    """
    files = upload.files | {f"reference {name}": f for name, f in upload.references.items()}
    return _digest_of(
        {
            "kind": kind.value,
            "priority": priority.value,
            "request": _digest_of(json.loads(upload.request)),
            "files": {name: _file_sha256(file) for name, file in files.items()},
            **terms,
        }
    )


def batch_sha256(
    priority: Priority, body: bytes, terms: Mapping[str, str], *, in_lines: bool
) -> str:
    """The same of a batch's body, which has been read once; one in lines counts byte for byte."""
    request = hashlib.sha256(body).hexdigest() if in_lines else _digest_of(json.loads(body or "{}"))
    return _digest_of({"kind": "batch", "priority": priority.value, "request": request, **terms})


def _digest_of(content: Any) -> str:
    text = json.dumps(content, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()


def _file_sha256(file: BinaryIO) -> str:
    digest = hashlib.sha256()
    file.seek(0)
    while chunk := file.read(1 << 20):
        digest.update(chunk)
    return digest.hexdigest()
