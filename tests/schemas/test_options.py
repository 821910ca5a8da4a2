"""Options: presets fill what the request leaves out, and what it names wins."""

from typing import Any

import pytest
from pydantic import ValidationError

from schemas.options import PRESETS, OptimizerMethod, Options, Preset
from schemas.vocabulary import MeshFormat


def leaves(group: dict[str, Any], path: tuple[str, ...] = ()) -> list[tuple[tuple[str, ...], Any]]:
    found = []
    for key, value in group.items():
        if isinstance(value, dict):
            found += leaves(value, (*path, key))
        else:
            found.append(((*path, key), value))
    return found


def value_at(options: Options, path: tuple[str, ...]) -> Any:
    value: Any = options
    for step in path:
        value = getattr(value, step)
    return value


def nested(path: tuple[str, ...], value: Any) -> Any:
    for step in reversed(path):
        value = {step: value}
    return value


def test_nothing_named_is_the_published_default() -> None:
    options = Options()
    assert (options.levels, options.iterations_per_level, options.seed) == (6, 120, 0)
    assert options.formats == [MeshFormat.STL, MeshFormat.OBJ]
    assert options.surfaces is None
    assert options.preset is Preset.STANDARD
    assert options.optimizer.method is OptimizerMethod.MUON
    assert options.align_slices
    assert not options.alignment.rotate


def test_the_published_recipe_descends_weighs_and_aligns_as_published() -> None:
    paper = Options(preset=Preset.PAPER)
    assert paper.optimizer.method is OptimizerMethod.ADAM
    assert paper.loss.contour_weight == 1.0
    assert not paper.align_slices


@pytest.mark.parametrize("preset", list(Preset))
def test_a_preset_sets_exactly_its_own(preset: Preset) -> None:
    options, default = Options(preset=preset), Options()
    for path, value in leaves(PRESETS[preset]):
        assert value_at(options, path) == value
    own = {path for path, _ in leaves(PRESETS[preset])} | {("preset",)}
    for path, value in leaves(default.model_dump()):
        if path not in own:
            assert value_at(options, path) == value


@pytest.mark.parametrize(
    ("preset", "path"), [(p, path) for p in Preset for path, _ in leaves(PRESETS[p])]
)
def test_what_a_request_names_wins(preset: Preset, path: tuple[str, ...]) -> None:
    default = value_at(Options(), path)
    options = Options.model_validate({"preset": preset.value, **nested(path, default)})
    assert value_at(options, path) == default
    for other, value in leaves(PRESETS[preset]):
        if other != path:
            assert value_at(options, other) == value


@pytest.mark.parametrize("preset", list(Preset))
def test_options_survive_the_wire(preset: Preset) -> None:
    options = Options(preset=preset, levels=3)
    assert Options.model_validate_json(options.model_dump_json()) == options


@pytest.mark.parametrize(
    "given",
    [
        {"levels": 0},
        {"levels": 9},
        {"iterations_per_level": 0},
        {"seed": -1},
        {"seed": 2**31},
        {"target_edge_mm": 0.1},
        {"base": "ajar"},
        {"preset": "best"},
        {"preset": []},
        {"preset": {}},
        {"preset": None},
        {"surfaces": []},
        {"surfaces": ["lv_endo"] * 6},
        {"formats": ["stl"] * 6},
        {"network": {"width": 1}},
        {"optimizer": {"method": "sgd"}},
        {"optimizer": {"learning_rate": 0.2}},
        {"loss": {"hinge_weight": float("nan")}},
        {"loss": {"contour_weight": 0.0}},
        {"loss": {"contour_weight": 1e5}},
        {"alignment": {"rotate": "sideways"}},
        {"alignment": {"first_level": -1}},
        {"mesh": {"grid_mm": 0}},
        {"mesh": 3},
        {"preset": "fast", "mesh": 3},
        {"colour": 1},
        {"mesh": {"colour": 1}},
        [],
        None,
    ],
)
def test_out_of_bounds_is_refused(given: Any) -> None:
    with pytest.raises(ValidationError):
        Options.model_validate(given)


def test_options_are_frozen() -> None:
    with pytest.raises(ValidationError):
        Options().levels = 3


@pytest.mark.parametrize(
    "given",
    [
        {"network": {"width": 512, "depth": 12}},
        {"network": {"width": 256, "depth": 6}, "optimizer": {"samples_per_step": 65536}},
    ],
)
def test_a_step_too_long_to_be_cancelled_is_refused(given: dict[str, Any]) -> None:
    with pytest.raises(ValidationError, match="within a second; lower network"):
        Options.model_validate(given)


@pytest.mark.parametrize(
    "given",
    [
        {"network": {"width": 512, "depth": 4}, "optimizer": {"samples_per_step": 1024}},
        {"network": {"width": 8, "depth": 12}, "optimizer": {"samples_per_step": 65536}},
        {"loss": {"hinge_samples": 65536}},
    ],
)
def test_large_steps_of_small_networks_and_the_reverse_are_accepted(given: dict[str, Any]) -> None:
    Options.model_validate(given)


def test_remeshing_finer_than_the_grid_is_refused_with_the_remedy() -> None:
    with pytest.raises(ValidationError, match=r"set mesh\.grid_mm to 1, or a longer edge"):
        Options.model_validate({"target_edge_mm": 1.0, "mesh": {"grid_mm": 1.25}})
    assert Options.model_validate({"target_edge_mm": 1.0, "mesh": {"grid_mm": 1.0}})
    with pytest.raises(ValidationError, match="finer than the 2 mm grid"):
        Options.model_validate({"target_edge_mm": 1.5, "preset": "fast"})
