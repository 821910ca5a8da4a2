"""What an importer returns."""

from dataclasses import dataclass

from schemas.study import ContourStudy


@dataclass(frozen=True)
class ImportedStudy:
    """A study as the native format has it, and what its file left open or was not read of it."""

    study: ContourStudy
    warnings: tuple[str, ...]
