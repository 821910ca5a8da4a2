"""The catalogue of bad contour studies: what is sent, and the one answer it must get."""

import json
from collections.abc import Callable
from typing import Any, NamedTuple

from schemas.problem import ProblemType
from tests.studies.ellipsoid import Json, ellipse, good_request

T = ProblemType


class BadStudy(NamedTuple):
    """The body of one submission, and the problem it must be answered with."""

    name: str
    raw: bytes
    type: ProblemType
    status: int
    pointer: str | None


FRAME = "/study/frames/0"
SLICES = f"{FRAME}/slices"
LV_ENDO, LV_EPI, RV_ENDO = 0, 1, 2


def slice_of(request: Json, index: int) -> Json:
    """Slice `index` of the first frame; 0 to 4 are short-axis, 5 is long-axis."""
    found: Json = request["study"]["frames"][0]["slices"][index]
    return found


def contour(request: Json, slice_: int, which: int) -> Json:
    found: Json = slice_of(request, slice_)["contours"][which]
    return found


def scaled(request: Json, factor: float) -> None:
    for s in request["study"]["frames"][0]["slices"]:
        s["origin"] = [v * factor for v in s["origin"]]
        for c in s["contours"]:
            c["points"] = [[v * factor for v in p] for p in c["points"]]


def body(request: Json) -> bytes:
    return json.dumps(request).encode()


def changed(change: Callable[[Json], Any]) -> bytes:
    """The good request after one change."""
    request = good_request()
    change(request)
    return body(request)


def with_text(old: str, new: str) -> bytes:
    """The good request with a piece of its JSON text exchanged, once."""
    text = json.dumps(good_request())
    assert text.count(old) >= 1
    return text.replace(old, new, 1).encode("utf-8", "surrogatepass")


def with_coordinate(literal: str) -> bytes:
    """The good request with `literal` as z of point 3 of the first contour."""
    request = good_request()
    contour(request, 0, LV_ENDO)["points"][3][2] = "HERE"
    return json.dumps(request).replace('"HERE"', literal).encode()


# One fault each, on the good request.


def metres_called_mm(r: Json) -> None:
    scaled(r, 1e-3)


def micrometres_called_mm(r: Json) -> None:
    scaled(r, 1e3)


def millimetres_called_m(r: Json) -> None:
    r["study"]["units"] = "m"


def pixels_of_nothing(r: Json) -> None:
    scaled(r, 1e-9)


def stray_point(r: Json) -> None:
    contour(r, 1, LV_EPI)["points"][7] = [0.0, 5e6, -12.0]


def open_loop(r: Json) -> None:
    del contour(r, 2, RV_ENDO)["points"][25:]


def figure_of_eight(r: Json) -> None:
    points = contour(r, 2, LV_ENDO)["points"]
    points[10:30] = points[10:30][::-1]


def eight_through_a_point(r: Json) -> None:
    centre = [0.0, 0.0, 0.0]
    right = [[10.0, -8.0, 0.0], [18.0, 0.0, 0.0], [10.0, 8.0, 0.0]]
    left = [[-10.0, -8.0, 0.0], [-18.0, 0.0, 0.0], [-10.0, 8.0, 0.0]]
    contour(r, 2, LV_ENDO)["points"] = [centre, *right, centre, *left]


def wound_twice(r: Json) -> None:
    contour(r, 2, LV_EPI)["points"] *= 2


def crossing_open(r: Json) -> None:
    loop = contour(r, 2, LV_ENDO)
    loop["closed"] = False
    loop["points"] = [[-30.0, 0.1, 0.0], *loop["points"][:35], [-30.0, 10.0, 0.0]]


def point_off_plane(r: Json) -> None:
    contour(r, 3, LV_EPI)["points"][17][2] += 4.0


def origin_of_another_slice(r: Json) -> None:
    slice_of(r, 1)["origin"] = [0.0, 0.0, 0.0]


def tilted_normal(r: Json) -> None:
    slice_of(r, 0)["normal"] = [0.0, 0.6, 0.8]


def two_planes_in_one_slice(r: Json) -> None:
    both = slice_of(r, 0)
    del both["origin"], both["normal"]
    both["contours"] += slice_of(r, 1)["contours"][:1]
    for p in both["contours"][-1]["points"]:
        p[0] -= 50.0


