"""What goes into a mesh file, whatever its format."""

from collections.abc import Sequence
from dataclasses import dataclass

from schemas.vocabulary import Axes
from worker.artifacts.mesh_files.vertex_field import VertexField
from worker.surface_mesh import SurfaceMesh


@dataclass(frozen=True, eq=False)
class Content:
    """A surface, mm, its name, the axes of its vertices, the job that made it if one did, and the
    numbers at its vertices.
    """

    mesh: SurfaceMesh
    name: str
    axes: Axes
    job_id: str | None
    fields: Sequence[VertexField]

    def facts(self) -> dict[str, str]:
        """What every format says of its surface, in the order in which it is said."""
        facts = {"units": "mm", "axes": self.axes.value, "name": self.name}
        return facts if self.job_id is None else facts | {"job_id": self.job_id}
