"""What is suspicious about volumes, and about what follows from them."""

from collections.abc import Mapping, Sequence

from schemas.frame_report import FrameReport
from schemas.report import FunctionReport
from schemas.vocabulary import Structure
from worker.artifacts.findings import Finding

_CAVITY_ML = (5.0, 600.0)
"""From a newborn's ventricle to a grossly dilated one; beyond, the units are rather wrong."""

_EJECTION_PERCENT = (10.0, 85.0)
"""From a failing heart to a cavity that all but closes."""

_WALLS: Mapping[Structure, tuple[Structure, ...]] = {
    Structure.LV_ENDO: (Structure.LV_EPI, Structure.EPI),
    Structure.RV_ENDO: (Structure.RV_EPI, Structure.EPI),
    Structure.LV_EPI: (Structure.EPI,),
    Structure.RV_EPI: (Structure.EPI,),
}
"""What encloses each surface."""


def volume_findings(frames: Sequence[FrameReport]) -> list[Finding]:
    """Cavities of a size that no heart has, and surfaces larger than what encloses them."""
    found = []
    low, high = _CAVITY_ML
    for frame in frames:
        volumes = {s: one.volume_ml for s, one in frame.surfaces.items() if one.volume_ml}
        for structure, volume in volumes.items():
            cavity = structure in (Structure.LV_ENDO, Structure.RV_ENDO)
            if cavity and not low <= volume <= high:
                text = (
                    f"{frame.label} {structure}: its volume is {volume:.1f} mL; ventricles have "
                    f"{low:g} to {high:g} mL. Check `units` and which slices were sent."
                )
                found.append(Finding(True, max(low / volume, volume / high), text))
            for outer in _WALLS.get(structure, ()):
                if outer in volumes and volumes[outer] <= volume:
                    text = (
                        f"{frame.label} {structure}: its volume, {volume:.1f} mL, is not below "
                        f"that of {outer} around it, {volumes[outer]:.1f} mL. Check whether the "
                        "names of the contours are swapped."
                    )
                    found.append(Finding(True, volume / volumes[outer], text))
    return found


def function_findings(
    frames: Sequence[FrameReport], function: FunctionReport | None, open_base: bool
) -> list[Finding]:
    """A pump function that no heart has, or none where both instants were sent."""
    if function is None:
        return [] if open_base else _no_function(frames)
    found = []
    low, high = _EJECTION_PERCENT
    for name, percent in (
        ("left", function.lv_ejection_fraction_percent),
        ("right", function.rv_ejection_fraction_percent),
    ):
        if percent is not None and not low <= percent <= high:
            ed, es = function.ed_frame or "ED", function.es_frame or "ES"
            text = (
                f"{ed} and {es}: the {name} ejection fraction is {percent:.1f} %; hearts have "
                f"{low:g} to {high:g} %. Check whether the frames are swapped, and whether both "
                "show the same slices."
            )
            found.append(Finding(percent <= 0.0, abs(percent - 50.0), text))
    return found


def stopped_findings(function: FunctionReport | None) -> list[Finding]:
    """What a job that was stopped early does not tell."""
    lacks = "`cycle.chambers`" if function else "`function` and `cycle.chambers`"
    text = (
        "The job was stopped before all frames were finished, and end-systole may be among those "
        f"that are missing: {lacks} are not given, and the cycle is taken for no whole one. "
        "For all frames, `restart` the job."
    )
    return [Finding(False, 0.0, text)]


def _no_function(frames: Sequence[FrameReport]) -> list[Finding]:
    both = [one for one in frames if one.label.upper() in ("ED", "ES")]
    if len(both) < 2 or any(Structure.LV_ENDO not in one.surfaces for one in both):
        return []
    text = (
        "ED and ES: no ejection fraction, for lv_endo is not closed in both. See what is said of "
        "it there."
    )
    return [Finding(False, 0.0, text)]
