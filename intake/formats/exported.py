"""What writing a study in a foreign format gives."""

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Exported:
    """Files by name, and what of the study they do not hold."""

    files: Mapping[str, bytes]
    warnings: tuple[str, ...]
