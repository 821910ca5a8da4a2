"""`report.html`: the report and its figures as one page that needs no network and no other file."""

import math
import re
from collections.abc import Mapping, Sequence
from importlib.resources import files
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

from schemas.frame_report import FrameReport
from schemas.job import Progress, Stage
from schemas.vocabulary import Axes, Structure
from worker.artifacts.display_meshes import DisplayMeshes, display_meshes
from worker.artifacts.measured import Measured, MeasuredFrame
from worker.artifacts.page.charts import charts
from worker.artifacts.page.cycle_page import CyclePage, cycle_page
from worker.artifacts.page.display_mesh import triangles_a_surface
from worker.artifacts.page.frame_page import FramePage
from worker.artifacts.page.overlays import panels
from worker.artifacts.page.palette import STRUCTURE_COLOURS
from worker.artifacts.page.scene import scene
from worker.artifacts.page.script_json import script_json
from worker.checkpoints import Checkpoints, Unkept
from worker.crew import Alone, Crew, Part
from worker.observer import Cancelled, Observer, Unobserved
from worker.surface_mesh import SurfaceMesh

_CODE = re.compile("`([^`]*)`")

_PAGES = Environment(
    loader=PackageLoader("worker.artifacts.page"),
    autoescape=True,
    undefined=StrictUndefined,
    trim_blocks=True,
    lstrip_blocks=True,
)
_PAGES.filters["length_of"] = lambda vector: math.hypot(*vector)
_PAGES.filters["with_code"] = lambda text: _with_code(text)


def render_html(
    measured: Measured,
    observer: Observer | None = None,
    crew: Crew | None = None,
    thinned: DisplayMeshes | None = None,
) -> str:
    """The page: every text in it escaped, numbers rounded for reading, the same for the same input.

    Tables and slice panels are plain HTML; 3D views and charts are drawn by plotly.js, which is in
    the page, once. crew: who draws the frames. thinned: where other files have them too. Raises
    Cancelled when the observer asks to stop.
    """
    # Loaded here: it is of no use to a process that renders nothing.
    from plotly.offline import get_plotlyjs

    if thinned is None:
        thinned = display_meshes(measured, observer, crew)
    report = measured.report
    most = triangles_a_surface(len(measured.frames))
    weight = report.options.loss.hinge_weight
    reports = {frame.label: frame for frame in report.frames}
    parts = [
        Part(
            _drawn,
            (
                f"frame{number}",
                reports[frame.label],
                frame,
                thinned[frame.label],
                report.axes,
                weight,
                most,
            ),
        )
        for number, frame in enumerate(measured.frames)
    ]
    frames: list[FramePage] = (crew or Alone()).all_of(parts, observer or Unobserved(), Unkept())
    cycle = cycle_page(measured, frames)
    return _PAGES.get_template("page.html.j2").render(
        report=report,
        frames=frames,
        cycle=cycle,
        figures=script_json(_figures(frames, cycle)),
        colours=STRUCTURE_COLOURS,
        plotly=_script(get_plotlyjs()),
        script=_script((_beside("cycle.js") if cycle else "") + _beside("page.js")),
        style=Markup(_beside("page.css")),  # noqa: S704  our own file
    )


def _drawn(
    id_: str,
    frame_report: FrameReport,
    frame: MeasuredFrame,
    thinned: Mapping[Structure, SurfaceMesh],
    axes: Axes,
    hinge_weight: float,
    triangles: int,
    observer: Observer,
    _: Checkpoints,
) -> FramePage:
    if observer.is_cancelled():
        raise Cancelled
    observer.advanced(Progress(stage=Stage.WRITING, frame=frame.label))
    return FramePage(
        id=id_,
        report=frame_report,
        scene=scene(frame, thinned, axes, triangles),
        charts=charts(frame_report, frame, hinge_weight),
        panels=panels(frame, axes),
    )


def _figures(frames: Sequence[FramePage], cycle: CyclePage | None) -> dict[str, Any]:
    """By the id of the element that each is drawn in, and what the player draws."""
    owners: list[CyclePage | FramePage] = [*([cycle] if cycle else []), *frames]
    return {
        "scenes": {f"{one.id}-scene": one.scene for one in frames},
        "charts": {
            f"{one.id}-chart{number}": chart.figure
            for one in owners
            for number, chart in enumerate(one.charts)
        },
        "cycle": cycle.scene if cycle else None,
    }


def _script(text: str) -> Markup:
    """A program of our own or of plotly, which must not end the element that it stands in."""
    return Markup(text.replace("</script", "<\\/script").replace("<!--", "<\\!--"))  # noqa: S704  ours


def _beside(name: str) -> str:
    return files("worker.artifacts.page").joinpath(name).read_text(encoding="utf-8")


def _with_code(text: str) -> Markup:
    """Messages write `names` as in Markdown; what is between backticks is escaped like all else."""
    return Markup(_CODE.sub(r"<code>\1</code>", str(escape(text))))  # noqa: S704  escaped