def one_slice(r: Json) -> None:
    del r["study"]["frames"][0]["slices"][1:]


def coincident_planes(r: Json) -> None:
    slices = r["study"]["frames"][0]["slices"]
    slices[:] = [slices[2], {**slices[2], "id": "again", "normal": [0.0, 0.0, -2.0]}]


def one_plane_a_structure(r: Json) -> None:
    slices = r["study"]["frames"][0]["slices"]
    del slices[2:]
    slices[0]["contours"] = slices[0]["contours"][:1]
    slices[1]["contours"] = slices[1]["contours"][1:]


def only_absent(r: Json) -> None:
    for s in r["study"]["frames"][0]["slices"]:
        s["contours"], s["absent"] = [], ["lv_endo"]


def empty_second_frame(r: Json) -> None:
    only = {"id": "a", "contours": contour_list(r)[:1]}
    r["study"]["frames"].append({"label": "ES", "slices": [only]})


def contour_list(r: Json) -> list[Json]:
    found: list[Json] = slice_of(r, 2)["contours"]
    return found


def other_heart_on_same_plane(r: Json) -> None:
    points = ellipse((25.0, 25.0, 0.0), [15.0, 0.0, 0.0], [0.0, 15.0, 0.0])
    again = {"id": "again", "contours": [{"structure": "lv_endo", "points": points}]}
    r["study"]["frames"][0]["slices"].append(again)


def absent_where_outlined(r: Json) -> None:
    again = {"id": "again", "origin": [9.0, 9.0, 12.0], "normal": [0, 0, 3], "absent": ["rv_endo"]}
    r["study"]["frames"][0]["slices"].append(again)


def long_axis_in_ras(r: Json) -> None:
    for c in slice_of(r, 5)["contours"]:
        # The left ventricle stands off the axis of rotation, as in any scanner.
        c["points"] = [[-x - 75.0, -y, z] for x, y, z in c["points"]]


def endo_outside_epi(r: Json) -> None:
    for p in contour(r, 2, LV_ENDO)["points"]:
        p[0] += 25.0


def endo_and_epi_swapped(r: Json) -> None:
    for s in r["study"]["frames"][0]["slices"]:
        s["contours"][LV_ENDO]["structure"] = "lv_epi"
        s["contours"][LV_EPI]["structure"] = "lv_endo"


def rv_over_lv(r: Json) -> None:
    for p in contour(r, 2, RV_ENDO)["points"]:
        p[0] += 30.0


def epi_as_a_ring(r: Json) -> None:
    for s in r["study"]["frames"][0]["slices"]:
        s["contours"].append({**s["contours"][LV_ENDO], "structure": "lv_epi"})


def same_contour_twice(r: Json) -> None:
    contour_list(r).append(contour_list(r)[LV_ENDO])


def two_readers(r: Json) -> None:
    moved = [[x + 15.0, y, z] for x, y, z in contour(r, 2, LV_ENDO)["points"]]
    contour_list(r).append({"structure": "lv_endo", "points": moved})


def all_points_equal(r: Json) -> None:
    contour(r, 2, LV_ENDO)["points"] = [[1.0, 2.0, 0.0]] * 12


def two_distinct_points(r: Json) -> None:
    contour(r, 2, LV_ENDO)["points"] = [[1.0, 2.0, 0.0], [5.0, 2.0, 0.0], [1.0, 2.0, 0.0]]


def collinear(r: Json) -> None:
    contour(r, 2, LV_ENDO)["points"] = [[float(k), 2.0 * k, 0.0] for k in range(12)]


def collinear_without_plane(r: Json) -> None:
    line = {"structure": "lv_endo", "points": [[float(k), 2.0 * k, 50.0] for k in range(12)]}
    r["study"]["frames"][0]["slices"].append({"id": "line", "contours": [line]})


def there_and_back(r: Json) -> None:
    points = contour(r, 2, LV_ENDO)["points"][:16]
    contour(r, 2, LV_ENDO)["points"] = points + points[-2:0:-1]


def too_many_in_one_contour(r: Json) -> None:
    contour(r, 2, LV_ENDO)["points"] *= 200


