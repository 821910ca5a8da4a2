"""The page in a real browser: it draws, reaches nothing, and fits a phone and a sheet of paper."""

import base64
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest

from service.routes.artifacts import _SANDBOX
from tests.worker.artifacts.page.chromium import Browser, Tab, browser
from tests.worker.artifacts.page.measured_phantom import measured_phantom
from worker.artifacts.page.html import render_html

pytestmark = pytest.mark.slow

DRAWN = "document.documentElement?.dataset.drawn === 'yes'"
LOADED = "document.readyState === 'complete'"
CHARTS_A_FRAME = 8


@pytest.fixture(scope="module")
def chromium(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    with browser(tmp_path_factory.mktemp("profile")) as one:
        yield one


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("page") / "report.html"
    path.write_text(render_html(measured_phantom(("ED", "ES"), edge_mm=5.0)), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def tab(chromium: Browser, report: Path) -> Tab:
    """The report, drawn on a phone."""
    tab = chromium.tab()
    tab.resize(390)
    tab.open(report.as_uri(), until=DRAWN)
    return tab


@contextmanager
def served(page: str) -> Iterator[str]:
    """The address of a page that comes with the headers that the service sends with reports."""

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            body = page.encode()
            self.send_response(200)
            self.send_header("Content-Type", "text/html; charset=utf-8")
            self.send_header("Content-Security-Policy", _SANDBOX)
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, *_: object) -> None:
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            yield f"http://127.0.0.1:{server.server_port}/report.html"
        finally:
            server.shutdown()
            thread.join()


def test_every_figure_is_drawn(tab: Tab) -> None:
    assert tab.faults() == []
    assert tab.evaluate("document.querySelectorAll('[data-scene] canvas').length") == 2
    drawn = "[...document.querySelectorAll('[data-chart]')].filter(f => f.querySelector('.trace'))"
    assert tab.evaluate(f"{drawn}.length") == 2 * CHARTS_A_FRAME


def test_a_surface_is_seen_in_3d(tab: Tab) -> None:
    """A blank picture has one colour."""
    colours = tab.evaluate(
        """(async () => {
          const picture = document.querySelector('[data-scene] .still');
          await picture.decode();
          const pen = new OffscreenCanvas(60, 60).getContext('2d');
          pen.drawImage(picture, 0, 0, 60, 60);
          return new Set(new Uint32Array(pen.getImageData(0, 0, 60, 60).data.buffer)).size;
        })()"""
    )
    assert colours > 100


def test_every_colour_of_the_menu_can_be_chosen_and_layers_be_hidden(tab: Tab) -> None:
    names = tab.evaluate(
        """(async () => {
          const frame = document.querySelector('[data-scene]');
          const canvas = frame.querySelector('.canvas');
          const redrawn = (control) => new Promise((done) => {
            canvas.once('plotly_afterplot', done);
            control.dispatchEvent(new Event('input'));
          });
          const menu = frame.querySelector('select');
          const titles = [];
          for (const [index, option] of [...menu.options].entries()) {
            menu.selectedIndex = index;
            await redrawn(menu);
            const bar = canvas.layout.coloraxis?.colorbar.title.text ?? '';
            titles.push([option.label, bar, frame.querySelector('.hint').textContent !== '']);
          }
          const box = frame.querySelector('[data-trace="0"]');
          box.checked = false;
          await redrawn(box);
          titles.push(canvas.data.map((trace) => trace.visible));
          return titles;
        })()"""
    )
    *titles, visible = names
    assert titles[0] == ["one for each surface", "", False]
    assert len(titles) == 9
    for label, bar, hint in titles[1:]:
        assert bar.startswith(label)
        assert hint
    # Surface, contours and reference of three structures; the first surface was just hidden.
    assert visible == [False, True, False] + [True, True, False] * 2
    assert tab.faults() == []


def test_nothing_but_the_file_is_asked_for(tab: Tab, report: Path) -> None:
    assert tab.requests() == [report.as_uri()]


@pytest.mark.parametrize("width", [390, 320, 1200])
def test_nothing_sticks_out_at_the_side(tab: Tab, width: int) -> None:
    tab.resize(width)
    tab.evaluate("new Promise(done => requestAnimationFrame(() => setTimeout(done, 300)))")
    assert tab.evaluate("document.documentElement.scrollWidth") <= width


def test_on_paper_figures_are_pictures_and_everything_is_unfolded(tab: Tab) -> None:
    assert tab.evaluate("document.querySelectorAll('details[open]').length") == 0
    printed = tab.call("Page.printToPDF", preferCSSPageSize=True)
    assert base64.b64decode(printed["data"]).startswith(b"%PDF")
    assert tab.evaluate("document.querySelectorAll('details[open]').length") == 0
    tab.evaluate("dispatchEvent(new Event('beforeprint')), 0")
    tab.call("Emulation.setEmulatedMedia", media="print")
    assert tab.evaluate("document.querySelectorAll('details:not([open])').length") == 0
    shown = "getComputedStyle(one).display !== 'none'"
    count = f"(name) => [...document.querySelectorAll(name)].filter(one => {shown}).length"
    assert tab.evaluate(f"({count})('.still')") == 2 + 2 * CHARTS_A_FRAME
    assert tab.evaluate(f"({count})('.canvas')") == 0
    pictures = "[...document.querySelectorAll('.still')].every(one => one.naturalWidth > 0)"
    assert tab.evaluate(pictures)
    tab.call("Emulation.setEmulatedMedia", media="")


def test_it_draws_under_the_policy_of_the_service(chromium: Browser, report: Path) -> None:
    tab = chromium.tab()
    with served(report.read_text(encoding="utf-8")) as address:
        tab.open(address, until=DRAWN)
        assert tab.faults() == []
        assert tab.requests() == [address]


def test_tables_and_slices_are_there_without_a_script(chromium: Browser, report: Path) -> None:
    tab = chromium.tab()
    tab.call("Emulation.setScriptExecutionDisabled", value=True)
    tab.open(report.as_uri(), until=LOADED)
    shown = "[...document.querySelectorAll(name)].filter(one => one.getClientRects().length).length"
    count = f"(name) => {shown}"
    assert tab.evaluate(f"({count})('.panel svg')") > 20
    assert tab.evaluate(f"({count})('.scripted')") == 0
    assert tab.evaluate(f"({count})('header noscript')") == 1


LEAKS = [
    "<img src='http://127.0.0.1:9/x.png'>",
    "<script>fetch('http://127.0.0.1:9/x').catch(() => {})</script>",
    "<style>body { background: url(https://example.org/x.png) }</style>",
]


@pytest.mark.parametrize("leak", LEAKS)
def test_a_page_that_asks_for_something_is_found_out(
    chromium: Browser, tmp_path: Path, leak: str
) -> None:
    path = tmp_path / "leaky.html"
    path.write_text(f"<!doctype html><body>{leak}here</body>", encoding="utf-8")
    tab = chromium.tab()
    tab.open(path.as_uri(), until=LOADED)
    tab.evaluate("new Promise(done => setTimeout(done, 300))")
    assert len(tab.requests()) == 2


WORKER = """<script>
new Worker(URL.createObjectURL(new Blob(["fetch('http://127.0.0.1:9/x')"])));
</script>"""


@pytest.mark.parametrize("leak", [*LEAKS, WORKER, "<script>eval('1')</script>"])
def test_the_policy_forbids_it_and_that_is_found_out(chromium: Browser, leak: str) -> None:
    tab = chromium.tab()
    with served(f"<!doctype html><link rel=icon href='data:,'><body>{leak}here</body>") as address:
        tab.open(address, until=LOADED)
        tab.evaluate("new Promise(done => setTimeout(done, 300))")
        assert any("Content Security Policy" in fault for fault in tab.faults())
