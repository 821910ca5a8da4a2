"""A frame in 3D: its surfaces, the contours they were made of, and what they are held against."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from schemas.vocabulary import Axes, Structure
from worker.arrays import SomePoints
from worker.artifacts.measured import MeasuredFrame, MeasuredSurface
from worker.artifacts.page.colourings import Shown, colourings
from worker.artifacts.page.display_mesh import display_mesh, fields_at
from worker.artifacts.page.palette import CONTOUR_COLOURS, ENCLOSING, GREY, STRUCTURE_COLOURS
from worker.artifacts.page.thinned_line import thinned_line
from worker.artifacts.page.typed_arrays import coordinates, corners
from worker.surface_mesh import SurfaceMesh

_DIRECTIONS: Mapping[Axes, tuple[str, str, str]] = {
    Axes.LPS: ("left", "back", "head"),
    Axes.RAS: ("right", "front", "head"),
}

_CAMERAS: Mapping[Axes, tuple[float, float, float]] = {
    Axes.LPS: (0.82, -1.64, 0.64),
    Axes.RAS: (-0.82, 1.64, 0.64),
}
"""From the patient's front, a little from the left and from above."""

_LIGHT = {"ambient": 0.6, "diffuse": 0.55, "specular": 0.08, "roughness": 0.7, "fresnel": 0.05}
_LIGHT_AT = 5e4
"""Far behind the camera, so that no surface turns a black side to the reader."""


def scene(
    frame: MeasuredFrame, thinned: Mapping[Structure, SurfaceMesh], axes: Axes, triangles: int
) -> dict[str, Any]:
    """plotly's `data` and `layout` of the plain view, the `colourings` it can be given, and its
    `layers`: by structure, what there is of it, and as the how manieth of the data.

    thinned: every surface of the frame, no coarser than it is drawn. triangles: of each on the
    screen; references have half as many.
    """
    data: list[dict[str, Any]] = []
    layers: dict[Structure, dict[str, int]] = {}
    shown = []
    for structure, surface in frame.surfaces.items():
        mesh = display_mesh(thinned[structure], triangles)
        fields = fields_at(mesh, surface.mesh, surface.fields)
        shown.append(Shown(len(data), mesh.faces, fields))
        layers[structure] = {"surface": len(data)}
        data.append(_surface(structure, mesh, axes))
        if surface.residuals:
            layers[structure]["contours"] = len(data)
            data.append(_contours(structure, surface))
        if surface.reference is not None:
            layers[structure]["reference"] = len(data)
            mesh = display_mesh(surface.reference, triangles // 2)
            data.append(_reference(structure, mesh, axes))
    return {
        "data": data,
        "layout": layout(axes),
        "colourings": colourings(shown),
        "layers": layers,
    }


def look(structure: Structure, axes: Axes) -> dict[str, Any]:
    """plotly's trace of a surface, but for where it is."""
    role = "enclosing" if structure in ENCLOSING else "surface"
    return _mesh_look(axes) | {
        "name": structure.value,
        "color": STRUCTURE_COLOURS[structure],
        "meta": {"role": role},
    }


def _surface(structure: Structure, mesh: SurfaceMesh, axes: Axes) -> dict[str, Any]:
    return _mesh(mesh, axes) | look(structure, axes)


def _reference(structure: Structure, mesh: SurfaceMesh, axes: Axes) -> dict[str, Any]:
    return _mesh(mesh, axes) | {
        "name": f"{structure.value} reference",
        "color": GREY,
        "opacity": 0.4,
        "meta": {"role": "reference"},
    }


def _mesh(mesh: SurfaceMesh, axes: Axes) -> dict[str, Any]:
    return _mesh_look(axes) | coordinates(mesh.vertices_mm) | corners(mesh.faces)


def _mesh_look(axes: Axes) -> dict[str, Any]:
    x, y, z = _CAMERAS[axes]
    return {
        "type": "mesh3d",
        "lighting": _LIGHT,
        "lightposition": {"x": _LIGHT_AT * x, "y": _LIGHT_AT * y, "z": _LIGHT_AT * z},
        "hovertemplate": "%{x:.1f}, %{y:.1f}, %{z:.1f} mm%{text}<extra></extra>",
        "text": "",
    }


def _contours(structure: Structure, surface: MeasuredSurface) -> dict[str, Any]:
    lines = [thinned_line(_line(r.outline.points_mm, r.outline.closed)) for r in surface.residuals]
    return {
        "type": "scatter3d",
        "mode": "lines",
        **coordinates(_with_gaps(lines)),
        "line": {"color": CONTOUR_COLOURS[structure], "width": 4},
        "name": f"{structure.value} contours",
        "hoverinfo": "skip",
        "meta": {"role": "contours"},
    }


def _line(points_mm: SomePoints, closed: bool) -> SomePoints:
    return np.concatenate([points_mm, points_mm[:1]]) if closed else points_mm


def _with_gaps(lines: Sequence[SomePoints]) -> SomePoints:
    """One trace of many lines: NaN lifts the pen."""
    gap = np.full((1, 3), np.nan)
    return np.concatenate([part for line in lines for part in (line, gap)])


def layout(axes: Axes) -> dict[str, Any]:
    """plotly's, of any 3D view of the patient."""
    x, y, z = _CAMERAS[axes]
    sides = {
        f"{name}axis": {
            "title": {"text": f"{name}, mm, to the {direction}", "font": {"size": 11}},
            "tickfont": {"size": 10},
            "nticks": 5,
            "showbackground": False,
            "showspikes": False,
            "zeroline": False,
        }
        for name, direction in zip("xyz", _DIRECTIONS[axes], strict=True)
    }
    return {
        "scene": {
            **sides,
            "aspectmode": "data",
            # Looking a little below the middle, where the names of the axes are.
            "camera": {"eye": {"x": x, "y": y, "z": z}, "center": {"x": 0, "y": 0, "z": -0.1}},
            "dragmode": "orbit",
        },
        "margin": {"l": 0, "r": 0, "t": 0, "b": 0},
        "showlegend": False,
        "uirevision": "kept",
    }
