"""What a finished job leaves behind."""

from datetime import datetime

from pydantic import Field

from schemas.base import WireModel
from schemas.vocabulary import Axes

MANIFEST_NAME = "manifest.json"


class Artifact(WireModel):
    """One file of a job's results."""

    name: str = Field(pattern=r"^[A-Za-z0-9._-]{1,160}$")
    media_type: str
    bytes: int = Field(ge=0)
    sha256: str = Field(pattern=r"^[0-9a-f]{64}$")


class Manifest(WireModel):
    """`manifest.json`: every artifact, in millimetres and the study's own axes."""

    subject_id: str
    units: str = "mm"
    axes: Axes
    created_at: datetime
    software: str
    complete: bool = Field(
        default=True,
        description="false where the job was cancelled with its finished frames to be kept, and "
        "others are missing.",
    )
    artifacts: list[Artifact]
