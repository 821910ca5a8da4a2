"""What to worry about first: everything suspicious about a reconstruction, ranked."""

from collections.abc import Sequence
from typing import Literal

from schemas.frame_report import FrameReport
from schemas.report import Concern, FunctionReport
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
from worker.artifacts.volume_findings import function_findings, volume_findings

_SHOWN = 3
"""Of one kind; of more, only how many."""


def concerns(
    frames: Sequence[FrameReport],
    warnings: Sequence[str],
    *,
    function: FunctionReport | None = None,
    open_base: bool = False,
) -> list[Concern]:
    """All that a reader should look at before using the surfaces, the gravest first.

    Every text says what, where, how much and what to do. Of a kind the worst are named and the rest
    counted. Warnings are taken over word for word, as notable, each once.

    Args:
        frames: As measured.
        warnings: What was said on the way, by intake and by measuring.
        function: Pump function, if it was measured.
        open_base: Whether surfaces are meant to have a rim at the valves.
    """
    kinds: list[tuple[str, list[Finding]]] = [
        ("faults of surfaces", topology_findings(frames, open_base)),
        ("implausible volumes", volume_findings(frames)),
        ("doubts about the pump function", function_findings(frames, function, open_base)),
        ("surfaces far from their reference", reference_findings(frames)),
        ("surfaces that pass through each other", contact_findings(frames)),
        ("contours that the surface misses", residual_findings(frames)),
        ("slices with little overlap", overlap_findings(frames)),
        ("surfaces that hang on a single slice", held_out_findings(frames)),
        ("surfaces on which fits disagree", spread_findings(frames)),
        ("displaced slices", shift_findings(frames)),
        ("slices of uncertain place", uncertain_shift_findings(frames)),
    ]
    measured = [one for name, findings in kinds for one in _worst(name, findings)]
    # Graver than the measured doubts below them, for they tell what the input lacks.
    said = [Concern(severity="notable", text=text) for text in dict.fromkeys(warnings)]
    grave = [one for one in measured if one.severity == "grave"]
    return [*grave, *said, *(one for one in measured if one.severity == "notable")]


def _worst(kind: str, findings: Sequence[Finding]) -> list[Concern]:
    ranked = sorted(findings, key=lambda one: (not one.grave, -one.size))
    shown, rest = ranked[:_SHOWN], ranked[_SHOWN:]
    if len(rest) == 1:  # its own sentence is no longer than a count of one
        shown, rest = ranked, []
    found = [Concern(severity=_severity(one), text=one.text) for one in shown]
    if rest:
        text = f"And {len(rest)} more {kind}; the tables below name them."
        found.append(Concern(severity=_severity(rest[0]), text=text))
    return found


def _severity(finding: Finding) -> Literal["grave", "notable"]:
    return "grave" if finding.grave else "notable"
