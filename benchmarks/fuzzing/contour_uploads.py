"""Submissions of contours, spoilt: in the document, in its text, in its bytes, on the wire."""

import copy
import json
import math
from collections.abc import Callable, Iterator
from typing import Any

from hypothesis import strategies as st

from benchmarks.fuzzing.seeds import contour_requests
from benchmarks.fuzzing.upload import Framing, Upload

PATH = "/v1/jobs/contours"

Document = Any
Draw = Callable[[st.SearchStrategy[Any]], Any]

_ODD_NUMBERS = (
    *(0, -0.0, 1, -1, 0.5, 1e-300, 5e-324, 1e-9, 1e7, -1e7, 1e9, 1e308, -1e308, 2**31, 2**53 + 1),
    *(2**63, 10**30, 400.0, 1e3, math.pi),
)
_ODD_TEXTS = (
    *("", " ", "ED", "../../etc/passwd", "a/b", "a\x00b", "%2e%2e%2f", "x" * 65, "x" * 5000),
    *("é", "\u202e", "\ud83d\ude00", "\ud800", "\r\nX: y", "__proto__", "constructor", "NaN"),
    *("lv_endo", "<script>", "{{7*7}}", "${jndi:ldap://x}", "-", ".", "..", "con"),
)
_ODD_VALUES: tuple[Any, ...] = (None, True, False, [], {}, [[]], [None], {"a": 1})
_RAW_NUMBERS = (
    *(
        "NaN",
        "Infinity",
        "-Infinity",
        "1e309",
        "-1e999",
        "1" * 5000,
        "0x10",
        "01",
        "+1",
        "1.",
        ".5",
    ),
    *("1e-400", "1E+2", "-0", "--1", "1_000", '"1"'),
)
_HERE = "\u0001HERE\u0001"


def contour_uploads() -> st.SearchStrategy[Upload]:
    """Any spoilt submission; one in some hundred is as good as it was."""
    contour_requests()  # made here, for making them is no part of a draw
    return _uploads()


@st.composite
def _uploads(draw: Draw) -> Upload:
    document = copy.deepcopy(draw(st.sampled_from(contour_requests())))
    faults: list[str] = []
    for _ in range(draw(st.integers(0, 3))):
        faults.append(_spoil(draw, document))
    text = _text(draw, document, faults)
    body = _bytes(draw, text.encode("utf-8", "surrogatepass"), faults)
    headers = {"Content-Type": "application/json"}
    if draw(st.integers(0, 30)) == 0:
        coding = draw(st.sampled_from(["gzip", "deflate", "br", "identity", "gzip, gzip", "x"]))
        headers["Content-Encoding"] = coding
        faults.append(f"encoded {coding}")
    framing = Framing.LENGTH
    if draw(st.integers(0, 9)) == 0:
        framing = draw(st.sampled_from(Framing))
        faults.append(framing.value)
    return Upload(PATH, body, headers, framing, tuple(faults))


def _spoil(draw: Draw, document: Document) -> str:
    """One change of the document, in place; its name."""
    change: Callable[[Draw, Document], None] = draw(st.sampled_from(_CHANGES))
    change(draw, document)
    return str(change.__name__.strip("_"))


def _value(draw: Draw, document: Document) -> None:
    """Anything in the place of anything."""
    holder, key = _place(draw, document)
    odd = (*_ODD_NUMBERS, *_ODD_TEXTS, *_ODD_VALUES)
    holder[key] = copy.deepcopy(draw(st.sampled_from(odd)))


def _number(draw: Draw, document: Document) -> None:
    """Another number in the place of a coordinate or an option."""
    point = _point(draw, document)
    number = draw(st.one_of(st.sampled_from(_ODD_NUMBERS), st.floats(-500, 500)))
    point[draw(st.integers(0, len(point) - 1))] = number


def _removal(draw: Draw, document: Document) -> None:
    holder, key = _place(draw, document)
    del holder[key]


