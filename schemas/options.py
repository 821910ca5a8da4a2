"""Options of a reconstruction, grouped by the stage that owns them.

Every number of the method is here, bounded, with its unit. A preset fills what the request leaves
out; what a request names wins.
"""

from enum import StrEnum
from typing import Any, Self

from pydantic import Field, model_validator

from schemas.base import WireModel
from schemas.vocabulary import MeshFormat, Structure

_MOST_WORK_A_STEP = 2**32
"""Samples times depth times squared width: about 0.3 s on one core; the default is a hundredth."""


class Preset(StrEnum):
    """A named set of options: quick look, everyday default, the published recipe."""

    FAST = "fast"
    STANDARD = "standard"
    PAPER = "paper"


class Base(StrEnum):
    """What happens at the valve plane: a closed surface, or one cut open there."""

    CLOSED = "closed"
    OPEN = "open"


class NetworkOptions(WireModel):
    """The multilayer perceptron f: R3 -> class logits, in normalised coordinates."""

    width: int = Field(default=64, ge=8, le=512)
    depth: int = Field(default=4, ge=1, le=12, description="Hidden layers.")
    first_frequency: float = Field(
        default=6.0, gt=0.0, le=60.0, description="Radians per half-extent of the first sine layer."
    )


class OptimizerMethod(StrEnum):
    """How a gradient becomes a step."""

    MUON = "muon"
    ADAM = "adam"


class OptimizerOptions(WireModel):
    """Gradient descent with a cosine-decayed learning rate."""

    method: OptimizerMethod = Field(
        default=OptimizerMethod.MUON,
        description="muon: orthogonalised steps for the hidden matrices, Adam for the rest.",
    )
    learning_rate: float = Field(default=3e-2, gt=0.0, le=0.1)
    samples_per_step: int = Field(default=2048, ge=64, le=65536)


class SamplingOptions(WireModel):
    """Hierarchical samples: lengths as a fraction of the study's half-extent."""

    first_radius: float = Field(
        default=1 / 16, gt=0.0, le=0.5, description="Distance to the contour at level 0."
    )
    last_radius: float = Field(
        default=1 / 256, gt=0.0, le=0.5, description="Distance to the contour at the last level."
    )
    contour_samples_per_plane: int = Field(default=600, ge=16, le=50000)
    uniform_samples_per_plane: int = Field(default=600, ge=16, le=50000)
    hull_samples: int = Field(default=2048, ge=0, le=100000)
    far_samples: int = Field(default=1500, ge=0, le=100000)
    hull_inflation: float = Field(
        default=1.1, ge=1.0, le=2.0, description="Scale of the hull on which all is outside."
    )
    levels_in_mix: int = Field(
        default=3, ge=1, le=8, description="How many of the most recent levels are trained on."
    )


class LossOptions(WireModel):
    """BCE + hinge_weight * mean(max(0, |gradient| - hinge_slope))."""

    contour_weight: float = Field(
        default=64.0,
        gt=0.0,
        le=1e4,
        description="Of a sample on a contour, beside one inside or outside, in the mean BCE.",
    )
    hinge_weight: float = Field(default=1e-4, ge=0.0, le=10.0, description="lambda")
    hinge_slope: float = Field(
        default=100.0, gt=0.0, le=1e4, description="alpha, logits per half-extent"
    )
    hinge_samples: int = Field(default=64, ge=1, le=65536)
    contour_noise_mm: float | None = Field(
        default=None,
        ge=0.0,
        le=20.0,
        description="How far contours that cross miss each other, mm (standard deviation). The "
        "larger, the more slowly contours are learned and the less each one weighs, so that many "
        "slices together count for more than one hand. Left out, it is measured where long-axis "
        "contours cross short-axis ones, and 0 where none do.",
    )


