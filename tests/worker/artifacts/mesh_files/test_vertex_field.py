import numpy as np
import pytest

from schemas.problem import InternalError
from worker.artifacts.measured import FIELDS
from worker.artifacts.mesh_files.vertex_field import vertex_field


@pytest.mark.parametrize("name", FIELDS)
def test_numbers_become_float32_and_labels_uint8(name: str) -> None:
    field = vertex_field(name, np.array([0.0, 1.0, 17.0]), 3)
    labels = name in ("third", "aha_segment")
    assert field.values.dtype == (np.uint8 if labels else np.float32)
    assert field.values.tolist() == [0, 1, 17]


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("support_mm", " [mm]: "),
        ("mean_curvature_per_mm", " [1/mm]: "),
        ("gaussian_curvature_per_mm2", " [1/mm2]: "),
        ("third", ": "),
    ],
)
def test_it_says_its_unit_and_meaning(name: str, unit: str) -> None:
    assert vertex_field(name, np.zeros(1), 1).described == name + unit + FIELDS[name]


def test_every_description_is_one_line_of_ascii() -> None:
    for name in FIELDS:
        described = vertex_field(name, np.zeros(1), 1).described
        assert described.isascii()
        assert "\n" not in described


@pytest.mark.parametrize(
    ("name", "values", "said"),
    [
        ("support_mm", [1.0, np.nan, np.nan], "support_mm is not finite at 2 vertices; leave out"),
        ("support_mm", [1.0, np.inf, 0.0], "not finite at 1 vertices"),
        ("support_mm", [1.0, 1e39, 0.0], "not finite at 1 vertices"),
        ("support_mm", [1.0, 2.0], "2 numbers for 3 vertices"),
        ("beauty", [1.0, 2.0, 3.0], "beauty has no meaning.*add it to FIELDS"),
        ("third", [0.0, 0.5, 1.0], "third is a label.*round it"),
        ("aha_segment", [0.0, -1.0, 1.0], "whole number from 0 to 255"),
        ("aha_segment", [0.0, 256.0, 1.0], "whole number from 0 to 255"),
    ],
)
def test_what_cannot_be_written_is_our_fault(name: str, values: list[float], said: str) -> None:
    with pytest.raises(InternalError, match=said):
        vertex_field(name, np.array(values), 3)


def test_whole_numbers_may_come_as_integers() -> None:
    assert vertex_field("third", np.array([0, 2, 1]), 3).values.tolist() == [0, 2, 1]
