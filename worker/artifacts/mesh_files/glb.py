"""Binary glTF 2.0: a surface as the web shows it, smoothly shaded, in the colour of its tissue."""

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np

from schemas.vocabulary import Axes, Structure
from worker.arrays import Points
from worker.artifacts.mesh_files.content import Content
from worker.evaluation.surface_normals import vertex_normals
from worker.surface_mesh import SurfaceMesh

_TO_GLTF_M = {
    # x left, y back, z up -> X left, Y up, Z front
    Axes.LPS: np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]]) * 1e-3,
    # x right, y front, z up -> X left, Y up, Z front
    Axes.RAS: np.array([[-1, 0, 0], [0, 0, 1], [0, 1, 0]]) * 1e-3,
}

_SRGB = {
    Structure.LV_ENDO: (186, 44, 52),  # a cavity of arterial blood
    Structure.LV_EPI: (196, 132, 118),  # muscle
    Structure.RV_ENDO: (74, 96, 160),  # a cavity of venous blood
    Structure.RV_EPI: (176, 142, 150),  # thin muscle
    Structure.EPI: (214, 172, 140),  # muscle under fat
}
_GREY = (190, 186, 180)
_ROUGHNESS = 0.55

_NOTE = "units and axes of the vertices; the node's matrix makes them metres, head up, facing +Z"

_FLOAT, _UINT32 = 5126, 5125
_ARRAY_BUFFER, _ELEMENT_ARRAY_BUFFER = 34962, 34963
_JSON_CHUNK, _BINARY_CHUNK = b"JSON", b"BIN\0"


def write_glb(path: Path, content: Content) -> None:
    """Vertices in mm, float32, under a node whose matrix turns them into metres, Y up."""
    positions = content.mesh.vertices_mm.astype("<f4")
    buffers = [
        positions,
        _normals(content.mesh).astype("<f4"),
        content.mesh.faces.astype("<u4"),
    ]
    document = json.dumps(_document(content, positions, buffers), separators=(",", ":"))
    chunks = _chunk(_JSON_CHUNK, document.encode("ascii"), b" ")
    chunks += _chunk(_BINARY_CHUNK, b"".join(part.tobytes() for part in buffers), b"\0")
    path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)


def _normals(mesh: SurfaceMesh) -> Points:
    """Unit normals (n, 3), upright at a vertex without any: the format allows no other length."""
    normals = vertex_normals(mesh)
    normals[~normals.any(axis=1)] = [0.0, 0.0, 1.0]
    return normals


def _document(content: Content, positions: np.ndarray, buffers: list[np.ndarray]) -> dict[str, Any]:
    to_gltf = np.eye(4)
    to_gltf[:3, :3] = _TO_GLTF_M[content.axes]
    extras = content.facts() | {"note": _NOTE}
    places = np.cumsum([0, *(part.nbytes for part in buffers)]).tolist()
    targets = [_ARRAY_BUFFER, _ARRAY_BUFFER, _ELEMENT_ARRAY_BUFFER]
    points = {"componentType": _FLOAT, "count": len(positions), "type": "VEC3"}
    bounds = {"min": positions.min(axis=0).tolist(), "max": positions.max(axis=0).tolist()}
    return {
        "asset": {"version": "2.0", "generator": "neuralmri", "extras": extras},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [
            {
                "name": content.name,
                "mesh": 0,
                # Column by column.
                "matrix": to_gltf.T.ravel().tolist(),
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
        "materials": [_material(content.name)],
        "accessors": [
            {"bufferView": 0, **points, **bounds},
            {"bufferView": 1, **points},
            {
                "bufferView": 2,
                "componentType": _UINT32,
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


def _material(name: str) -> dict[str, Any]:
    """Of the structure in which a surface's name ends, grey where it names none."""
    # The longest first: lv_epi ends with epi.
    named = sorted((s for s in _SRGB if name.endswith(s.value)), key=lambda s: -len(s.value))
    srgb = np.array(_SRGB[named[0]] if named else _GREY) / 255.0
    # The format wants linear light.
    linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    return {
        "name": named[0].value if named else "surface",
        "pbrMetallicRoughness": {
            "baseColorFactor": [*linear.round(4).tolist(), 1.0],
            "metallicFactor": 0.0,
            "roughnessFactor": _ROUGHNESS,
        },
        "doubleSided": True,
    }


def _chunk(kind: bytes, data: bytes, padding: bytes) -> bytes:
    """Length, kind and data, which must end on a multiple of four bytes."""
    data += padding * (-len(data) % 4)
    return struct.pack("<I4s", len(data), kind) + data
