"""The words of the trade that cross a wire: structures, views, units, axes, formats."""

from enum import StrEnum
from typing import Literal

ViewKind = Literal["short_axis", "long_axis", "other"]
"""How a slice lies to the heart."""


class Structure(StrEnum):
    """A closed surface of the ventricles, and the contour it leaves on a slice."""

    LV_ENDO = "lv_endo"
    LV_EPI = "lv_epi"
    RV_ENDO = "rv_endo"
    RV_EPI = "rv_epi"
    EPI = "epi"


class View(StrEnum):
    """How a slice plane was prescribed on the scanner."""

    SAX = "sax"
    LAX_2CH = "lax_2ch"
    LAX_3CH = "lax_3ch"
    LAX_4CH = "lax_4ch"
    OTHER = "other"

    @property
    def is_long_axis(self) -> bool:
        return self.kind == "long_axis"

    @property
    def kind(self) -> ViewKind:
        if self in (View.SAX, View.OTHER):
            return "short_axis" if self is View.SAX else "other"
        return "long_axis"


class Units(StrEnum):
    """Length unit of a request. Everything behind the door is in millimetres."""

    MM = "mm"
    CM = "cm"
    M = "m"
    UM = "um"

    @property
    def millimetres(self) -> float:
        """How many millimetres one of this unit is."""
        return {Units.MM: 1.0, Units.CM: 10.0, Units.M: 1000.0, Units.UM: 0.001}[self]


class Axes(StrEnum):
    """Direction of the patient axes: LPS (DICOM) or RAS (NIfTI)."""

    LPS = "LPS"
    RAS = "RAS"


class MeshFormat(StrEnum):
    """File formats a surface can be written in."""

    STL = "stl"
    OBJ = "obj"
    PLY = "ply"
    VTP = "vtp"
    GLB = "glb"
