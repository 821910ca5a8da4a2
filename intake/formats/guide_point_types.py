"""What the contour types of guide-point files mean."""

from dataclasses import dataclass

from schemas.vocabulary import Structure


@dataclass(frozen=True)
class Pieces:
    """Of which contour types, without their view, an outline is put together.

    wall: its own pieces. septum: whether the septum's right side completes it where `wall` leaves
    it open: upstream a border that two structures share is written once.
    """

    wall: tuple[str, ...]
    septum: bool


SEPTUM = "RV_SEPTUM"

PIECES = {
    Structure.LV_ENDO: Pieces(("LV_ENDOCARDIAL",), septum=False),
    Structure.LV_EPI: Pieces(("LV_EPICARDIAL",), septum=True),
    Structure.RV_ENDO: Pieces(("RV_FREEWALL", "RV_ENDOCARDIAL"), septum=True),
    Structure.RV_EPI: Pieces(("RV_EPICARDIAL",), septum=True),
}

VALVES = ("MITRAL_VALVE", "TRICUSPID_VALVE", "AORTA_VALVE", "PULMONARY_VALVE")

MARKERS = (*VALVES, "RV_INSERT", "APEX_POINT", "APEX_ENDO_POINT", "APEX_EPI_POINT")
"""Points that are no part of an outline."""

OPENINGS = {
    Structure.LV_ENDO: ("MITRAL_VALVE",),
    Structure.LV_EPI: ("MITRAL_VALVE",),
    Structure.RV_ENDO: ("TRICUSPID_VALVE", "PULMONARY_VALVE"),
    Structure.RV_EPI: ("TRICUSPID_VALVE", "PULMONARY_VALVE"),
}
"""Valves at which a long-axis outline is open."""


def view_and_kind(contour_type: str) -> tuple[str | None, str]:
    """`SAX_LV_ENDOCARDIAL` as ("SAX", "LV_ENDOCARDIAL"); a marker has no view."""
    view, _, kind = contour_type.partition("_")
    return (view, kind) if view in ("SAX", "LAX") else (None, contour_type)
