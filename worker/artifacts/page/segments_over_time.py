"""A number for every segment of the left ventricle's wall in every frame, as colours."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from schemas.cycle_report import Series
from worker.artifacts.page.chart import laid_out
from worker.artifacts.page.colour_scales import SIGNED
from worker.evaluation.aha_segments import NAMES


def segments_over_time(
    of: Mapping[int, Series], at: Sequence[float], across: str, what: str, unit: str
) -> dict[str, Any]:
    """A row a segment, the first on top; blue below zero, red above, nothing where it is not
    known.
    """
    numbers = sorted(of)
    values = np.array([of[n] for n in numbers], dtype=float)
    known = np.abs(values[np.isfinite(values)])
    # One segment of few triangles must not pale all others.
    end = max(float(np.percentile(known, 98.0)), 1e-3) if len(known) else 1.0
    shades = [[n / (len(SIGNED) - 1), colour] for n, colour in enumerate(SIGNED)]
    cells = {
        "type": "heatmap",
        "x": list(at),
        "y": numbers,
        "z": [[None if np.isnan(x) else round(float(x), 2) for x in row] for row in values],
        "zmin": -end,
        "zmax": end,
        "colorscale": shades,
        "colorbar": {"thickness": 10, "title": {"text": unit, "side": "top"}},
        "text": [[NAMES.get(n, "")] * len(at) for n in numbers],
        "hoverongaps": False,
        "hovertemplate": f"segment %{{y}} %{{text}}<br>{what} %{{z:.1f}} {unit}<extra></extra>",
    }
    return laid_out(
        [cells],
        xaxis={"title": {"text": across}},
        yaxis={
            "title": {"text": "AHA segment"},
            "autorange": "reversed",
            "tickvals": [1, 4, 7, 10, 13, 16, 17],
            "showgrid": False,
            "zeroline": False,
        },
    )
