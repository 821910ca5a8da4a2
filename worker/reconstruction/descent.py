"""One descent step for the field and the shifts of its slices."""

import torch
from torch import Tensor

from schemas.options import OptimizerMethod, Options
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
        self._groups = torch.optim.Adam(
            [{"params": others}, {"params": list(shifts.parameters())}], lr=self._rate, foreach=True
        )

    def step(self, loss: Tensor, decay: float) -> None:
        """Move all parameters against the gradient of `loss`, rates times `decay`."""
        loss.backward()
        network, shifts = self._groups.param_groups
        network["lr"], shifts["lr"] = decay * self._rate, decay * self._shift_rate
        self._groups.step()
        self._groups.zero_grad(set_to_none=True)
        if self._muon is not None:
            self._muon.step(decay * self._rate)
        self._shifts.restrain()
