"""The player in a real browser: it moves when asked to, and frames are drawn when opened."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from schemas.vocabulary import Structure
from tests.worker.artifacts.page.chromium import Browser, Tab, browser
from tests.worker.artifacts.page.measured_cycle import measured_cycle
from worker.artifacts.measured import Measured
from worker.artifacts.page.html import render_html

pytestmark = pytest.mark.slow

DRAWN = "document.documentElement?.dataset.drawn === 'yes'"
COUNT = 6

SHOWN = """(() => {
  const canvas = document.getElementById('player-scene');
  return {
    x: canvas.data.map((trace) => Math.max(...trace.x)),
    visible: canvas.data.map((trace) => trace.visible),
    slider: Number(document.getElementById('player-frame').value),
    now: document.getElementById('player-now').textContent,
    said: document.getElementById('player-frame').getAttribute('aria-valuetext'),
    button: document.getElementById('player-play').textContent,
    marker: document.getElementById('cycle-chart0').layout.shapes[0].x0,
  };
})()"""


def wait_until(expression: str) -> str:
    return (
        "new Promise((done, fail) => { const ends = performance.now() + 60000;"
        f"const look = () => ({expression}) ? done(true)"
        " : performance.now() > ends ? fail(new Error('in vain')) : setTimeout(look, 20);"
        "look(); })"
    )


def go_to(frame: int) -> str:
    return f"""(async () => {{
      const drawn = new Promise((done) =>
        document.getElementById('player-scene').once('plotly_afterplot', done));
      const slider = document.getElementById('player-frame');
      slider.value = {frame};
      slider.dispatchEvent(new Event('input'));
      await drawn;
    }})()"""


@pytest.fixture(scope="module")
def chromium(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    with browser(tmp_path_factory.mktemp("profile")) as one:
        yield one


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("page") / "report.html"
    path.write_text(render_html(measured_cycle(COUNT)), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def opened(chromium: Browser, report: Path) -> Tab:
    """The report, as it is when it has been drawn."""
    tab = chromium.tab()
    tab.resize(900)
    tab.open(report.as_uri(), until=DRAWN)
    return tab


@pytest.fixture
def tab(opened: Tab, report: Path) -> Iterator[Tab]:
    """The same at its first frame; nothing fails in a test, and nothing is asked for."""
    if shown(opened)["slider"] != 0:
        opened.evaluate(go_to(0))
    yield opened
    assert opened.faults() == []
    assert opened.requests() == [report.as_uri()]


def with_gaps(measured: Measured) -> Measured:
    frames = list(measured.frames)
    left = {s: one for s, one in frames[2].surfaces.items() if s is not Structure.RV_ENDO}
    frames[2] = replace(frames[2], surfaces=left)
    whole = measured.tracked[Structure.LV_ENDO]
    kept = [n for n in range(COUNT) if n != 3]
    part = replace(
        whole,
        vertices_mm=whole.vertices_mm[kept],
        frames=tuple(whole.frames[n] for n in kept),
    )
    return replace(measured, frames=frames, tracked={Structure.LV_ENDO: part})


def shown(tab: Tab) -> dict[str, Any]:
    return dict(tab.evaluate(SHOWN))


def test_the_slider_moves_the_heart_and_the_marker(tab: Tab) -> None:
    first = shown(tab)
    assert first["slider"] == 0
    assert first["now"] == first["said"] == "F00, 0 ms"
    assert first["marker"] == 0
    for frame in (4, 5, 1):
        tab.evaluate(go_to(frame))
        then = shown(tab)
        # The tracked surface shrinks by 4 % a frame, about the origin.
        assert then["x"][0] == pytest.approx(first["x"][0] * 0.96**frame, rel=1e-3)
        assert then["x"][1] < first["x"][1], "the others have the frame's own mesh"
        assert then["now"] == then["said"] == f"F0{frame}, {40 * frame} ms"
        assert then["marker"] == 40 * frame


def test_it_plays_and_pauses_and_never_by_itself(tab: Tab) -> None:
    tab.evaluate("new Promise((done) => setTimeout(done, 500))")
    assert shown(tab)["slider"] == 0
    assert shown(tab)["button"] == "Play"
    # So slow that a screen drawn in software keeps up.
    tab.evaluate(
        """(() => {
          const speed = document.getElementById('player-speed');
          speed.value = '0.1';
          speed.dispatchEvent(new Event('input'));
          window.seen = new Set();
          const canvas = document.getElementById('player-scene');
          canvas.on('plotly_afterplot', () =>
            seen.add(document.getElementById('player-frame').value));
          document.getElementById('player-play').click();
        })()"""
    )
    assert shown(tab)["button"] == "Pause"
    tab.evaluate(wait_until(f"seen.size > 3 && seen.has('{COUNT - 1}') && seen.has('0')"))
    tab.evaluate("document.getElementById('player-play').click()")
    assert shown(tab)["button"] == "Play"
    stopped = tab.evaluate(
        "new Promise((done) => setTimeout(done, 700))"
        ".then(() => document.getElementById('player-frame').value)"
    )
    tab.evaluate("new Promise((done) => setTimeout(done, 700))")
    assert str(shown(tab)["slider"]) == stopped


def test_keys_play_it_and_step_through_it(tab: Tab) -> None:
    def press(key: str, text: str = "") -> None:
        for kind in ("keyDown", "keyUp"):
            tab.call(
                "Input.dispatchKeyEvent",
                type=kind,
                key=key,
                code=key,
                text=text if kind == "keyDown" else "",
                windowsVirtualKeyCode={"ArrowRight": 39, "Enter": 13}[key],
            )

    tab.call("Page.bringToFront")
    tab.evaluate("document.getElementById('player-frame').focus()")
    press("ArrowRight")
    press("ArrowRight")
    tab.evaluate(wait_until("document.getElementById('player-now').textContent === 'F02, 80 ms'"))
    tab.evaluate("document.getElementById('player-play').focus()")
    press("Enter", "\r")
    tab.evaluate(wait_until("document.getElementById('player-play').textContent === 'Pause'"))
    press("Enter", "\r")
    tab.evaluate(wait_until("document.getElementById('player-play').textContent === 'Play'"))


def test_every_control_has_a_name(tab: Tab) -> None:
    names = tab.evaluate(
        """[...document.querySelectorAll('.player > :is(div, fieldset) :is(input, select, button)')]
          .filter((one) => !one.closest('.canvas'))
          .map((one) => (one.labels[0] ?? one).textContent.trim().split(/\\s/)[0])"""
    )
    assert names == ["Play", "Frame", "Speed", "lv_endo", "lv_epi", "rv_endo", "Opacity"]


def test_surfaces_are_switched_off_and_stay_so(tab: Tab) -> None:
    tab.evaluate(
        """(async () => {
          const drawn = new Promise((done) =>
            document.getElementById('player-scene').once('plotly_afterplot', done));
          const box = document.querySelector('#player [data-surface="1"]');
          box.checked = false;
          box.dispatchEvent(new Event('input'));
          await drawn;
        })()"""
    )
    assert shown(tab)["visible"] == [True, False, True]
    tab.evaluate(go_to(3))
    assert shown(tab)["visible"] == [True, False, True]
    tab.evaluate(
        """(() => {
          const box = document.querySelector('#player [data-surface="1"]');
          box.checked = true;
          box.dispatchEvent(new Event('input'));
        })()"""
    )


EYE = "document.getElementById('player-scene')._fullLayout.scene._scene.getCamera().eye"


def drag(tab: Tab, *, between: str = "0") -> None:
    """Turn the heart by the mouse."""
    tab.call("Page.bringToFront")
    tab.evaluate("document.getElementById('player-scene').scrollIntoView({block: 'center'})")
    x, y = tab.evaluate(
        "(({x, y, width, height}) => [x + width / 2, y + height / 2])"
        "(document.getElementById('player-scene').getBoundingClientRect())"
    )
    button = {"button": "left", "buttons": 1, "clickCount": 1}
    tab.call("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)
    tab.call("Input.dispatchMouseEvent", type="mousePressed", x=x, y=y, **button)
    for step in range(1, 4):
        tab.call("Input.dispatchMouseEvent", type="mouseMoved", x=x + 30 * step, y=y, **button)
        tab.evaluate(between)
    tab.call("Input.dispatchMouseEvent", type="mouseReleased", x=x + 100, y=y, **button)
    tab.evaluate("new Promise((done) => setTimeout(done, 300))")


def test_the_reader_s_view_stays_while_frames_change(tab: Tab) -> None:
    first = tab.evaluate(EYE)
    drag(tab)
    turned = tab.evaluate(EYE)
    assert abs(turned["x"] - first["x"]) > 0.2
    tab.evaluate(go_to(4))
    assert tab.evaluate(EYE) == pytest.approx(turned, abs=1e-6)


def test_it_can_be_turned_while_it_plays(tab: Tab) -> None:
    first = tab.evaluate(EYE)
    tab.evaluate("document.getElementById('player-play').click()")
    drag(tab, between="new Promise((done) => setTimeout(done, 200))")
    tab.evaluate("new Promise((done) => setTimeout(done, 500))")
    tab.evaluate("document.getElementById('player-play').click()")
    assert abs(tab.evaluate(EYE)["x"] - first["x"]) > 0.2


def test_a_frame_is_drawn_when_it_is_opened(tab: Tab) -> None:
    scenes = "document.querySelectorAll('[data-scene] canvas').length"
    charts = "document.querySelectorAll('details.frame [data-chart] .trace').length"
    assert tab.evaluate(scenes) == 0
    assert tab.evaluate(charts) == 0
    tab.evaluate("location.hash = '#frame2', 0")
    tab.evaluate(wait_until("document.getElementById('frame2').dataset.drawn === 'yes'"))
    assert tab.evaluate("document.getElementById('frame2').open")
    assert tab.evaluate(scenes) == 1
    assert tab.evaluate(charts) > 0


def test_it_draws_again_where_the_dark_begins(tab: Tab) -> None:
    tab.evaluate(go_to(2))
    dark = [{"name": "prefers-color-scheme", "value": "dark"}]
    tab.call("Emulation.setEmulatedMedia", features=dark)
    ink = "document.getElementById('player-scene')._fullLayout.font.color"
    tab.evaluate(wait_until(f"{ink} === '#dddddd'"))
    tab.evaluate(
        wait_until("document.getElementById('cycle-chart0').layout.font.color === '#dddddd'")
    )
    assert shown(tab)["marker"] == 80
    tab.call("Emulation.setEmulatedMedia", features=[])


@pytest.mark.parametrize("width", [390, 320, 1200])
def test_nothing_sticks_out_at_the_side(tab: Tab, width: int) -> None:
    tab.resize(width)
    tab.evaluate("new Promise(done => requestAnimationFrame(() => setTimeout(done, 300)))")
    assert tab.evaluate("document.documentElement.scrollWidth") <= width


def test_on_paper_there_is_a_picture_of_the_heart(tab: Tab) -> None:
    tab.evaluate("dispatchEvent(new Event('beforeprint')), 0")
    tab.call("Emulation.setEmulatedMedia", media="print")
    shown_there = "getComputedStyle(document.querySelector('#player .still')).display"
    assert tab.evaluate(shown_there) == "block"
    assert tab.evaluate("document.querySelector('#player .still').naturalWidth") > 0
    assert (
        tab.evaluate("document.querySelectorAll('details.frame:not([open])').length") >= COUNT - 1
    )
    tab.call("Emulation.setEmulatedMedia", media="")


def test_a_surface_is_hidden_in_frames_that_lack_it_and_it_is_said(
    chromium: Browser, tmp_path: Path
) -> None:
    """F02 lacks the right ventricle, F03 the tracked left one. The last test: its tab covers the
    other, where nothing plays any more.
    """
    path = tmp_path / "report.html"
    path.write_text(render_html(with_gaps(measured_cycle(COUNT))), encoding="utf-8")
    tab = chromium.tab()
    tab.open(path.as_uri(), until=DRAWN)
    seen = {}
    for frame in (1, 2, 3, 4):
        tab.evaluate(go_to(frame))
        seen[frame] = shown(tab)
    assert seen[1]["visible"] == seen[4]["visible"] == [True] * 3
    assert [one["visible"].count(False) for one in seen.values()] == [0, 1, 1, 0]
    assert seen[2]["now"] == seen[2]["said"] == "F02, 80 ms, no rv_endo"
    assert seen[3]["now"] == seen[3]["said"] == "F03, 120 ms, no lv_endo"
    assert seen[4]["now"] == "F04, 160 ms"
    assert tab.faults() == []
