"""One colour for each structure, the same in every figure."""

from collections.abc import Mapping

from schemas.vocabulary import Structure

STRUCTURE_COLOURS: Mapping[Structure, str] = {
    Structure.LV_ENDO: "#c8452f",
    Structure.LV_EPI: "#d99a1c",
    Structure.RV_ENDO: "#2c6fb0",
    Structure.RV_EPI: "#4fb0d6",
    Structure.EPI: "#9a6fb0",
}
"""Told apart by the colour-blind as well: after Okabe and Ito, darkened for white paper."""

CONTOUR_COLOURS: Mapping[Structure, str] = {
    Structure.LV_ENDO: "#6e1f12",
    Structure.LV_EPI: "#6f4b00",
    Structure.RV_ENDO: "#0f3157",
    Structure.RV_EPI: "#145069",
    Structure.EPI: "#4a2d5a",
}
"""Of lines that lie on a surface of the colour above."""

GREY = "#8c8c8c"
"""Of references, and of what was not measured."""

ENCLOSING = frozenset({Structure.LV_EPI, Structure.RV_EPI, Structure.EPI})
"""Surfaces that hide another, so that they are drawn as glass."""
