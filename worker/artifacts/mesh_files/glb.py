"""Binary glTF 2.0: a surface as the web shows it, smoothly shaded, in the colour of its tissue."""

from pathlib import Path
from typing import Any

import numpy as np

from schemas.vocabulary import Axes
from worker.arrays import Points
from worker.artifacts.mesh_files.content import Content
from worker.artifacts.mesh_files.gltf_container import (
    ARRAY_BUFFER,
    ELEMENT_ARRAY_BUFFER,
    FLOAT,
    UINT32,
    write_container,
)
from worker.artifacts.mesh_files.gltf_material import material
from worker.evaluation.surface_normals import vertex_normals
from worker.surface_mesh import SurfaceMesh

_TO_GLTF_M = {
    # x left, y back, z up -> X left, Y up, Z front
    Axes.LPS: np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]]) * 1e-3,
    # x right, y front, z up -> X left, Y up, Z front
    Axes.RAS: np.array([[-1, 0, 0], [0, 0, 1], [0, 1, 0]]) * 1e-3,
}

NOTE = "units and axes of the vertices; the node's matrix makes them metres, head up, facing +Z"


def write_glb(path: Path, content: Content) -> None:
    """Vertices in mm, float32, under a node whose matrix turns them into metres, Y up."""
    positions = content.mesh.vertices_mm.astype("<f4")
    buffers = [
        positions,
        unit_normals(content.mesh).astype("<f4"),
        content.mesh.faces.astype("<u4"),
    ]
    write_container(path, _document(content, positions, buffers), buffers)


def node_matrix(axes: Axes) -> list[float]:
    """From millimetres in the study's axes to the format's metres, column by column."""
    to_gltf = np.eye(4)
    to_gltf[:3, :3] = _TO_GLTF_M[axes]
    return [float(x) for x in to_gltf.T.ravel()]


def unit_normals(mesh: SurfaceMesh) -> Points:
    """Unit normals (n, 3), upright at a vertex without any: the format allows no other length."""
    normals = vertex_normals(mesh)
    normals[~normals.any(axis=1)] = [0.0, 0.0, 1.0]
    return normals


def _document(content: Content, positions: np.ndarray, buffers: list[np.ndarray]) -> dict[str, Any]:
    extras = content.facts() | {"note": NOTE}
    places = np.cumsum([0, *(part.nbytes for part in buffers)]).tolist()
    targets = [ARRAY_BUFFER, ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER]
    points = {"componentType": FLOAT, "count": len(positions), "type": "VEC3"}
    bounds = {"min": positions.min(axis=0).tolist(), "max": positions.max(axis=0).tolist()}
    return {
        "asset": {"version": "2.0", "generator": "neuralmri", "extras": extras},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [
            {
                "name": content.name,
                "mesh": 0,
                "matrix": node_matrix(content.axes),
                "extras": extras,
            }
        ],
        "meshes": [
            {
                "name": content.name,
                "primitives": [
                    {"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2, "material": 0}
                ],
            }
        ],
        "materials": [material(content.name)],
        "accessors": [
            {"bufferView": 0, **points, **bounds},
            {"bufferView": 1, **points},
            {
                "bufferView": 2,
                "componentType": UINT32,
                "count": content.mesh.faces.size,
                "type": "SCALAR",
            },
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": place, "byteLength": part.nbytes, "target": target}
            for place, part, target in zip(places[:-1], buffers, targets, strict=True)
        ],
        "buffers": [{"byteLength": places[-1]}],
    }
