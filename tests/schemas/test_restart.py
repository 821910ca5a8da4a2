"""What a restart makes of a job's options: as if the first request had named the change too."""

from typing import Any

import pytest

from schemas.options import Options, Preset
from schemas.restart import RestartRequest, changed_options, options_as_chosen


def restarted(first: dict[str, Any], change: dict[str, Any]) -> Options:
    stored = Options.model_validate_json(Options.model_validate(first).model_dump_json())
    return Options.model_validate(changed_options(stored, RestartRequest(options=change)))


@pytest.mark.parametrize("preset", Preset)
@pytest.mark.parametrize("more", [{}, {"seed": 7}, {"mesh": {"grid_mm": 3.0}, "formats": ["ply"]}])
def test_no_change_is_no_change(preset: Preset, more: dict[str, Any]) -> None:
    first = {"preset": preset, **more}
    assert restarted(first, {}) == Options.model_validate(first)
    assert options_as_chosen(Options.model_validate(first)) == first


@pytest.mark.parametrize(
    ("first", "change", "both"),
    [
        ({"seed": 7, "levels": 3}, {"seed": 8}, {"seed": 8, "levels": 3}),
        (
            {"mesh": {"grid_mm": 2.0, "projection_steps": 1}},
            {"mesh": {"grid_mm": 1.0}},
            {"mesh": {"grid_mm": 1.0, "projection_steps": 1}},
        ),
        ({"formats": ["ply", "stl"]}, {"formats": ["vtp"]}, {"formats": ["vtp"]}),
        ({"target_edge_mm": 2.0}, {"target_edge_mm": None}, {}),
        ({"preset": "fast", "seed": 7}, {"preset": "paper"}, {"preset": "paper", "seed": 7}),
        ({"preset": "fast"}, {"preset": "standard"}, {}),
    ],
)
def test_it_is_as_if_the_first_request_had_named_both(
    first: dict[str, Any], change: dict[str, Any], both: dict[str, Any]
) -> None:
    assert restarted(first, change) == Options.model_validate(both)
