"""What `phantom` writes whatever its frames: surfaces, study and request."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from cli.study_file import write_study
from schemas.messages import ContourRequest
from schemas.study import ContourStudy
from schemas.vocabulary import Axes, MeshFormat, Structure

if TYPE_CHECKING:
    from worker.surface_mesh import SurfaceMesh


def write_phantom(
    out: Path,
    frames: Mapping[str, Mapping[Structure, "SurfaceMesh"]],
    study: ContourStudy,
    mesh_format: MeshFormat,
) -> None:
    """The true surfaces of every frame, the study cut from them, and a request body with it."""
    from worker.artifacts.meshes import write_mesh

    out.mkdir(parents=True, exist_ok=True)
    for label, meshes in frames.items():
        for structure, mesh in meshes.items():
            name = f"{label}_{structure.value}"
            write_mesh(out / f"{name}.{mesh_format.value}", mesh, name, Axes.LPS)
    write_study(out / "study.json", study)
    request = ContourRequest(study=study).model_dump_json(exclude_unset=True)
    (out / "request.json").write_text(request + "\n", encoding="utf-8")
