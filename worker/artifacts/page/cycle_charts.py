"""All charts of a whole cycle."""

from collections.abc import Iterator, Sequence
from typing import Any

from schemas.cycle_report import CycleReport, Series
from worker.artifacts.frame_times import FrameTimes
from worker.artifacts.page.bullseye import bullseye
from worker.artifacts.page.chart import Chart
from worker.artifacts.page.lines import bands, line, lines, over_time
from worker.artifacts.page.palette import STRUCTURE_COLOURS
from worker.artifacts.page.segments_over_time import segments_over_time
from worker.evaluation.aha_segments import NAMES

_BAND = "band: 5th to 95th percentile, by area."


def cycle_charts(cycle: CycleReport, times: FrameTimes, not_observed: str) -> list[Chart]:
    """Those that have something to show, the volumes first: of these shape 0 is the line that marks
    the frame on show. not_observed: what of the motion no contour shows.
    """
    steps = dict(zip(times.labels, times.steps, strict=True))
    at = [steps[label] for label in cycle.frames]
    across = "time, ms" if times.times_ms else "frame"
    found = [
        _volume(cycle, at, across),
        *_surfaces(cycle, at, across),
        *_left_ventricle(cycle, at, across),
        *_strain(cycle, at, across, not_observed),
        *_curvature(cycle, at, across),
    ]
    return [chart for chart in found if chart.figure["data"]]


def _volume(cycle: CycleReport, at: Sequence[float], across: str) -> Chart:
    data = lines({s: one.volume_ml for s, one in cycle.surfaces.items()}, at, "mL")
    place = dict(zip(cycle.frames, at, strict=True))
    for nth, (structure, chamber) in enumerate(cycle.chambers.items()):
        marked = ((chamber.ed_frame, chamber.edv_ml), (chamber.es_frame, chamber.esv_ml))
        data.append(
            {
                "type": "scatter",
                # One name is enough where both are at their fullest together.
                "mode": "markers" if nth else "markers+text",
                "x": [place[label] for label, _ in marked],
                "y": [round(volume, 2) for _, volume in marked],
                "text": ["ED", "ES"],
                "textposition": ["top center", "bottom center"],
                "cliponaxis": False,
                "marker": {
                    "size": 9,
                    "symbol": "circle-open",
                    "line": {"width": 2},
                    "color": STRUCTURE_COLOURS[structure],
                },
                "showlegend": False,
                "hoverinfo": "skip",
            }
        )
    marker = {
        "type": "line",
        "xref": "x",
        "yref": "paper",
        "x0": at[0],
        "x1": at[0],
        "y0": 0,
        "y1": 1,
        "line": {"color": "#888888", "width": 1.5, "dash": "dot"},
    }
    note = "Of every closed surface. Dotted: the frame that is shown above. Circles: ED and ES."
    figure = over_time(data, across, "volume, mL", shapes=[marker])
    # From nothing on, or the name of ES lies on the axis.
    figure["layout"]["yaxis"]["rangemode"] = "tozero"
    return Chart("Volume", note, figure, broad=True)


def _surfaces(cycle: CycleReport, at: Sequence[float], across: str) -> Iterator[Chart]:
    area = lines({s: one.area_change_percent for s, one in cycle.surfaces.items()}, at, "%")
    note = f"Of each whole surface, from {cycle.ed_frame}."
    yield Chart("Change of area", note, over_time(area, across, "area, %"))
    regions: list[tuple[str, str, dict[Any, Series]]] = [
        (
            "Area in the 90th-percentile error region",
            "Where distance to the reference is above its own 90th percentile.",
            {s: one.above_p90_error_area_percent for s, one in cycle.surfaces.items()},
        ),
        (
            "Area in the 75th-percentile curvature region",
            "Where Gaussian curvature differs from the reference's by more than the 75th "
            "percentile.",
            {s: one.above_p75_curvature_area_percent for s, one in cycle.surfaces.items()},
        ),
    ]
    for title, note, shares in regions:
        yield Chart(title, note, over_time(lines(shares, at, "%"), across, "area, %"))


