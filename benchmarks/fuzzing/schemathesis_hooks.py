"""Loaded by Schemathesis: puts into generated requests what no schema can say.

What is meant to be refused is left as it was generated.
"""

from typing import Any

import schemathesis
from hypothesis import strategies as st

from benchmarks.fuzzing.seeds import label_map, label_maps

_RECEIVER = "https://127.0.0.1/"
"""A permitted target in these runs; who listens there does not matter."""

schemathesis.openapi.media_type(
    "application/octet-stream", st.sampled_from([label_map(view) for view in label_maps()])
)


@schemathesis.hook
def before_call(context: Any, case: Any, kwargs: Any) -> None:
    """Webhooks name a host that is there."""
    is_good = case.meta is not None and case.meta.generation.mode.is_positive
    if case.path == "/v1/webhooks" and is_good and isinstance(case.body, dict):
        case.body = {**case.body, "url": _RECEIVER}