def too_many_points(r: Json) -> None:
    piece = {"structure": "lv_endo", "points": [[0, 0, 0]] * 5000}
    contour_list(r).extend([piece] * 61)


def too_many_slices(r: Json) -> None:
    slices = r["study"]["frames"][0]["slices"]
    flat = {"origin": [0, 0, 0], "normal": [0, 0, 1], "absent": ["epi"]}
    slices.extend({"id": f"s{k}", **flat} for k in range(300))


def too_many_frames(r: Json) -> None:
    frame = {"slices": [{"id": "a", "origin": [0, 0, 0], "normal": [0, 0, 1], "absent": ["epi"]}]}
    r["study"]["frames"] = [{"label": f"t{k}", **frame} for k in range(65)]


def set_in(*path: Any, to: Any) -> bytes:
    """The good request with one member, reached by `path`, set."""

    def change(request: Json) -> None:
        place: Any = request
        for step in path[:-1]:
            place = place[step]
        place[path[-1]] = to

    return changed(change)


def without(*path: Any) -> bytes:
    """The good request with one member left out."""

    def change(request: Json) -> None:
        place: Any = request
        for step in path[:-1]:
            place = place[step]
        del place[path[-1]]

    return changed(change)


def _in_slice(index: int, key: str, to: Any) -> bytes:
    return set_in("study", "frames", 0, "slices", index, key, to=to)


def _options(**options: Any) -> bytes:
    return set_in("options", to=options)


def _two_frames(first: str, second: str) -> bytes:
    frame = good_request()["study"]["frames"][0]
    return set_in("study", "frames", to=[{**frame, "label": first}, {**frame, "label": second}])


_SYNTAX = [
    ("empty body", b""),
    ("not JSON", b"subject,x,y,z\n1,2,3,4\n"),
    ("truncated", body(good_request())[:-200]),
    ("trailing comma", with_text('"units": "mm",', '"units": "mm",,')),
    ("something after the end", body(good_request()) + b"{}"),
    ("duplicate key", with_text('"units": "mm"', '"units": "mm", "units": "cm"')),
    ("byte order mark", b"\xef\xbb\xbf" + body(good_request())),
    ("UTF-16", json.dumps(good_request()).encode("utf-16")),
    ("Latin-1", with_text('"ellipsoid"', '"Müller"').decode().encode("latin-1")),
    ("NaN", with_coordinate("NaN")),
    ("Infinity", with_coordinate("Infinity")),
    ("minus Infinity", with_coordinate("-Infinity")),
    ("integer of 5000 digits", with_coordinate("1" * 5000)),
    ("lone surrogate", with_text('"ellipsoid"', '"\\ud800"')),
    ("control character", with_text('"ellipsoid"', '"a\x00b"')),
]