class AlignmentOptions(WireModel):
    """In-plane slice shifts, learned together with the field."""

    first_level: int = Field(default=0, ge=0, le=8, description="Level from which shifts move.")
    prior_mm: float = Field(
        default=3.0, gt=0.0, le=20.0, description="Standard deviation of the shift prior."
    )
    learning_rate: float = Field(
        default=1e-2, gt=0.0, le=0.1, description="Of the shifts, half-extents a step."
    )
    max_shift_mm: float = Field(default=12.0, gt=0.0, le=50.0)
    rotate: bool = Field(
        default=False, description="Let slices also turn about their own normal, by 20° at most."
    )


class MeshOptions(WireModel):
    """Extraction of the isosurface."""

    grid_mm: float = Field(default=1.25, ge=0.5, le=10.0, description="Edge of the finest cell.")
    projection_steps: int = Field(
        default=2, ge=0, le=8, description="Newton steps onto the level set."
    )


class SequenceOptions(WireModel):
    """What the frames of one subject have of each other. A fit that goes on from a neighbour takes
    no more levels, iterations or samples, and no higher rate, than one from nothing.
    """

    warm_start: bool = Field(
        default=True,
        description="With three frames or more, fit the largest one from nothing, and each other "
        "one from its neighbour in time, whose field is moved onto its contours first.",
    )
    whole_cycle: bool = Field(
        default=True, description="Whether the first frame comes after the last one again."
    )
    levels: int = Field(
        default=4, ge=1, le=8, description="The last ones, of a fit that goes on from a neighbour."
    )
    iterations_per_level: int = Field(default=110, ge=1, le=5000)
    samples_per_step: int = Field(default=768, ge=64, le=65536)
    learning_rate: float = Field(default=1e-2, gt=0.0, le=0.1)
    share_shifts: bool = Field(
        default=True,
        description="One shift a slice for all frames, found from all of them: what one slice "
        "shows was taken in one breath-hold. Not with `alignment.rotate`, and not where slices of "
        "one id lie in different planes.",
    )


class Holdout(StrEnum):
    """How the error between slices is estimated without a reference."""

    NONE = "none"
    LEAVE_ONE_SLICE_OUT = "leave_one_slice_out"


class ReferenceOptions(WireModel):
    """How surfaces are held against references that were sent along. Nothing here moves a mesh."""

    align: bool = Field(
        default=False,
        description="Lay each surface rigidly onto its reference before measuring. Hides what is "
        "displaced or turned as a whole.",
    )
    samples: int = Field(
        default=20_000, ge=100, le=200_000, description="Points measured on either surface."
    )
    curvature_edge_mm: float | None = Field(
        default=2.0,
        ge=0.5,
        le=10.0,
        description="Edge length, mm, to which both are remeshed to compare how they bend. null: "
        "not compared, which saves seconds a surface.",
    )


