"""What a caller may choose, and how much of it: for forms, and for checks before sending."""

from typing import Any

from pydantic import Field

from schemas.base import WireModel
from schemas.labels import LabelScheme, TissueLabels
from schemas.options import Preset
from schemas.vocabulary import Axes, MeshFormat, Structure, Units, View


class Choices(WireModel):
    """Everything that `GET /v1/options` tells."""

    options: dict[str, Any] = Field(description="JSON schema of `options` (draft 2020-12).")
    defaults: dict[str, Any] = Field(description="The options of a request that names none.")
    presets: dict[Preset, dict[str, Any]] = Field(
        description="What each preset sets otherwise than the defaults; what a request names wins."
    )
    label_schemes: dict[LabelScheme, dict[View, TissueLabels]] = Field(
        description="The label values of each published scheme, by view."
    )
    limits: dict[str, int] = Field(
        description="Bounds on a request as this service has them; bytes are bytes, the rest "
        "counts."
    )
    formats: list[MeshFormat]
    structures: list[Structure]
    views: list[View]
    units: list[Units]
    axes: list[Axes]
