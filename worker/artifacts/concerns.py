"""What to worry about first: everything suspicious about a reconstruction, ranked."""

import re
from collections.abc import Mapping, Sequence
from typing import Literal

from schemas.frame_report import FrameReport
from schemas.report import Concern, FunctionReport
from schemas.tracking_report import TrackedSurfaceReport
from schemas.vocabulary import Structure
from worker.artifacts.error_findings import (
    held_out_findings,
    reference_findings,
    spread_findings,
)
from worker.artifacts.findings import Finding
from worker.artifacts.slice_findings import (
    overlap_findings,
    residual_findings,
    shift_findings,
    uncertain_shift_findings,
)
from worker.artifacts.surface_findings import contact_findings, topology_findings
from worker.artifacts.tracking_findings import tracking_findings
from worker.artifacts.volume_findings import function_findings, stopped_findings, volume_findings

_SHOWN = 3
"""Of one kind; of more, only how many."""

_NAMES = re.compile(rf"\S*\d\S*|\b({'|'.join(Structure)})\b")
"""What differs between warnings of one kind: numbers, names with digits, structures."""


def concerns(
    frames: Sequence[FrameReport],
    warnings: Sequence[str],
    *,
    function: FunctionReport | None = None,
    tracking: Mapping[Structure, TrackedSurfaceReport] | None = None,
    open_base: bool = False,
    stopped_early: bool = False,
) -> list[Concern]:
    """All that a reader should look at before using the surfaces, the gravest first.

    Every text says what, where, how much and what to do. Of a kind the worst are named and the rest
    counted. Warnings are taken over word for word, as notable, each once, and are of one kind where
    they are alike.

    Args:
        frames: As measured.
        warnings: What was said on the way, by intake and by measuring.
        function: Pump function, if it was measured.
        tracking: Of the surfaces that were carried through the frames.
        open_base: Whether surfaces are meant to have a rim at the valves.
        stopped_early: Whether frames are missing because the job was stopped.
    """
    of_frames, of_input = _split(warnings, frames)
    kinds: list[tuple[str, Sequence[Finding]]] = [
        ("faults of surfaces", topology_findings(frames, open_base)),
        ("implausible volumes", volume_findings(frames)),
        ("doubts about the pump function", function_findings(frames, function, open_base)),
        ("jobs stopped early", stopped_findings(function) if stopped_early else []),
        *_alike(of_frames),
        ("surfaces far from their reference", reference_findings(frames)),
        ("surfaces that pass through each other", contact_findings(frames)),
        ("tracked meshes with faults", tracking_findings(tracking or {})),
        ("contours that the surface misses", residual_findings(frames)),
        ("slices with little overlap", overlap_findings(frames)),
        ("surfaces that hang on a single slice", held_out_findings(frames)),
        ("surfaces on which fits disagree", spread_findings(frames)),
        *_alike(of_input),
        ("displaced slices", shift_findings(frames)),
        ("slices of uncertain place", uncertain_shift_findings(frames)),
    ]
    ranked = [one for name, findings in kinds for one in _worst(name, findings)]
    # Stable: within a severity the kinds stay in the order above.
    return sorted(ranked, key=lambda one: one.severity != "grave")


def _split(
    warnings: Sequence[str], frames: Sequence[FrameReport]
) -> tuple[Sequence[str], Sequence[str]]:
    """Warnings that begin with a frame's label, which its surfaces gave rise to, and all others,
    each once.
    """
    begins = tuple(f"{one.label}{end}" for one in frames for end in (" ", ":"))
    each = dict.fromkeys(warnings)
    return [w for w in each if w.startswith(begins)], [w for w in each if not w.startswith(begins)]


def _alike(warnings: Sequence[str]) -> list[tuple[str, Sequence[Finding]]]:
    """Warnings that differ in names and numbers only are of one kind."""
    kinds: dict[str, list[Finding]] = {}
    for text in warnings:
        kinds.setdefault(_NAMES.sub("", text), []).append(Finding(False, 0.0, text))
    return [("warnings like these", findings) for findings in kinds.values()]


def _worst(kind: str, findings: Sequence[Finding]) -> list[Concern]:
    ranked = sorted(findings, key=lambda one: (not one.grave, -one.size))
    shown, rest = ranked[:_SHOWN], ranked[_SHOWN:]
    if len(rest) == 1:  # its own sentence is no longer than a count of one
        shown, rest = ranked, []
    found = [Concern(severity=_severity(one), text=one.text) for one in shown]
    if rest:
        text = f"And {len(rest)} more {kind}; all of them are listed below."
        found.append(Concern(severity=_severity(rest[0]), text=text))
    return found


def _severity(finding: Finding) -> Literal["grave", "notable"]:
    return "grave" if finding.grave else "notable"
