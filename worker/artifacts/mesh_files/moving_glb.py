"""Binary glTF 2.0 that plays: all surfaces of a heart over the cycle.

A surface with the same triangles in all frames is one mesh with a morph target a frame, blended
linearly in between. Of any other, every frame is a node of its own, and all but one at a time are
scaled to nothing.
"""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from schemas.vocabulary import Axes
from worker.artifacts.frame_times import FrameTimes
from worker.artifacts.mesh_files.glb import NOTE, node_matrix, unit_normals
from worker.artifacts.mesh_files.gltf_container import (
    ARRAY_BUFFER,
    ELEMENT_ARRAY_BUFFER,
    FLOAT,
    UINT32,
    write_container,
)
from worker.artifacts.mesh_files.gltf_material import material
from worker.artifacts.moving_surface import MovingSurface
from worker.artifacts.page.palette import ENCLOSING

_GLASS = 0.35
"""Opacity of surfaces that hide another."""

_MANTISSA_BITS = 24
"""Of a float32."""


def write_moving_glb(
    path: Path,
    surfaces: Iterable[MovingSurface],
    times: FrameTimes,
    axes: Axes,
    *,
    job_id: str | None = None,
) -> None:
    """One animation, `cycle`, in seconds from the first frame on. At a frame's own time every
    vertex is where it is in the frame, in float32, on a grid of that fineness.
    """
    made = _Document(times)
    for surface in surfaces:
        made.add(surface)
    facts = {"units": "mm", "axes": axes.value, "name": "cycle"}
    extras = facts | ({} if job_id is None else {"job_id": job_id}) | {"note": NOTE}
    write_container(path, made.document(extras, node_matrix(axes)), made.buffers)


