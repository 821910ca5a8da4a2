"""The same steps as `torch.optim.Adam`, to the bit."""

import torch

from worker.reconstruction.adam import Adam

RATES = [0.1, 0.05, 0.02, 0.01]


def loss_of(weights: list[torch.Tensor], step: int) -> torch.Tensor:
    # The second is in every other loss only: where it is not, it holds no gradient.
    first, second = weights
    loss = (first**2 - first).square().sum()
    return loss + second.sin().sum() if step % 2 == 0 else loss


def weights() -> list[torch.Tensor]:
    generator = torch.Generator().manual_seed(3)
    return [torch.randn(4, 3, generator=generator).requires_grad_() for _ in range(2)]


def test_steps_are_those_of_torch() -> None:
    ours, theirs = weights(), weights()
    adam, reference = Adam(ours), torch.optim.Adam(theirs, foreach=True)
    for step, rate in enumerate(RATES):
        loss_of(ours, step).backward()
        adam.step(rate)
        reference.zero_grad(set_to_none=True)
        loss_of(theirs, step).backward()
        reference.param_groups[0]["lr"] = rate
        reference.step()
    for own, other in zip(ours, theirs, strict=True):
        assert torch.equal(own, other)
    assert all(one.grad is None for one in ours)


def test_a_state_that_was_put_back_goes_on_as_if_never_stopped() -> None:
    unbroken, resumed = weights(), weights()
    whole = Adam(unbroken)
    for step, rate in enumerate(RATES[:2]):
        loss_of(unbroken, step).backward()
        whole.step(rate)
    with torch.no_grad():
        for own, other in zip(resumed, unbroken, strict=True):
            own.copy_(other)
    rest = Adam(resumed)
    rest.put_back(whole.state())
    for step, rate in enumerate(RATES[2:]):
        for adam, some in ((whole, unbroken), (rest, resumed)):
            loss_of(some, step).backward()
            adam.step(rate)
    for own, other in zip(unbroken, resumed, strict=True):
        assert torch.equal(own, other)