def _left_ventricle(cycle: CycleReport, at: Sequence[float], across: str) -> Iterator[Chart]:
    lv = cycle.left_ventricle
    named = [
        ("longitudinal", "#2c6fb0", lv.longitudinal_shortening_percent),
        ("circumferential", "#c8452f", lv.circumferential_shortening_percent),
    ]
    data = [line(name, colour, at, values, "%") for name, colour, values in named if _known(values)]
    note = (
        f"From {cycle.ed_frame}: of the cavity's length along its long axis, and of its perimeter "
        "half-way. Twist is not observed."
    )
    yield Chart("Shortening, left ventricle", note, over_time(data, across, "shortening, %"))
    masses = [mass for mass in lv.wall_mass_g if mass is not None]
    if masses:
        # From nothing on, or a hundredth would look like a beat.
        mass = over_time([line("wall", "#d99a1c", at, lv.wall_mass_g, "g")], across, "mass, g")
        mass["layout"]["yaxis"]["range"] = [0.0, round(1.2 * max(masses), 1)]
        note = "Muscle keeps its volume: what changes is error."
        yield Chart("Mass of the wall", note, mass)
    if not lv.wall_thickening_percent:
        return
    title = "Thickening by segment"
    yield Chart(
        title,
        f"Of the wall's mean thickness, from {cycle.ed_frame}, left ventricle.",
        segments_over_time(lv.wall_thickening_percent, at, across, "thickening", "%"),
    )
    frame = _end_systole(cycle)
    now = {n: x[frame] for n, x in lv.wall_thickening_percent.items()}
    known = {n: x for n, x in now.items() if x is not None}
    if known:
        said = {n: f"{n} {NAMES[n]}: {x:.1f} %" for n, x in known.items()}
        yield Chart(
            f"Thickening at {cycle.frames[frame]}",
            f"From {cycle.ed_frame}, percent; dark is little. Base outside, apex in the middle, "
            "seen from the apex.",
            bullseye(known, said, digits=0),
        )


def _strain(
    cycle: CycleReport, at: Sequence[float], across: str, not_observed: str
) -> Iterator[Chart]:
    strains = {
        s: one.area_strain_percent for s, one in cycle.surfaces.items() if one.area_strain_percent
    }
    note = f"Of the tracked meshes, from {cycle.ed_frame}. Line: mean; {_BAND} {not_observed}"
    figure = over_time(bands(strains, at, "%", middle="mean"), across, "area strain, %")
    yield Chart("Area strain", note, figure, broad=True)
    for structure, one in cycle.surfaces.items():
        if one.area_strain_by_segment_percent:
            yield Chart(
                f"Area strain by segment, {structure}",
                "Mean of each segment. How it is shared among them depends on motion that is not "
                "observed.",
                segments_over_time(
                    one.area_strain_by_segment_percent, at, across, "area strain", "%"
                ),
            )


def _curvature(cycle: CycleReport, at: Sequence[float], across: str) -> Iterator[Chart]:
    kinds = [
        (
            "Mean curvature",
            "1/mm",
            {s: one.mean_curvature_per_mm for s, one in cycle.surfaces.items()},
        ),
        (
            "Gaussian curvature",
            "1/mm²",
            {s: one.gaussian_curvature_per_mm2 for s, one in cycle.surfaces.items()},
        ),
    ]
    for title, unit, spreads in kinds:
        figure = over_time(bands(spreads, at, unit, middle="p50"), across, f"curvature, {unit}")
        yield Chart(title, f"Line: median; {_BAND}", figure)


def _end_systole(cycle: CycleReport) -> int:
    """The frame of the smallest cavity, or of no cavity the one half-way."""
    chamber = next(iter(cycle.chambers.values()), None)
    return cycle.frames.index(chamber.es_frame) if chamber else len(cycle.frames) // 2


def _known(values: Series) -> bool:
    return any(value is not None for value in values)
