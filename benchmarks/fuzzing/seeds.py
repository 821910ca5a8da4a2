"""Requests that are good: what fuzzing starts from."""

import gzip
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

from schemas.labels import LabelScheme
from service.examples import CONTOUR_REQUEST
from worker.phantom.analytic_heart import heart
from worker.phantom.label_map import write_label_maps
from worker.phantom.standard_study import standard_study

QUICK = {
    "preset": "fast",
    "levels": 1,
    "iterations_per_level": 5,
    "mesh": {"grid_mm": 4.0},
    "formats": ["stl"],
}
"""Options of a fit that takes a second, and finds a surface of sorts."""

LABEL_REQUEST: dict[str, Any] = {
    "subject_id": "fuzzed",
    "label_scheme": "mnms",
    "options": QUICK,
}

_PIXEL_MM = 3.0

_POINTS = 20
"""Of a contour, some: small documents are spoilt, sent and shrunk faster."""


@cache
def contour_requests() -> tuple[dict[str, Any], ...]:
    """Submissions of contours: the six circles of the API description, and the phantom heart."""
    phantom = standard_study(edge_mm=5.0).model_dump(mode="json", exclude_none=True)
    for slice_ in phantom["frames"][0]["slices"]:
        for contour in slice_["contours"]:
            contour["points"] = contour["points"][:: max(1, len(contour["points"]) // _POINTS)]
    return (
        {"study": CONTOUR_REQUEST["study"], "options": QUICK},
        {"study": phantom, "options": QUICK},
    )


@cache
def label_maps() -> dict[str, bytes]:
    """A small heart by view, each an uncompressed NIfTI file; `mnms` is its scheme."""
    with tempfile.TemporaryDirectory() as folder:
        written = write_label_maps(
            heart(0.0), Path(folder), LabelScheme.MNMS, pixel_mm=_PIXEL_MM, spacing_mm=10.0
        )
        return {view.value: gzip.decompress(path.read_bytes()) for view, path in written.items()}


def label_map(view: str) -> bytes:
    """One of them, compressed."""
    return gzip.compress(label_maps()[view], mtime=0)
