"""A glTF file read and played by the letter of the specification, and its rules checked."""

import json
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

_FORMS = {5126: "<f4", 5125: "<u4"}
_WIDTHS = {"VEC3": 3, "SCALAR": 1}


@dataclass(frozen=True)
class Gltf:
    document: dict[str, Any]
    buffer: bytes

    def accessor(self, index: int) -> np.ndarray:
        found = self.document["accessors"][index]
        view = self.document["bufferViews"][found["bufferView"]]
        part = self.buffer[view["byteOffset"] : view["byteOffset"] + view["byteLength"]]
        values = np.frombuffer(part, _FORMS[found["componentType"]])
        return values.reshape(found["count"], _WIDTHS[found["type"]])

    def shown(self, seconds: float) -> dict[str, np.ndarray]:
        """Positions of every node that is not scaled to nothing, float32, by its name."""
        state = {}
        (animation,) = self.document["animations"]
        for channel in animation["channels"]:
            sampler = animation["samplers"][channel["sampler"]]
            target = channel["target"]
            state[target["node"], target["path"]] = self._sampled(sampler, seconds)
        found = {}
        for index, node in enumerate(self.document["nodes"]):
            if "mesh" not in node:
                continue
            scale = state.get((index, "scale"), np.ones(3, dtype="f4"))
            if not scale.any():
                continue
            mesh = self.document["meshes"][node["mesh"]]
            (primitive,) = mesh["primitives"]
            positions = self.accessor(primitive["attributes"]["POSITION"])
            weights = state.get((index, "weights"), mesh.get("weights", []))
            for weight, target in zip(weights, primitive.get("targets", []), strict=True):
                positions = positions + np.float32(weight) * self.accessor(target["POSITION"])
            found[node["name"]] = positions * scale
        return found

    def _sampled(self, sampler: dict[str, Any], seconds: float) -> np.ndarray:
        keys = self.accessor(sampler["input"]).ravel()
        values = self.accessor(sampler["output"]).reshape(len(keys), -1)
        after = int(np.searchsorted(keys, np.float32(seconds), side="right"))
        if after in (0, len(keys)):
            return values[min(after, len(keys) - 1)]
        before = after - 1
        if sampler["interpolation"] == "STEP":
            return values[before]
        share = (np.float32(seconds) - keys[before]) / (keys[after] - keys[before])
        return values[before] * (1 - share) + values[after] * share


def gltf(path: Path) -> Gltf:
    data = path.read_bytes()
    assert struct.unpack("<4sII", data[:12]) == (b"glTF", 2, len(data))
    length, kind = struct.unpack("<I4s", data[12:20])
    assert kind == b"JSON"
    document, rest = data[20 : 20 + length], data[20 + length :]
    size, kind = struct.unpack("<I4s", rest[:8])
    assert kind == b"BIN\0"
    assert length % 4 == size % 4 == 0
    return Gltf(json.loads(document), rest[8 : 8 + size])


def check(one: Gltf) -> None:
    """Rules of glTF 2.0 that an animated file can break."""
    document = one.document
    assert document["buffers"] == [{"byteLength": len(one.buffer)}]
    ends = 0
    for view in document["bufferViews"]:
        assert view["byteOffset"] % 4 == 0
        assert view["byteOffset"] == ends
        ends += view["byteLength"]
    assert ends == len(one.buffer)
    for index, accessor in enumerate(document["accessors"]):
        values = one.accessor(index)
        assert np.isfinite(values).all()
        if "min" in accessor:
            assert np.array_equal(values.min(axis=0), np.float32(accessor["min"]))
            assert np.array_equal(values.max(axis=0), np.float32(accessor["max"]))
    for mesh in document["meshes"]:
        (primitive,) = mesh["primitives"]
        count = document["accessors"][primitive["attributes"]["POSITION"]]["count"]
        assert one.accessor(primitive["indices"]).max() < count
        assert document["bufferViews"][primitive["indices"]]["target"] == 34963
        assert len(mesh.get("weights", [])) == len(primitive.get("targets", []))
        for places in (primitive["attributes"], *primitive.get("targets", [])):
            assert places.keys() == {"POSITION", "NORMAL"}
            assert {"min", "max"} <= document["accessors"][places["POSITION"]].keys()
            for place in places.values():
                assert document["accessors"][place]["count"] == count
        lengths = np.linalg.norm(one.accessor(primitive["attributes"]["NORMAL"]), axis=1)
        np.testing.assert_allclose(lengths, 1.0, atol=1e-5)
    (animation,) = document["animations"]
    targets = [(c["target"]["node"], c["target"]["path"]) for c in animation["channels"]]
    assert len(set(targets)) == len(targets)
    for channel in animation["channels"]:
        sampler = animation["samplers"][channel["sampler"]]
        node = document["nodes"][channel["target"]["node"]]
        assert "matrix" not in node, "a node that is animated has none"
        keys = one.accessor(sampler["input"])
        assert (np.diff(keys.ravel()) > 0).all()
        assert keys[0] >= 0
        assert {"min", "max"} <= document["accessors"][sampler["input"]].keys()
        targets_a_key = 1
        if channel["target"]["path"] == "weights":
            targets_a_key = len(document["meshes"][node["mesh"]]["weights"])
        assert document["accessors"][sampler["output"]]["count"] == targets_a_key * len(keys)
        for place in (sampler["input"], sampler["output"]):
            assert "target" not in document["bufferViews"][place]
