"""Writing a contour study where the caller wants it."""

from pathlib import Path

from schemas.study import ContourStudy


def write_study(path: Path, study: ContourStudy) -> None:
    """The study as compact JSON, what it leaves open left out."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(study.model_dump_json(exclude_none=True) + "\n", encoding="utf-8")
