"""Files and folders of contour studies, read as one batch."""

import json
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from schemas.base import FOLDER_NAME_PATTERN
from schemas.problem import InputError, ProblemType


def read_batch_files(paths: Sequence[Path], options_file: Path | None) -> dict[str, Any]:
    """The body of a batch: each file a study, or a whole request; of a folder its `*.json`.

    A study is called as its file. Whether it can be used the server says, study by study. Raises
    InputError for a file that is not a JSON object, and where there is none.
    """
    files = [file for path in paths for file in _files_in(path)]
    if not files:
        raise InputError(
            ProblemType.INVALID_REQUEST, "there is no *.json in the folders given; name the files"
        )
    body: dict[str, Any] = {"studies": [_entry(file) for file in files]}
    if options_file is not None:
        body["options"] = _object_in(options_file)
    return body


def _files_in(path: Path) -> list[Path]:
    return sorted(path.glob("*.json")) if path.is_dir() else [path]


def _entry(file: Path) -> dict[str, Any]:
    document = _object_in(file)
    entry = document if "study" in document else {"study": document}
    if re.fullmatch(FOLDER_NAME_PATTERN, file.stem):
        return {"name": file.stem, **entry}
    return entry


def _object_in(file: Path) -> dict[str, Any]:
    try:
        document = json.loads(file.read_bytes())
    except ValueError as error:
        raise InputError(
            ProblemType.MALFORMED_JSON, f"{file} is not JSON ({error}); correct it or leave it out"
        ) from error
    if not isinstance(document, dict):
        raise InputError(ProblemType.INVALID_REQUEST, f"{file} is no JSON object, so no study")
    return document
