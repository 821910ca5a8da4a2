"""How every plot looks: one colour and mark a method, legible without colour."""

from dataclasses import dataclass
from typing import Any

from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.ticker import FuncFormatter, NullLocator
from matplotlib.typing import RcKeyType


@dataclass(frozen=True)
class Look:
    """Of one method. Colours are of Okabe and Ito, told apart by all eyes."""

    colour: str
    marker: str
    line: str = "-"
    width: float = 1.3


_BLUE, _SKY, _ORANGE, _GREEN = "#0072B2", "#56B4E9", "#E69F00", "#009E73"
_VERMILION, _PURPLE, _GREY = "#D55E00", "#CC79A7", "#7F7F7F"

LOOKS = {
    "field-fast": Look(_SKY, "v"),
    "field-standard": Look(_BLUE, "o", width=2.4),
    "field-unaligned": Look(_BLUE, "o", ":"),
    "field-paper": Look(_BLUE, "s", "--"),
    "hermite-rbf": Look(_VERMILION, "D", width=2.0),
    "hermite-rbf-refined": Look(_VERMILION, "d", "--"),
    "shape-linear": Look(_GREEN, "^"),
    "shape-cubic": Look(_ORANGE, "<"),
    "lofting": Look(_PURPLE, "s"),
    "morphological": Look(_GREY, "p"),
}

INK = "#222222"

SETTINGS: dict[RcKeyType, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 9.0,
    "axes.titlesize": 9.5,
    "axes.labelsize": 9.0,
    "axes.edgecolor": "#888888",
    "axes.labelcolor": INK,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
    # The same figure is the same file.
    "svg.hashsalt": "neuralmri",
}


def decades(axis: Axis, low: float, high: float) -> None:
    """A logarithmic scale from `low` to `high` with ticks at 1, 2 and 5 times powers of ten."""
    steps = [step * 10.0**power for power in range(-4, 5) for step in (1.0, 2.0, 5.0)]
    axis.set_ticks([step for step in steps if low <= step <= high])
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_locator(NullLocator())


def ruled(axes: Axes) -> None:
    """Faint lines behind the data."""
    axes.grid(visible=True, which="major", color="#E3E3E3", linewidth=0.8)
    axes.set_axisbelow(True)