class Options(WireModel):
    """Everything a caller may choose about a reconstruction."""

    surfaces: list[Structure] | None = Field(
        default=None,
        min_length=1,
        max_length=len(Structure),
        description="Left out, all that the study supports.",
    )
    preset: Preset = Preset.STANDARD
    levels: int = Field(default=6, ge=1, le=8, description="Coarse-to-fine refinement levels.")
    iterations_per_level: int = Field(default=120, ge=1, le=5000)
    seed: int = Field(default=0, ge=0, le=2**31 - 1)
    align_slices: bool = True
    base: Base = Base.CLOSED
    formats: list[MeshFormat] = Field(
        default_factory=lambda: [MeshFormat.STL, MeshFormat.OBJ],
        min_length=1,
        max_length=len(MeshFormat),
    )
    target_edge_mm: float | None = Field(
        default=None,
        ge=0.5,
        le=10.0,
        description="Remesh isotropically to this edge length, mm, shorter where the surface bends "
        "within one edge. Not finer than `mesh.grid_mm`. Left out, triangles are as they come from "
        "the grid, slivers among them.",
    )
    holdout: Holdout = Field(
        default=Holdout.NONE,
        description="leave_one_slice_out: fit again without each slice, in turn, and measure how "
        "far its contours are from that surface. Costs half a fit for each slice: with 15 slices "
        "about eight times the work.",
    )
    ensemble: int = Field(
        default=0,
        ge=0,
        le=16,
        description="How many more fits, with other seeds, to tell from their spread how certain "
        "every vertex is. Each costs as long as the fit itself.",
    )
    tracked_meshes: bool = Field(
        default=False,
        description="Carry one mesh of each surface through all frames of a study that has three "
        "or more, and write it for every frame beside the frame's own. Tangential motion and twist "
        "are not observed.",
    )
    compare_with: list[str] = Field(
        default_factory=list, max_length=0, description="Reserved: no method is offered yet."
    )
    network: NetworkOptions = Field(default_factory=NetworkOptions)
    optimizer: OptimizerOptions = Field(default_factory=OptimizerOptions)
    sampling: SamplingOptions = Field(default_factory=SamplingOptions)
    loss: LossOptions = Field(default_factory=LossOptions)
    alignment: AlignmentOptions = Field(default_factory=AlignmentOptions)
    mesh: MeshOptions = Field(default_factory=MeshOptions)
    sequence: SequenceOptions = Field(default_factory=SequenceOptions)
    reference: ReferenceOptions = Field(default_factory=ReferenceOptions)

    @model_validator(mode="after")
    def _step_is_short(self) -> Self:
        """A job looks between two steps whether it was cancelled."""
        step, net = self.optimizer.samples_per_step, self.network
        # A derivative is three more samples carried through the network.
        samples = step + 4 * min(self.loss.hinge_samples, step)
        work = samples * net.depth * net.width**2
        if work > _MOST_WORK_A_STEP:
            raise ValueError(
                f"one step would take {work / _MOST_WORK_A_STEP:.1f} times as long as it may, and "
                "could not be cancelled within a second; lower network.width, network.depth, "
                "optimizer.samples_per_step or loss.hinge_samples"
            )
        return self

    @model_validator(mode="after")
    def _edge_is_resolved(self) -> Self:
        edge_mm, grid_mm = self.target_edge_mm, self.mesh.grid_mm
        if edge_mm is not None and edge_mm < grid_mm:
            raise ValueError(
                f"target_edge_mm is {edge_mm:g}, finer than the {grid_mm:g} mm grid that the "
                f"surface is taken from; set mesh.grid_mm to {edge_mm:g}, or a longer edge"
            )
        return self

    @model_validator(mode="after")
    def _tracked_are_closed(self) -> Self:
        if self.tracked_meshes and self.base is Base.OPEN:
            raise ValueError(
                "tracked_meshes carries closed surfaces; leave `base` closed, or tracked_meshes out"
            )
        return self

    @model_validator(mode="before")
    @classmethod
    def _fill_from_preset(cls, given: Any) -> Any:
        if not isinstance(given, dict):
            return given
        name = given.get("preset", Preset.STANDARD)
        # Anything but a string is left for the field itself to refuse; a list has no hash.
        preset = PRESETS.get(name) if isinstance(name, str) else None
        return under(preset, given) if preset else given


PRESETS: dict[str, dict[str, Any]] = {
    Preset.FAST: {
        "levels": 4,
        "iterations_per_level": 90,
        "optimizer": {"samples_per_step": 1024},
        "mesh": {"grid_mm": 2.0},
        "sequence": {"levels": 3, "samples_per_step": 1024},
    },
    Preset.STANDARD: {},
    Preset.PAPER: {
        "align_slices": False,
        "network": {"first_frequency": 8.0},
        "optimizer": {"method": "adam", "learning_rate": 1e-2},
        "loss": {"contour_weight": 1.0, "hinge_samples": 256, "contour_noise_mm": 0.0},
        "mesh": {"projection_steps": 0},
        "sequence": {"warm_start": False, "share_shifts": False},
    },
}


def under(defaults: dict[str, Any], given: dict[str, Any]) -> dict[str, Any]:
    """`given` with what it leaves out taken from `defaults`, group by group."""
    merged = {**defaults, **given}
    for key, value in defaults.items():
        if isinstance(value, dict) and isinstance(given.get(key), dict):
            merged[key] = {**value, **given[key]}
    return merged
