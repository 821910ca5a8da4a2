import re

import numpy as np

from schemas.vocabulary import Axes, Structure, View
from worker.artifacts.measured import MeasuredFrame, MeasuredSlice, MeasuredSurface
from worker.artifacts.page.overlays import Panel, panels
from worker.evaluation.residuals import Residuals
from worker.evaluation.support import AlignedOutline
from worker.phantom.analytic_heart import heart

ENDO = Structure.LV_ENDO
ACROSS = np.array([0.0, 1.0, 0.0])


def circle(radius_mm: float, x_mm: float = 0.0, points: int = 200) -> np.ndarray:
    """In the coronal plane through the origin."""
    angle = np.linspace(0.0, 2.0 * np.pi, points, endpoint=False)
    return np.column_stack(
        [x_mm + radius_mm * np.cos(angle), np.zeros(points), radius_mm * np.sin(angle)]
    )


def frame_of(*slices: MeasuredSlice, outlines: tuple[AlignedOutline, ...] = ()) -> MeasuredFrame:
    mesh = heart().meshes(5.0)[ENDO]
    residuals = [Residuals(one, np.zeros(len(one.points_mm))) for one in outlines]
    return MeasuredFrame("ED", {ENDO: MeasuredSurface(mesh, {}, residuals, None)}, slices)


def slice_of(
    name: str, *loops: np.ndarray, view: View = View.SAX, reference: tuple[np.ndarray, ...] = ()
) -> MeasuredSlice:
    return MeasuredSlice(name, view, np.zeros(3), ACROSS, {ENDO: loops}, {ENDO: reference})


def corners(path: str) -> np.ndarray:
    return np.array([[int(n) for n in pair.split()] for pair in re.split("[MLZ]", path) if pair])


def test_a_circle_keeps_its_place_and_size_in_tenths_of_a_millimetre() -> None:
    loop = circle(20.0, x_mm=5.0)
    (panel,) = panels(frame_of(slice_of("a", np.concatenate([loop, loop[:1]]))), Axes.LPS)
    (stroke,) = panel.strokes
    assert stroke.path.endswith("Z")
    points = corners(stroke.path)
    assert len(points) < 100  # thinned out
    radius = np.hypot(points[:, 0] - 50.0, points[:, 1])
    assert np.abs(radius - 200.0).max() < 1.5
    assert (panel.right_letters, panel.up_letters) == ("L", "H")


def test_a_panel_shows_its_own_contours_and_all_three_kinds() -> None:
    mine = AlignedOutline("a", View.SAX, circle(20.0), closed=True)
    open_one = AlignedOutline("a", View.SAX, circle(20.0)[:50], closed=False)
    others = AlignedOutline("b", View.SAX, circle(30.0), closed=True)
    one = slice_of("a", circle(19.0), reference=(circle(21.0),))
    (panel,) = panels(frame_of(one, outlines=(mine, open_one, others)), Axes.LPS)
    assert [s.kind for s in panel.strokes] == ["observed", "observed", "section", "reference"]
    assert [s.path.endswith("Z") for s in panel.strokes] == [True, False, False, False]


def test_every_line_is_inside_its_box() -> None:
    frame = frame_of(
        slice_of("a", circle(20.0)),
        slice_of("b", circle(10.0, x_mm=30.0)),
        slice_of("c", circle(15.0, x_mm=-90.0), view=View.LAX_2CH),
    )
    drawn = panels(frame, Axes.LPS)
    for panel in drawn:
        for stroke in panel.strokes:
            points = corners(stroke.path)
            assert (points >= [panel.left, panel.top]).all()
            assert (points <= [panel.left + panel.width, panel.top + panel.height]).all()
    assert box(drawn[0]) == box(drawn[1])  # the eye follows the heart through the stack


def test_a_slice_that_crosses_nothing_has_an_empty_panel() -> None:
    (alone,) = panels(frame_of(slice_of("a")), Axes.LPS)
    assert alone.strokes == ()
    assert alone.width > 0
    for view in (View.SAX, View.OTHER):
        first, _ = panels(frame_of(slice_of("a", circle(9.0)), slice_of("b", view=view)), Axes.RAS)
        assert first.strokes


def box(panel: Panel) -> tuple[int, int, int, int]:
    return panel.left, panel.top, panel.width, panel.height
