import json
import struct
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from schemas.vocabulary import Axes, Structure
from worker.artifacts.mesh_files.content import Content
from worker.artifacts.mesh_files.glb import write_glb
from worker.surface_mesh import SurfaceMesh


def _parsed(path: Path) -> tuple[dict[str, Any], bytes]:
    """The document and the buffer, by the letter of the specification of the container."""
    data = path.read_bytes()
    assert struct.unpack("<4sII", data[:12]) == (b"glTF", 2, len(data))
    length, kind = struct.unpack("<I4s", data[12:20])
    document, rest = data[20 : 20 + length], data[20 + length :]
    assert kind == b"JSON"
    size, kind = struct.unpack("<I4s", rest[:8])
    assert kind == b"BIN\0"
    assert len(rest) == 8 + size
    assert length % 4 == size % 4 == 0
    return json.loads(document), rest[8:]


def _accessor(document: dict[str, Any], buffer: bytes, index: int) -> np.ndarray:
    accessor = document["accessors"][index]
    view = document["bufferViews"][accessor["bufferView"]]
    kind = {5126: "<f4", 5125: "<u4"}[accessor["componentType"]]
    width = {"VEC3": 3, "SCALAR": 1}[accessor["type"]]
    part = buffer[view["byteOffset"] : view["byteOffset"] + view["byteLength"]]
    found = np.frombuffer(part, kind).reshape(-1, width)
    assert len(found) == accessor["count"]
    return found


@pytest.fixture
def written(content: Content, tmp_path: Path) -> tuple[dict[str, Any], bytes]:
    write_glb(tmp_path / "a.glb", content)
    return _parsed(tmp_path / "a.glb")


def test_positions_are_the_millimetres_and_their_bounds(
    written: tuple[dict[str, Any], bytes], content: Content
) -> None:
    document, buffer = written
    positions = _accessor(document, buffer, 0)
    np.testing.assert_array_equal(positions, content.mesh.vertices_mm.astype("<f4"))
    np.testing.assert_array_equal(
        _accessor(document, buffer, 2).ravel(), content.mesh.faces.ravel()
    )
    accessor = document["accessors"][0]
    assert np.array_equal(positions.min(axis=0), np.float32(accessor["min"]))
    assert np.array_equal(positions.max(axis=0), np.float32(accessor["max"]))
    assert document["buffers"] == [{"byteLength": len(buffer)}]


def test_normals_are_those_of_the_ellipsoid(
    written: tuple[dict[str, Any], bytes], content: Content
) -> None:
    document, buffer = written
    primitive = document["meshes"][0]["primitives"][0]
    assert primitive["attributes"].keys() == {"POSITION", "NORMAL"}, "no colours at vertices"
    normals = _accessor(document, buffer, primitive["attributes"]["NORMAL"])
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-6)
    exact = (content.mesh.vertices_mm - [100.0, -50.0, 25.0]) / np.square([30.0, 20.0, 10.0])
    exact /= np.linalg.norm(exact, axis=1, keepdims=True)
    # Triangles of about 4 mm on a surface that bends within 3 mm at its ends.
    assert (normals * exact).sum(axis=1).min() > 0.98


def test_a_vertex_without_area_has_a_unit_normal_all_the_same(tmp_path: Path) -> None:
    flat = SurfaceMesh(np.zeros((3, 3)), np.array([[0, 1, 2]]))
    write_glb(tmp_path / "flat.glb", Content(flat, "flat", Axes.LPS, None, []))
    assert _accessor(*_parsed(tmp_path / "flat.glb"), 1).tolist() == [[0.0, 0.0, 1.0]] * 3


def test_the_material_is_tissue_not_metal_and_seen_from_both_sides(
    written: tuple[dict[str, Any], bytes],
) -> None:
    (material,) = written[0]["materials"]
    assert material["name"] == "lv_endo"
    assert material["doubleSided"] is True
    assert material["pbrMetallicRoughness"]["metallicFactor"] == 0.0
    red, green, blue, alpha = material["pbrMetallicRoughness"]["baseColorFactor"]
    assert red > 4 * max(green, blue)
    assert alpha == 1.0


def test_every_structure_has_a_colour_of_its_own(content: Content, tmp_path: Path) -> None:
    colours = {}
    for name in [*(f"ED_{structure.value}" for structure in Structure), "sheet"]:
        write_glb(tmp_path / "a.glb", replace(content, name=name))
        (material,) = _parsed(tmp_path / "a.glb")[0]["materials"]
        colours[material["name"]] = tuple(material["pbrMetallicRoughness"]["baseColorFactor"])
    assert colours.keys() == {*Structure, "surface"}
    assert len(set(colours.values())) == len(colours)
    assert all(0.0 < part <= 1.0 for colour in colours.values() for part in colour)


def test_asset_and_node_say_whose_it_is(
    written: tuple[dict[str, Any], bytes], content: Content
) -> None:
    document, _ = written
    for place in (document["asset"], document["nodes"][0]):
        assert content.facts().items() <= place["extras"].items()
        assert "metres" in place["extras"]["note"]
    assert document["asset"]["version"] == "2.0"


@pytest.mark.parametrize(
    ("axes", "head", "front"),
    [(Axes.LPS, (0, 0, 1), (0, -1, 0)), (Axes.RAS, (0, 0, 1), (0, 1, 0))],
)
def test_it_is_in_metres_with_the_head_up_and_the_patient_facing_z(
    axes: Axes, head: tuple[int, ...], front: tuple[int, ...], tmp_path: Path
) -> None:
    corners_mm = np.array([[0, 0, 0], head, front], dtype=float) * 1000.0
    path = tmp_path / "corner.glb"
    corner = SurfaceMesh(corners_mm, np.array([[0, 1, 2]]))
    write_glb(path, Content(corner, "corner", axes, None, []))

    scene = trimesh.load_scene(path)

    corners_m = scene.to_mesh().vertices
    np.testing.assert_allclose(sorted(corners_m.tolist()), [[0, 0, 0], [0, 0, 1], [0, 1, 0]])
    ((matrix, _),) = (scene.graph[node] for node in scene.graph.nodes_geometry)
    assert np.linalg.det(matrix) == pytest.approx(1e-9), "a mirrored heart"
