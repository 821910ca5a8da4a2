"""The colour of a tissue, as glTF wants it."""

from typing import Any

import numpy as np

from schemas.vocabulary import Structure

_SRGB = {
    Structure.LV_ENDO: (186, 44, 52),  # a cavity of arterial blood
    Structure.LV_EPI: (196, 132, 118),  # muscle
    Structure.RV_ENDO: (74, 96, 160),  # a cavity of venous blood
    Structure.RV_EPI: (176, 142, 150),  # thin muscle
    Structure.EPI: (214, 172, 140),  # muscle under fat
}
_GREY = (190, 186, 180)
_ROUGHNESS = 0.55


def material(name: str, opacity: float = 1.0) -> dict[str, Any]:
    """Of the structure in which a surface's name ends, grey where it names none."""
    # The longest first: lv_epi ends with epi.
    named = sorted((s for s in _SRGB if name.endswith(s.value)), key=lambda s: -len(s.value))
    srgb = np.array(_SRGB[named[0]] if named else _GREY) / 255.0
    # The format wants linear light.
    linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    found = {
        "name": named[0].value if named else "surface",
        "pbrMetallicRoughness": {
            "baseColorFactor": [*linear.round(4).tolist(), opacity],
            "metallicFactor": 0.0,
            "roughnessFactor": _ROUGHNESS,
        },
        "doubleSided": True,
    }
    return found if opacity == 1.0 else found | {"alphaMode": "BLEND"}
