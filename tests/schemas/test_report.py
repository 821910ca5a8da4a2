"""The report's own schema: versioned, every number with its unit, no number that is not one."""

import math
from collections.abc import Iterator

import pytest
from pydantic import ValidationError

from schemas.measures import DistanceSummary
from schemas.report import Report

UNITS = (
    "_mm",
    "_mm2",
    "_ml",
    "_cm2",
    "_g",
    "_deg",
    "_rad",
    "_s",
    "_ms",
    "_percent",
    "_per_mm",
    "_per_mm2",
)

PURE = {
    # counts
    "vertices", "faces", "euler_number", "components", "count", "counts", "beyond", "crossings",
    "self_intersecting_triangles", "crossing_triangles", "planes", "points", "samples", "level",
    "seed", "threads", "triangles", "turned_over", "against_surface", "folded",
    "self_intersections",
    # ratios
    "dice", "dice_mean", "dice_min", "sphericity", "aspect_ratio_mean", "aspect_ratio_p95",
    "aspect_ratio_max", "area_ratio_min", "area_ratio_max",
    # losses, as docs/method.md defines them
    "bce", "hinge", "total",
}  # fmt: skip
"""Numbers that have no unit."""


def numbers(schema: dict, node: dict, path: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
    """Paths of all numbers below a node of a JSON schema, options aside."""
    if "$ref" in node:
        name = node["$ref"].rpartition("/")[2]
        if name != "Options":
            yield from numbers(schema, schema["$defs"][name], path)
    for choice in (*node.get("anyOf", ()), *node.get("prefixItems", ())):
        yield from numbers(schema, choice, path)
    if node.get("type") in ("number", "integer"):
        yield path
    for inner in ("items", "additionalProperties"):
        if isinstance(node.get(inner), dict):
            yield from numbers(schema, node[inner], path)
    for name, part in node.get("properties", {}).items():
        yield from numbers(schema, part, (*path, name))


def test_every_number_has_its_unit_in_its_name_or_its_parents() -> None:
    schema = Report.model_json_schema()
    found = list(numbers(schema, schema, ()))
    assert len(found) > 150
    without = [
        ".".join(path)
        for path in found
        if path[-1] not in PURE and not any(name.endswith(UNITS) for name in path)
    ]
    assert without == []


def test_the_schema_says_its_version() -> None:
    version = Report.model_json_schema()["properties"]["schema_version"]
    assert version["const"] == version["default"]
    assert version["const"].count(".") == 1


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_no_number_is_no_number(bad: float) -> None:
    fine = {"mean": 1.0, "rms": 1.0, "p50": 1.0, "p90": 1.0, "p95": 1.0, "max": 1.0, "count": 1}
    DistanceSummary.model_validate(fine)
    with pytest.raises(ValidationError):
        DistanceSummary.model_validate({**fine, "p95": bad})
