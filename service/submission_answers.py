"""What the API description says about the 202 answer to a submission."""

from typing import Any

ACCEPTED: dict[int | str, dict[str, Any]] = {
    202: {
        "description": "Accepted: the job is stored and will be done, whatever happens to us.",
        "headers": {
            "Location": {"description": "The job.", "schema": {"type": "string"}},
            "Retry-After": {
                "description": "Seconds to wait before the first poll: until the job is expected "
                "to start, at most an hour.",
                "schema": {"type": "integer", "minimum": 1, "maximum": 3600},
            },
        },
    }
}
