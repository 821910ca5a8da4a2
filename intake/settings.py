"""Settings of what a request may hold, from the environment: NEURALMRI_MAX_POINTS and so on."""

from pydantic import Field
from pydantic_settings import BaseSettings, SettingsConfigDict

from intake.limits import Limits

_GIB = 2**30


class LimitSettings(BaseSettings):
    """Service and workers read these alike: what the one lets in, the other does not refuse."""

    model_config = SettingsConfigDict(env_prefix="NEURALMRI_", frozen=True, extra="ignore")

    max_request_bytes: int = Field(
        default=Limits.max_request_bytes,
        ge=1024,
        le=_GIB,
        description="Bytes of one request's body, all parts together.",
    )
    max_json_values: int = Field(
        default=Limits.max_json_values,
        ge=1000,
        le=100_000_000,
        description="Values of one JSON document; a contour point is four.",
    )
    max_frames: int = Field(
        default=Limits.max_frames, ge=1, le=1000, description="Frames of a study or a label map."
    )
    max_points: int = Field(
        default=Limits.max_points,
        ge=100,
        le=10_000_000,
        description="Contour points of a study, sent or outlined from label maps.",
    )
    max_voxels: int = Field(
        default=Limits.max_voxels,
        ge=1000,
        le=_GIB,
        description="Voxels of one label map, all its frames together.",
    )
    max_inflated_bytes: int = Field(
        default=Limits.max_inflated_bytes,
        ge=1024,
        le=8 * _GIB,
        description="Bytes of one label map after decompression.",
    )
    max_mesh_triangles: int = Field(
        default=Limits.max_mesh_triangles,
        ge=100,
        le=100_000_000,
        description="Triangles of one reference mesh.",
    )

    def limits(self) -> Limits:
        """The bounds as values; those that no operator needs to move are the defaults."""
        return Limits(**{name: getattr(self, name) for name in LimitSettings.model_fields})