_SCHEMA = [
    ("top-level list", b"[]", ""),
    ("top-level null", b"null", ""),
    ("bare study without envelope", body(good_request()["study"]), "/study"),
    ("study missing", without("study"), "/study"),
    ("units missing", without("study", "units"), "/study/units"),
    ("axes missing", without("study", "axes"), "/study/axes"),
    ("unknown units", set_in("study", "units", to="inch"), "/study/units"),
    ("unknown axes", set_in("study", "axes", to="LAS"), "/study/axes"),
    (
        "subject id with slash",
        set_in("study", "subject_id", to="../etc/passwd"),
        "/study/subject_id",
    ),
    ("subject id empty", set_in("study", "subject_id", to=""), "/study/subject_id"),
    ("subject id with newline", set_in("study", "subject_id", to="a\n"), "/study/subject_id"),
    ("subject id of 65 letters", set_in("study", "subject_id", to="a" * 65), "/study/subject_id"),
    ("unknown key", set_in("study", "colour", to="red"), "/study/colour"),
    ("unknown key to be escaped", set_in("study", "a/b~c", to=1), "/study/a~1b~0c"),
    ("empty frames", set_in("study", "frames", to=[]), "/study/frames"),
    ("empty slices", set_in("study", "frames", 0, "slices", to=[]), SLICES),
    ("duplicate frame labels", _two_frames("ED", "ED"), "/study"),
    ("frame labels differ in case", _two_frames("ED", "ed"), "/study"),
    ("duplicate slice ids", _in_slice(1, "id", "sax-00"), FRAME),
    ("slice ids differ in case", _in_slice(1, "id", "SAX-00"), FRAME),
    ("unknown view", _in_slice(0, "view", "coronal"), f"{SLICES}/0/view"),
    ("slice says nothing", _in_slice(0, "contours", []), f"{SLICES}/0"),
    ("contour and absent both", _in_slice(1, "absent", ["lv_endo"]), f"{SLICES}/1"),
    ("origin without normal", without("study", "frames", 0, "slices", 2, "normal"), f"{SLICES}/2"),
    ("normal without origin", without("study", "frames", 0, "slices", 2, "origin"), f"{SLICES}/2"),
    ("zero normal", _in_slice(3, "normal", [0, 0, 0]), f"{SLICES}/3"),
    ("normal of two numbers", _in_slice(3, "normal", [0, 1]), f"{SLICES}/3/normal/2"),
    ("negative time", set_in("study", "frames", 0, "time_ms", to=-1), f"{FRAME}/time_ms"),
    (
        "unknown structure",
        set_in("study", "frames", 0, "slices", 0, "contours", 0, "structure", to="atrium"),
        f"{SLICES}/0/contours/0/structure",
    ),
    (
        "two-point contour",
        set_in("study", "frames", 0, "slices", 0, "contours", 0, "points", to=[[0, 0, 0]] * 2),
        f"{SLICES}/0/contours/0/points",
    ),
    (
        "points in two dimensions",
        set_in("study", "frames", 0, "slices", 0, "contours", 0, "points", 3, to=[1.0, 2.0]),
        f"{SLICES}/0/contours/0/points/3/2",
    ),
    ("coordinate as text", with_coordinate('"1.5"'), f"{SLICES}/0/contours/0/points/3/2"),
    ("coordinate null", with_coordinate("null"), f"{SLICES}/0/contours/0/points/3/2"),
    ("coordinate true", with_coordinate("true"), f"{SLICES}/0/contours/0/points/3/2"),
    ("coordinate 1e400", with_coordinate("1e400"), f"{SLICES}/0/contours/0/points/3/2"),
    ("coordinate 1e8", with_coordinate("1e8"), f"{SLICES}/0/contours/0/points/3/2"),
    ("unknown option", _options(colour="red"), "/options/colour"),
    ("negative levels", _options(levels=-1), "/options/levels"),
    ("too many levels", _options(levels=9), "/options/levels"),
    ("levels as text", _options(levels="6"), "/options/levels"),
    ("levels as fraction", _options(levels=2.5), "/options/levels"),
    ("endless iterations", _options(iterations_per_level=10**9), "/options/iterations_per_level"),
    ("huge network", _options(network={"width": 10**6}), "/options/network/width"),
    ("unknown preset", _options(preset="best"), "/options/preset"),
    ("preset as list", _options(preset=[]), "/options/preset"),
    ("unknown format", _options(formats=["dwg"]), "/options/formats/0"),
    ("no format", _options(formats=[]), "/options/formats"),
    ("unknown surface", _options(surfaces=["la_endo"]), "/options/surfaces/0"),
    ("options as list", set_in("options", to=[]), "/options"),
]

