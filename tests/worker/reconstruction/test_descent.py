"""One step moves every parameter, as far as its rate and the decay say."""

from dataclasses import replace

import pytest
import torch
from torch import Tensor

from schemas.options import Options
from schemas.study import ContourStudy
from worker.reconstruction.alignment import SliceShifts
from worker.reconstruction.descent import Descent
from worker.reconstruction.network import TissueField
from worker.reconstruction.normalisation import normalise
from worker.reconstruction.shift_evidence import no_evidence
from worker.reconstruction.stacking import build_stack

METHODS = pytest.mark.parametrize("method", ["muon", "adam"])


def options_of(method: str, depth: int = 3) -> Options:
    return Options.model_validate(
        {"network": {"width": 16, "depth": depth}, "optimizer": {"method": method}}
    )


def start(study: ContourStudy, options: Options) -> tuple[TissueField, SliceShifts]:
    stack, _ = normalise(build_stack(study, study.frames[0]))
    field = TissueField(3, options.network, torch.Generator().manual_seed(0))
    evidence = replace(no_evidence(len(stack.slices), 0.1), displaced=True)
    return field, SliceShifts(stack, evidence, 0.4, turning=True)


def loss_of(field: TissueField, shifts: SliceShifts) -> Tensor:
    generator = torch.Generator().manual_seed(1)
    points = torch.rand(64, 3, generator=generator)
    slices = torch.randint(len(shifts.in_plane), (64,), generator=generator)
    logits, jacobian = field.with_jacobian(shifts.aligned(points, slices), 16)
    return (logits**2).mean() + 1e-3 * (jacobian**2).mean()


def moved(study: ContourStudy, options: Options, decay: float) -> dict[str, Tensor]:
    """How far one step moves each parameter."""
    field, shifts = start(study, options)
    named = [*field.named_parameters(), *shifts.named_parameters()]
    before = {name: parameter.detach().clone() for name, parameter in named}
    Descent(field, shifts, options).step(loss_of(field, shifts), decay)
    assert all(parameter.grad is None for _, parameter in named)
    return {name: (parameter.detach() - before[name]).abs() for name, parameter in named}


@METHODS
@pytest.mark.parametrize("depth", [1, 3])
def test_every_parameter_moves_against_the_gradient(
    concentric_spheres, method: str, depth: int
) -> None:
    options = options_of(method, depth)
    steps = moved(concentric_spheres(), options, 1.0)
    assert set(steps) == {
        "first", "hidden", "last", "biases", "last_bias", "in_plane", "turns",
    }  # fmt: skip
    assert all(step.any() for step in steps.values() if step.numel())
    field, shifts = start(concentric_spheres(), options)
    descent = Descent(field, shifts, options)
    first = loss_of(field, shifts)
    descent.step(first, 0.1)
    assert loss_of(field, shifts) < first


@METHODS
def test_rates_are_the_options_times_the_decay(concentric_spheres, method: str) -> None:
    options = options_of(method)
    whole, half = (moved(concentric_spheres(), options, decay) for decay in (1.0, 0.5))
    # Adam's first step is the rate itself, whatever the gradient.
    assert whole["first"].max().item() == pytest.approx(options.optimizer.learning_rate, rel=1e-3)
    assert whole["turns"].max().item() == pytest.approx(options.alignment.learning_rate, rel=1e-3)
    for name, step in whole.items():
        torch.testing.assert_close(half[name], 0.5 * step, rtol=1e-3, atol=1e-6)


def test_the_methods_differ_in_the_hidden_matrices_alone(concentric_spheres) -> None:
    muon, adam = (moved(concentric_spheres(), options_of(m), 1.0) for m in ("muon", "adam"))
    for name, step in muon.items():
        assert torch.equal(step, adam[name]) == (name != "hidden")


@METHODS
def test_shifts_are_restrained_after_a_step(concentric_spheres, method: str) -> None:
    options = options_of(method)
    field, shifts = start(concentric_spheres(), options)
    descent = Descent(field, shifts, options)
    descent.step(loss_of(field, shifts) + 10.0 * shifts.in_plane.sum(), 1.0)
    assert not shifts.in_plane[-2:].any()  # the long-axis slices
    assert shifts.in_plane[1:-2].any()


@METHODS
def test_what_holds_no_gradient_stays(concentric_spheres, method: str) -> None:
    """Before shifts learn, the loss does not depend on them."""
    options = options_of(method)
    field, shifts = start(concentric_spheres(displacements={4: (3.0, 1.0)}), options)
    before = shifts.in_plane.detach().clone()
    logits, _ = field.with_jacobian(torch.rand(8, 3), 0)
    Descent(field, shifts, options).step((logits**2).mean(), 1.0)
    assert torch.equal(shifts.in_plane, before)
