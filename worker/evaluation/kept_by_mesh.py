"""What was found for a mesh, kept for when it is asked for again."""

from collections.abc import Callable
from typing import Generic, TypeVar
from weakref import WeakKeyDictionary

from worker.surface_mesh import SurfaceMesh

Found = TypeVar("Found")

MOST = 12
"""Meshes that something is kept of: a frame's surfaces, their references, and the one at work. A
tree of 40 000 triangles takes 7 MiB, and a beating heart has 75 surfaces."""


class KeptByMesh(Generic[Found]):
    """Values by mesh: no longer than the mesh is in use, and of the last `MOST` meshes only.

    A mesh is a frozen value, so what was found of it stays right.
    """

    def __init__(self) -> None:
        self._found: WeakKeyDictionary[SurfaceMesh, Found] = WeakKeyDictionary()

    def __len__(self) -> int:
        return len(self._found)

    def of(self, mesh: SurfaceMesh, find: Callable[[SurfaceMesh], Found]) -> Found:
        """What was found of a mesh, or is found now. `find` returns no None."""
        found = self._found.pop(mesh, None)
        if found is None:
            found = find(mesh)
        while len(self._found) >= MOST:
            del self._found[next(iter(self._found))]
        # Last in order: the mesh that was asked for longest ago goes first.
        self._found[mesh] = found
        return found