_CONTENT = [
    (T.IMPLAUSIBLE_SIZE, metres_called_mm, "/study/units"),
    (T.IMPLAUSIBLE_SIZE, micrometres_called_mm, "/study/units"),
    (T.IMPLAUSIBLE_SIZE, millimetres_called_m, "/study/units"),
    (T.IMPLAUSIBLE_SIZE, pixels_of_nothing, "/study/units"),
    (T.IMPLAUSIBLE_SIZE, stray_point, f"{SLICES}/1/contours/1/points/7"),
    (T.UNCLOSED_CONTOUR, open_loop, f"{SLICES}/2/contours/2"),
    (T.SELF_CROSSING_CONTOUR, figure_of_eight, f"{SLICES}/2/contours/0/points/9"),
    (T.SELF_CROSSING_CONTOUR, eight_through_a_point, f"{SLICES}/2/contours/0"),
    (T.SELF_CROSSING_CONTOUR, wound_twice, f"{SLICES}/2/contours/1"),
    (T.SELF_CROSSING_CONTOUR, crossing_open, f"{SLICES}/2/contours/0/points/0"),
    (T.SELF_CROSSING_CONTOUR, two_readers, f"{SLICES}/2/contours/3"),
    (T.OFF_PLANE_POINTS, point_off_plane, f"{SLICES}/3/contours/1/points/17"),
    (T.OFF_PLANE_POINTS, origin_of_another_slice, f"{SLICES}/1/contours/0/points/0"),
    (T.OFF_PLANE_POINTS, tilted_normal, f"{SLICES}/0/contours/0/points/10"),
    (T.OFF_PLANE_POINTS, two_planes_in_one_slice, f"{SLICES}/0/contours/0/points/20"),
    (T.TOO_FEW_SLICES, one_slice, SLICES),
    (T.TOO_FEW_SLICES, coincident_planes, SLICES),
    (T.TOO_FEW_SLICES, one_plane_a_structure, SLICES),
    (T.TOO_FEW_SLICES, only_absent, SLICES),
    (T.TOO_FEW_SLICES, empty_second_frame, "/study/frames/1/slices"),
    (T.CONTRADICTING_SLICES, other_heart_on_same_plane, f"{SLICES}/6"),
    (T.CONTRADICTING_SLICES, absent_where_outlined, f"{SLICES}/6"),
    (T.CONTRADICTING_SLICES, long_axis_in_ras, f"{SLICES}/5"),
    (T.CROSSING_STRUCTURES, endo_outside_epi, f"{SLICES}/2/contours/0"),
    (T.CROSSING_STRUCTURES, endo_and_epi_swapped, f"{SLICES}/0/contours/1"),
    (T.CROSSING_STRUCTURES, rv_over_lv, f"{SLICES}/2/contours/0"),
    (T.CROSSING_STRUCTURES, epi_as_a_ring, f"{SLICES}/0/contours/0"),
    (T.DEGENERATE_CONTOUR, same_contour_twice, f"{SLICES}/2/contours/3"),
    (T.DEGENERATE_CONTOUR, all_points_equal, f"{SLICES}/2/contours/0"),
    (T.DEGENERATE_CONTOUR, two_distinct_points, f"{SLICES}/2/contours/0"),
    (T.DEGENERATE_CONTOUR, collinear, f"{SLICES}/2/contours/0"),
    (T.DEGENERATE_CONTOUR, collinear_without_plane, f"{SLICES}/6/contours/0"),
    (T.DEGENERATE_CONTOUR, there_and_back, f"{SLICES}/2/contours/0"),
]

_SIZE = [
    (
        "too many points in one contour",
        changed(too_many_in_one_contour),
        f"{SLICES}/2/contours/0/points",
    ),
    ("too many points", changed(too_many_points), "/study/frames"),
    ("too many slices", changed(too_many_slices), SLICES),
    ("too many frames", changed(too_many_frames), "/study/frames"),
    ("nested too deep", b'{"study":' * 1000 + b"1" + b"}" * 1000, None),
    ("brackets without end", b"[" * 100_000, None),
    ("more values than any study", b"[" + b"0," * 2_000_001 + b"0]", None),
    ("thousands of keys", json.dumps({f"k{k}": 0 for k in range(1001)}).encode(), None),
]

BAD_STUDIES: list[BadStudy] = [
    *(BadStudy(name, raw, T.MALFORMED_JSON, 400, None) for name, raw in _SYNTAX),
    *(BadStudy(name, raw, T.INVALID_REQUEST, 422, at) for name, raw, at in _SCHEMA),
    *(
        BadStudy(change.__name__.replace("_", " "), changed(change), type_, 422, at)
        for type_, change, at in _CONTENT
    ),
    *(
        BadStudy(
            f"surface {surface} requested but not observed",
            _options(surfaces=["lv_endo", surface]),
            T.UNSUPPORTED_SURFACE,
            422,
            "/options/surfaces/1",
        )
        for surface in ("rv_epi", "epi")
    ),
    *(BadStudy(name, raw, T.TOO_LARGE, 413, at) for name, raw, at in _SIZE),
]
"""Every entry is refused with exactly this type, status and pointer."""
