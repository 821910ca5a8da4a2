"""How the fit went: losses of every iteration, level by level."""

from collections.abc import Sequence

from schemas.frame_report import LevelReport
from worker.artifacts.page.chart import Chart, laid_out
from worker.artifacts.page.typed_arrays import typed

_NEGLIGIBLE = 1e-3
"""Of the largest total: below, a curve has a gap, for a logarithmic axis would be all tail."""


def loss_chart(levels: Sequence[LevelReport], hinge_weight: float) -> Chart | None:
    """Cross-entropy, weighted hinge and their sum against iterations; every other level shaded.
    None where there were none.
    """
    curves = {
        "total": [x for level in levels for x in level.iterations.total],
        "cross-entropy": [x for level in levels for x in level.iterations.bce],
        "weighted hinge": [hinge_weight * x for level in levels for x in level.iterations.hinge],
    }
    if not curves["total"]:
        return None
    least = _NEGLIGIBLE * max(curves["total"])
    looks = {
        "total": {"color": "#888888", "width": 4},
        "cross-entropy": {"color": "#2c6fb0", "width": 1.5},
        "weighted hinge": {"color": "#c8452f", "width": 1.5},
    }
    data = [
        {
            "type": "scatter",
            "mode": "lines",
            "name": name,
            "x0": 1,
            "dx": 1,
            "y": typed([x if x > least else float("nan") for x in values]),
            "line": looks[name],
            "hovertemplate": "iteration %{x}: %{y:.3g}<extra>" + name + "</extra>",
        }
        for name, values in curves.items()
        if max(values) > least
    ]
    shapes, labels, first = [], [], 0.5
    for index, level in enumerate(levels):
        last = first + len(level.iterations.total)
        if index % 2:
            shapes.append(
                {
                    "type": "rect",
                    "xref": "x",
                    "yref": "paper",
                    "x0": first,
                    "x1": last,
                    "y0": 0,
                    "y1": 1,
                    "line": {"width": 0},
                    "fillcolor": "rgba(128,128,128,0.12)",
                    "layer": "below",
                }
            )
        labels.append(
            {
                "x": (first + last) / 2,
                "y": 1,
                "xref": "x",
                "yref": "paper",
                "yanchor": "top",
                "text": str(level.level),
                "showarrow": False,
                "font": {"size": 10},
            }
        )
        first = last
    figure = laid_out(
        data,
        xaxis={"title": {"text": "iteration (numbers above: level)"}, "range": [0.5, first]},
        yaxis={
            "title": {"text": "loss"},
            "type": "log",
            "exponentformat": "power",
            "automargin": True,
        },
        shapes=shapes,
        annotations=labels,
    )
    note = (
        "Samples close in on the contours from level to level, where inside and outside are harder "
        "to tell, so it need not fall throughout. A sample on a contour is to be half inside: its "
        "cross-entropy is 0.69 nats at best."
    )
    if len(data) < len(curves):
        note += " The weighted hinge stays below a thousandth of the largest loss and is not drawn."
    return Chart("Loss of the fit", note, figure, broad=True)
