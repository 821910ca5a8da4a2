"""The heart in motion: what the player of the page draws."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from schemas.vocabulary import Axes, Structure
from worker.artifacts.frame_times import FrameTimes
from worker.artifacts.moving_surface import MovingSurface
from worker.artifacts.page.frame_page import FramePage
from worker.artifacts.page.scene import layout, look
from worker.artifacts.page.thinned_motion import thinned_motion
from worker.artifacts.page.typed_arrays import corners, stepped

_MOST, _OF_ALL_FRAMES = 6_000, 150_000
_MARGIN_MM = 4.0


def cycle_scene(
    surfaces: Sequence[MovingSurface], times: FrameTimes, frames: Sequence[FramePage], axes: Axes
) -> dict[str, Any]:
    """`frames`: label, time in words and place on the charts' axis of each, `seconds` and
    `period_s`; plotly's `layout`, with ranges that hold all frames; and `surfaces`: each has its
    `trace` without a place, the `shown` frames that it has, and either `positions`, of all of these
    one after the other as x, y, z planes, or `own`: the scene and trace where each is drawn.
    """
    points = np.concatenate([mesh.vertices_mm for one in surfaces for mesh in one.meshes])
    low, high = points.min(axis=0) - _MARGIN_MM, points.max(axis=0) + _MARGIN_MM
    drawn = layout(axes)
    for name, start, end in zip("xyz", low.tolist(), high.tolist(), strict=True):
        drawn["scene"][f"{name}axis"]["range"] = [round(start, 1), round(end, 1)]
    by_label = {page.report.label: page for page in frames}
    return {
        "frames": [
            {"label": label, "said": said, "at": at}
            for label, said, at in zip(times.labels, _said(times), times.steps, strict=True)
        ],
        "seconds": [round(s, 6) for s in times.seconds],
        "period_s": round(times.period_s, 6),
        "layout": drawn,
        "surfaces": [_surface(one, times, by_label, axes) for one in surfaces],
    }


def _said(times: FrameTimes) -> list[str]:
    if times.times_ms is None:
        at = zip(times.labels, times.places, strict=True)
        return [f"{label}, {place + 1} of {times.count}" for label, place in at]
    return [f"{label}, {t:g} ms" for label, t in zip(times.labels, times.times_ms, strict=True)]


def _surface(
    moving: MovingSurface, times: FrameTimes, frames: Mapping[str, FramePage], axes: Axes
) -> dict[str, Any]:
    # No hover: it would have to be found anew in every frame.
    trace = look(moving.structure, axes) | {"hoverinfo": "skip"}
    del trace["hovertemplate"], trace["text"]
    about = {"structure": moving.structure.value, "shown": list(moving.frames)}
    if not moving.is_tracked:
        own = [_place(frames[times.labels[n]], moving.structure) for n in moving.frames]
        return {**about, "trace": trace, "own": own}
    triangles = min(_MOST, _OF_ALL_FRAMES // len(moving.frames))
    positions, faces = thinned_motion(moving.meshes, triangles)
    planes = np.moveaxis(positions, 2, 1)
    return {**about, "trace": trace | corners(faces), "positions": stepped(planes)}


def _place(page: FramePage, structure: Structure) -> dict[str, Any]:
    """Nothing twice: a frame's own mesh is in the page already."""
    return {"scene": f"{page.id}-scene", "trace": page.scene["layers"][structure]["surface"]}
