"""Surfaces as unions of tissues: which classes a field needs so that surfaces nest by construction.

A requested surface encloses a set of tissues. Tissues that no requested surface tells apart are one
class, and everything no surface encloses is the background, so cavities lie inside walls and the
ventricles are disjoint whatever the network says.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool

from schemas.vocabulary import Structure

ENCLOSED: dict[Structure, frozenset[str]] = {
    Structure.LV_ENDO: frozenset({"lv_cavity"}),
    Structure.LV_EPI: frozenset({"lv_cavity", "lv_wall"}),
    Structure.RV_ENDO: frozenset({"rv_cavity"}),
    Structure.RV_EPI: frozenset({"rv_cavity", "rv_wall"}),
    Structure.EPI: frozenset({"lv_cavity", "lv_wall", "rv_cavity", "rv_wall"}),
}

_TISSUES = ("lv_cavity", "lv_wall", "rv_cavity", "rv_wall", "background")


@dataclass(frozen=True, eq=False)
class Partition:
    """The classes of a field and which of them each surface encloses.

    surfaces: the surfaces, in the order of every per-surface array.
    encloses: (surfaces, classes) truth table; every surface encloses one class at least and
        leaves one out.
    """

    surfaces: tuple[Structure, ...]
    encloses: Bool[np.ndarray, "surfaces classes"]

    @property
    def class_count(self) -> int:
        """Number of classes, background included."""
        return int(self.encloses.shape[1])


def partition(surfaces: Sequence[Structure]) -> Partition:
    """The coarsest partition of space that tells the given surfaces apart.

    Raises ValueError if no surface is given.
    """
    if not surfaces:
        raise ValueError("a partition needs one surface at least")
    ordered = tuple(s for s in Structure if s in set(surfaces))
    signatures = {tuple(tissue in ENCLOSED[s] for s in ordered) for tissue in _TISSUES}
    return Partition(ordered, np.array(sorted(signatures, reverse=True), dtype=bool).T)
