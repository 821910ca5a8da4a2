"""What a surface is called, wherever it is a file or a part of a form: `ED_lv_endo`."""

import re
from dataclasses import dataclass

from schemas.vocabulary import Structure

_FRAME = re.compile(r"[A-Za-z0-9._-]{1,64}")

# The longest first: `ED_lv_epi` is the lv_epi of ED, not the epi of ED_lv.
_STRUCTURES = sorted(Structure, key=lambda structure: -len(structure.value))


@dataclass(frozen=True)
class SurfaceName:
    """A surface of one frame: the frame's label and the structure."""

    frame: str
    structure: Structure

    def __str__(self) -> str:
        return f"{self.frame}_{self.structure}"


def parse_surface_name(text: str) -> SurfaceName | None:
    """The surface that `text` names as `{frame}_{structure}`; None where it names none."""
    for structure in _STRUCTURES:
        frame = text.removesuffix(f"_{structure}")
        if frame != text:
            return SurfaceName(frame, structure) if _FRAME.fullmatch(frame) else None
    return None
