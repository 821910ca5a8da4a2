"""What the API description says about a multipart submission."""

from collections.abc import Mapping
from typing import Any

from intake.references import reference_part
from schemas.vocabulary import Structure

_FILE = {"type": "string", "contentMediaType": "application/octet-stream"}
_REFERENCE = f"^{reference_part('[A-Za-z0-9._-]{1,64}')}_({'|'.join(Structure)})$"


def form_content(
    request_model: str, files: Mapping[str, str], *, many: str | None = None
) -> dict[str, Any]:
    """The `multipart/form-data` content of a request body.

    request_model names the schema of the part `request`; files maps other parts to what they are;
    many is what the parts `file` are, of which there may be several.
    """
    return {
        "schema": {
            "type": "object",
            "required": ["request"],
            "additionalProperties": False,
            "properties": {
                "request": {"$ref": f"#/components/schemas/{request_model}"},
                **{name: {**_FILE, "description": what} for name, what in files.items()},
                **(
                    {"file": {"type": "array", "items": _FILE, "description": many}} if many else {}
                ),
            },
            "patternProperties": {
                _REFERENCE: {
                    **_FILE,
                    "description": "Reference mesh of the surface that the part's name ends in, "
                    f"e.g. {reference_part('ED_lv_endo')}: STL, OBJ or PLY, in mm, in the study's "
                    "own axes. The report holds the surface against it.",
                }
            },
        },
        "encoding": {
            "request": {"contentType": "application/json"},
            **{
                name: {"contentType": "application/octet-stream"}
                for name in (*files, *(["file"] if many else []))
            },
        },
    }