def _repetition(draw: Draw, document: Document) -> None:
    holder, key = _place(draw, document)
    if isinstance(holder, list):
        holder[key:key] = [copy.deepcopy(holder[key])] * draw(st.sampled_from([1, 2, 10, 100]))


def _unknown_key(draw: Draw, document: Document) -> None:
    holder, _ = _place(draw, document)
    if isinstance(holder, dict):
        holder[draw(st.sampled_from(_ODD_TEXTS))] = draw(st.sampled_from(_ODD_VALUES))


def _exchange(draw: Draw, document: Document) -> None:
    """Two places of one list change their contents: valid, and another study."""
    holder, key = _place(draw, document)
    if isinstance(holder, list):
        other = draw(st.integers(0, len(holder) - 1))
        holder[key], holder[other] = holder[other], holder[key]


def _polygon(draw: Draw, document: Document) -> None:
    """A contour as it should not be: a line, a point, a star, a spike, a zigzag, half of itself."""
    contour = _contour(draw, document)
    points = contour["points"]
    shape = draw(st.sampled_from(["point", "line", "half", "reversed", "shuffled", "star", "few"]))
    shapes: dict[str, Callable[[], Any]] = {
        "point": lambda: [points[0]] * len(points),
        "line": lambda: [points[0], points[len(points) // 2]] * 4,
        "half": lambda: points[: len(points) // 2],
        "reversed": lambda: points[::-1],
        "shuffled": lambda: draw(st.permutations(points)),
        "star": lambda: points[::2] + points[1::2],
        "few": lambda: points[: draw(st.integers(0, 4))],
    }
    contour["points"] = shapes[shape]()
    if draw(st.booleans()):
        contour["closed"] = draw(st.booleans())


def _movement(draw: Draw, document: Document) -> None:
    """A contour moved and scaled: plausible, or not quite."""
    contour = _contour(draw, document)
    by = draw(st.tuples(*[st.sampled_from([0.0, 0.3, 3.0, -10.0, 60.0])] * 3))
    factor = draw(st.sampled_from([1.0, 0.999, 0.7, 1.3, 1e-3, 20.0]))
    contour["points"] = [
        [factor * v + d for v, d in zip(p, by, strict=True)] for p in contour["points"]
    ]


def _many(draw: Draw, document: Document) -> None:
    """Thousands of contours, or of points."""
    contour = _contour(draw, document)
    slices = [s for s in _objects(document) if isinstance(s.get("contours"), list)]
    if slices and draw(st.booleans()):
        slices[0]["contours"] = [contour] * draw(st.sampled_from([300, 5001]))
    else:
        contour["points"] = contour["points"] * draw(st.sampled_from([100, 500]))


def _dropped_slices(draw: Draw, document: Document) -> None:
    """Some of the slices alone."""
    for frame in _objects(document):
        if isinstance(slices := frame.get("slices"), list) and slices:
            kept = draw(st.sets(st.integers(0, len(slices) - 1)))
            frame["slices"] = [slices[k] for k in sorted(kept)]


def _option(draw: Draw, document: Document) -> None:
    """Another choice of what to make."""
    name, values = draw(st.sampled_from(list(_OPTIONS.items())))
    if isinstance(options := document.get("options"), dict):
        options[name] = draw(st.sampled_from(values))


_OPTIONS: dict[str, list[Any]] = {
    "base": ["open", "closed"],
    "surfaces": [["lv_endo"], ["epi"], ["rv_endo", "rv_endo"], ["rv_epi"], []],
    "align_slices": [True, False],
    "ensemble": [0, 1, 2],
    "holdout": ["none", "leave_one_slice_out"],
    "target_edge_mm": [0.5, 3.0, 50.0, None],
    "formats": [["stl", "obj", "ply", "vtp", "glb"], []],
    "seed": [0, 2**63 - 1, 2**64, -1],
    "mesh": [{"grid_mm": 0.01}, {"grid_mm": 10.0}, {"grid_mm": 4.0, "projection_steps": 0}],
    "levels": [0, 1, 2, 99],
    "compare_with": [["variational"], ["nearest"], ["x"]],
}

_CHANGES = (
    *(_value, _number, _number, _removal, _repetition, _unknown_key, _exchange, _polygon),
    *(_polygon, _movement, _movement, _many, _dropped_slices, _option, _option),
)


def _place(draw: Draw, document: Document) -> tuple[Any, Any]:
    """A holder and a key in it, at any depth."""
    holder, key = {"": document}, ""
    while (
        isinstance(holder[key], dict | list)
        and holder[key]
        and (holder[key] is document or draw(st.integers(0, 5)))
    ):
        holder = holder[key]
        keys = sorted(holder) if isinstance(holder, dict) else range(len(holder))
        key = draw(st.sampled_from(keys))
    return holder, key


def _contour(draw: Draw, document: Document) -> dict[str, Any]:
    """One of the study's contours; one of nowhere where an earlier change left none whole."""
    sound = [contour for contour in _objects(document) if _is_sound(contour)]
    nowhere = {"points": [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]}
    return sound[draw(st.integers(0, len(sound) - 1))] if sound else nowhere


def _objects(value: Any) -> Iterator[dict[str, Any]]:
    """Every object in a document, from the outside in."""
    if isinstance(value, dict):
        yield value
        for member in value.values():
            yield from _objects(member)
    elif isinstance(value, list) and not _is_point(value[0] if value else None):
        for member in value:
            yield from _objects(member)


def _is_sound(contour: dict[str, Any]) -> bool:
    points = contour.get("points")
    return isinstance(points, list) and bool(points) and all(map(_is_point, points))


def _is_point(value: Any) -> bool:
    return isinstance(value, list) and len(value) == 3 and all(type(v) is float for v in value)


def _point(draw: Draw, document: Document) -> list[Any]:
    points: list[list[Any]] = _contour(draw, document)["points"]
    return points[draw(st.integers(0, len(points) - 1))]


def _text(draw: Draw, document: Document, faults: list[str]) -> str:
    """The document as JSON, now and then with what no JSON library writes."""
    fault = draw(st.sampled_from([""] * 12 + ["raw number", "twice", "nested", "prefix", "suffix"]))
    if fault:
        faults.append(fault)
    if fault == "raw number":
        _point(draw, document)[0] = _HERE
    text = json.dumps(document, ensure_ascii=draw(st.booleans()))
    match fault:
        case "raw number":
            return text.replace(json.dumps(_HERE), draw(st.sampled_from(_RAW_NUMBERS)))
        case "twice":
            return text.replace('"study":', '"study": 1, "study":', 1)
        case "nested":
            depth = draw(st.sampled_from([31, 33, 1000, 100_000]))
            return text.replace('"study":', '"study":' + "[" * depth, 1)
        case "prefix":
            return draw(st.sampled_from(["\ufeff", " \n", "//x\n", ")]}'", "\x00"])) + text
        case "suffix":
            return text + draw(st.sampled_from([" ", "{}", ",", "\x00", "]", text]))
    return text


def _bytes(draw: Draw, body: bytes, faults: list[str]) -> bytes:
    """The bytes, now and then damaged."""
    fault = draw(st.sampled_from([""] * 12 + ["truncated", "flipped", "inserted", "utf-16"]))
    if not fault or not body:
        return body
    faults.append(fault)
    at = draw(st.integers(0, len(body) - 1))
    match fault:
        case "truncated":
            return body[:at]
        case "flipped":
            return body[:at] + bytes([body[at] ^ draw(st.integers(1, 255))]) + body[at + 1 :]
        case "inserted":
            return body[:at] + draw(st.binary(min_size=1, max_size=8)) + body[at:]
    return body.decode("utf-8", "surrogatepass").encode("utf-16", "surrogatepass")
