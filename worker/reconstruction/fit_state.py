"""The state of a fit between two levels, as bytes and back: what a checkpoint of it holds.

Samples are not in it. They follow from the seed alone, and drawing them again takes a fraction of a
second where storing them takes megabytes.
"""

import io
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch

from worker.checkpoints import Checkpoint
from worker.reconstruction.alignment import SliceShifts
from worker.reconstruction.descent import Descent
from worker.reconstruction.fitted_level import FittedLevel
from worker.reconstruction.network import TissueField


@dataclass(frozen=True, eq=False)
class FitState:
    """Everything that a level of a fit changes; it is read and put back in place."""

    field: TissueField
    shifts: SliceShifts
    descent: Descent
    generator: torch.Generator

    def save(self, levels: Sequence[FittedLevel], of: int, checkpoint: Checkpoint) -> None:
        """Keep the state after `levels`, out of as many as `of`.

        After the last one, only what was found: nothing will be learned any more.
        """
        state: dict[str, Any] = {
            "field": self.field.state_dict(),
            "shifts": self.shifts.state_dict(),
            "samples": [level.samples for level in levels],
            "losses": [
                torch.as_tensor(np.stack([level.bce, level.hinge]), dtype=torch.float32)
                for level in levels
            ],
        }
        if len(levels) < of:
            state["descent"] = self.descent.state()
            state["generator"] = self.generator.get_state()
        content = io.BytesIO()
        torch.save(state, content)
        checkpoint.save(content.getvalue())

    def load(self, checkpoint: Checkpoint) -> list[FittedLevel]:
        """Put back what was kept, and return the levels that led to it; none where nothing was."""
        content = checkpoint.load()
        if content is None:
            return []
        # Tensors, numbers and names alone: bytes from a disk must not run as code.
        state = torch.load(io.BytesIO(content), weights_only=True)  # noqa: TID251 - no code
        self.field.load_state_dict(state["field"])
        self.shifts.load_state_dict(state["shifts"])
        if "descent" in state:
            self.descent.put_back(state["descent"])
            self.generator.set_state(state["generator"])
        return [
            FittedLevel(number, samples, *losses.numpy().astype(np.float64))
            for number, (samples, losses) in enumerate(
                zip(state["samples"], state["losses"], strict=True)
            )
        ]
