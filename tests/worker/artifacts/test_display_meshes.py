import pytest

from schemas.job import Progress, Stage
from schemas.vocabulary import Structure
from tests.worker.artifacts.page.measured_cycle import labels_of, measured_cycle
from worker.artifacts.display_meshes import display_meshes
from worker.artifacts.measured import Measured
from worker.evaluation.topology import is_watertight
from worker.observer import Cancelled


class _Watching:
    def __init__(self, *, stops: bool) -> None:
        self.told: list[Progress] = []
        self._stops = stops

    def advanced(self, progress: Progress) -> None:
        self.told.append(progress)

    def is_cancelled(self) -> bool:
        return self._stops


@pytest.fixture(scope="module")
def measured() -> Measured:
    return measured_cycle(edge_mm=1.5)


def test_every_surface_of_every_frame_is_there_and_none_is_fine(measured: Measured) -> None:
    assert len(measured.frames[0].surfaces[Structure.LV_EPI].mesh.faces) > 7000
    thinned = display_meshes(measured)
    assert list(thinned) == labels_of(4)
    for frame in measured.frames:
        assert thinned[frame.label].keys() == frame.surfaces.keys()
    meshes = [mesh for of_frame in thinned.values() for mesh in of_frame.values()]
    assert all(len(mesh.faces) <= 7000 and is_watertight(mesh) for mesh in meshes)


def test_it_tells_the_frame(measured: Measured) -> None:
    watching = _Watching(stops=False)
    display_meshes(measured, watching)
    assert [(one.stage, one.frame) for one in watching.told] == [
        (Stage.WRITING, label) for label in labels_of(4)
    ]


def test_it_stops_when_asked_to(measured: Measured) -> None:
    with pytest.raises(Cancelled):
        display_meshes(measured, _Watching(stops=True))
