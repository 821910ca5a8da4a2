"""What reading foreign contour files gives."""

from dataclasses import dataclass

from schemas.study import ContourStudy


@dataclass(frozen=True)
class ImportedStudy:
    """A contour study, and what had to be guessed, mended or left out on the way."""

    study: ContourStudy
    warnings: tuple[str, ...]
