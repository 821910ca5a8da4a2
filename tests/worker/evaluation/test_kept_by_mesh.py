import gc

import numpy as np

from worker.evaluation.kept_by_mesh import MOST, KeptByMesh
from worker.surface_mesh import SurfaceMesh


def a_mesh() -> SurfaceMesh:
    return SurfaceMesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64))


def test_it_is_found_once_and_forgotten_with_its_mesh():
    asked: list[SurfaceMesh] = []
    kept: KeptByMesh[object] = KeptByMesh()

    def find(mesh: SurfaceMesh) -> object:
        asked.append(mesh)
        return object()

    mesh = a_mesh()
    assert kept.of(mesh, find) is kept.of(mesh, find)
    assert asked == [mesh]
    asked.clear()
    del mesh
    gc.collect()
    assert len(kept) == 0


def test_of_many_meshes_the_last_ones_asked_for_are_kept():
    asked: list[SurfaceMesh] = []
    kept: KeptByMesh[int] = KeptByMesh()

    def find(mesh: SurfaceMesh) -> int:
        asked.append(mesh)
        return len(asked)

    first, *others = (a_mesh() for _ in range(MOST + 1))
    for mesh in (first, *others[:-1], first, others[-1]):
        kept.of(mesh, find)
    assert len(kept) == MOST
    asked.clear()
    kept.of(first, find)
    assert asked == []
    kept.of(others[0], find)
    assert asked == [others[0]]