class _Document:
    """What is written, as it grows."""

    def __init__(self, times: FrameTimes) -> None:
        self.buffers: list[np.ndarray] = []
        self._times = times
        self._views: list[dict[str, Any]] = []
        self._accessors: list[dict[str, Any]] = []
        self._meshes: list[dict[str, Any]] = []
        self._nodes: list[dict[str, Any]] = []
        self._materials: list[dict[str, Any]] = []
        self._samplers: list[dict[str, Any]] = []
        self._channels: list[dict[str, Any]] = []

    def add(self, surface: MovingSurface) -> None:
        glass = _GLASS if surface.structure in ENCLOSING else 1.0
        self._materials.append(material(surface.structure.value, glass))
        if surface.is_tracked:
            self._add_tracked(surface)
        else:
            self._add_switched(surface)

    def document(self, extras: dict[str, Any], matrix: list[float]) -> dict[str, Any]:
        """A node that is animated may have no matrix, so that they hang from one that has it."""
        times = self._times
        of_time = {
            "frames": dict(zip(times.labels, times.seconds, strict=True)),
            "period_s": times.period_s,
            "times": "of the study" if times.times_ms else "not known; 1 s for the whole",
        }
        heart = {
            "name": "heart",
            "matrix": matrix,
            "children": list(range(len(self._nodes))),
            "extras": extras | of_time,
        }
        return {
            "asset": {"version": "2.0", "generator": "neuralmri", "extras": extras},
            "scene": 0,
            "scenes": [{"nodes": [len(self._nodes)]}],
            "nodes": [*self._nodes, heart],
            "meshes": self._meshes,
            "materials": self._materials,
            "accessors": self._accessors,
            "bufferViews": self._views,
            "buffers": [{"byteLength": sum(part.nbytes for part in self.buffers)}],
            "animations": [
                {"name": "cycle", "samplers": self._samplers, "channels": self._channels}
            ],
        }

    def _add_tracked(self, surface: MovingSurface) -> None:
        positions = _on_a_grid(np.stack([mesh.vertices_mm for mesh in surface.meshes]))
        normals = np.stack([unit_normals(mesh) for mesh in surface.meshes]).astype("<f4")
        targets = [
            {
                "POSITION": self._points(positions[frame] - positions[0], bounded=True),
                "NORMAL": self._points(normals[frame] - normals[0]),
            }
            for frame in range(1, len(positions))
        ]
        primitive = self._primitive(positions[0], normals[0], surface.meshes[0].faces)
        still = [0.0] * len(targets)
        node = self._node(surface.structure.value, primitive | {"targets": targets})
        self._meshes[-1] |= {"weights": still, "extras": {"targetNames": self._names(surface)[1:]}}
        # Which target is at its full weight at each key: none in the first frame.
        weights = np.eye(len(positions))[self._shown(surface), 1:]
        self._channel(node, "weights", "LINEAR", self._keys(surface), weights.ravel())

    def _add_switched(self, surface: MovingSurface) -> None:
        keys, shown = self._keys(surface), self._shown(surface)
        for frame, (label, mesh) in enumerate(
            zip(self._names(surface), surface.meshes, strict=True)
        ):
            positions = mesh.vertices_mm.astype("<f4")
            normals = unit_normals(mesh).astype("<f4")
            primitive = self._primitive(positions, normals, mesh.faces)
            node = self._node(f"{label}_{surface.structure.value}", primitive)
            if frame:
                self._nodes[node]["scale"] = [0.0, 0.0, 0.0]
            scales = np.repeat((shown == frame)[:, None], 3, axis=1)
            self._channel(node, "scale", "STEP", keys, scales)

    def _names(self, surface: MovingSurface) -> list[str]:
        return [self._times.labels[frame] for frame in surface.frames]

    def _keys(self, surface: MovingSurface) -> int:
        """Times of its frames, and the end of the cycle."""
        seconds = [self._times.seconds[frame] for frame in surface.frames]
        keys = np.array([*seconds, self._times.period_s], dtype="<f4")
        bounds = {"min": [float(keys[0])], "max": [float(keys[-1])]}
        return self._accessor(keys, "SCALAR", None, bounds)

    def _shown(self, surface: MovingSurface) -> np.ndarray:
        """Which of its frames is there at every key; at the last the first one again, if that
        comes next.
        """
        count = len(surface.frames)
        return np.array([*range(count), 0 if self._times.is_whole_cycle else count - 1])

    def _primitive(
        self, positions: np.ndarray, normals: np.ndarray, faces: np.ndarray
    ) -> dict[str, Any]:
        return {
            "attributes": {
                "POSITION": self._points(positions, bounded=True),
                "NORMAL": self._points(normals),
            },
            "indices": self._accessor(
                faces.astype("<u4").ravel(), "SCALAR", ELEMENT_ARRAY_BUFFER, {}
            ),
            "material": len(self._materials) - 1,
        }

    def _node(self, name: str, primitive: dict[str, Any]) -> int:
        self._nodes.append({"name": name, "mesh": len(self._meshes)})
        self._meshes.append({"name": name, "primitives": [primitive]})
        return len(self._nodes) - 1

    def _channel(self, node: int, path: str, how: str, keys: int, values: np.ndarray) -> None:
        kind = "SCALAR" if values.ndim == 1 else "VEC3"
        output = self._accessor(values.astype("<f4"), kind, None, {})
        self._channels.append(
            {"sampler": len(self._samplers), "target": {"node": node, "path": path}}
        )
        self._samplers.append({"input": keys, "interpolation": how, "output": output})

    def _points(self, points: np.ndarray, *, bounded: bool = False) -> int:
        low, high = points.min(axis=0).tolist(), points.max(axis=0).tolist()
        bounds = {"min": low, "max": high} if bounded else {}
        return self._accessor(points, "VEC3", ARRAY_BUFFER, bounds)

    def _accessor(
        self, values: np.ndarray, kind: str, target: int | None, bounds: dict[str, Any]
    ) -> int:
        # Everything has four bytes, so that everything begins at a multiple of four.
        view = {
            "buffer": 0,
            "byteOffset": sum(part.nbytes for part in self.buffers),
            "byteLength": values.nbytes,
        }
        self._views.append(view if target is None else view | {"target": target})
        self.buffers.append(values)
        self._accessors.append(
            {
                "bufferView": len(self._views) - 1,
                "componentType": UINT32 if values.dtype.kind == "u" else FLOAT,
                "count": len(values),
                "type": kind,
                **bounds,
            }
        )
        return len(self._accessors) - 1


def _on_a_grid(positions_mm: np.ndarray) -> np.ndarray:
    """Float32 whose differences are float32 too, so that base and target sum to the frame: on a
    grid of a power of two, of which the largest difference is no more than 2**24 steps.
    """
    largest = 2.0 * float(np.abs(positions_mm).max())
    step = 2.0 ** (np.ceil(np.log2(max(largest, 1.0))) - _MANTISSA_BITS)
    return (np.rint(positions_mm / step) * step).astype("<f4")
