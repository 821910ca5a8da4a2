"""One descent step for the field and the shifts of its slices."""

from typing import Any

from torch import Tensor

from schemas.options import OptimizerMethod, Options
from worker.reconstruction.adam import Adam
from worker.reconstruction.alignment import SliceShifts
from worker.reconstruction.muon import Muon
from worker.reconstruction.network import TissueField


class Descent:
    """Muon or Adam for the hidden matrices, Adam for all other parameters."""

    def __init__(self, field: TissueField, shifts: SliceShifts, options: Options) -> None:
        self._shifts = shifts
        self._rate = options.optimizer.learning_rate
        self._shift_rate = options.alignment.learning_rate
        others = [p for p in field.parameters() if p is not field.hidden]
        self._muon = None
        if options.optimizer.method is OptimizerMethod.MUON and len(field.hidden):
            self._muon = Muon(field.hidden)
        else:
            others.append(field.hidden)
        self._adam = Adam(others)
        self._shift_adam = Adam(list(shifts.parameters()))

    def step(self, loss: Tensor, decay: float) -> None:
        """Move all parameters against the gradient of `loss`, rates times `decay`."""
        loss.backward()
        self._adam.step(decay * self._rate)
        self._shift_adam.step(decay * self._shift_rate)
        if self._muon is not None:
            self._muon.step(decay * self._rate)
        self._shifts.restrain()

    def state(self) -> dict[str, Any]:
        """What steps have left behind: all that `put_back` needs to go on as if never stopped."""
        muon = None if self._muon is None else self._muon.momentum
        return {"adam": self._adam.state(), "shifts": self._shift_adam.state(), "muon": muon}

    def put_back(self, state: dict[str, Any]) -> None:
        """Go on from a state of the same method and shapes."""
        self._adam.put_back(state["adam"])
        self._shift_adam.put_back(state["shifts"])
        if self._muon is not None:
            self._muon.momentum.copy_(state["muon"])
