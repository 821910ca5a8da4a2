"""cvi42 workspaces: pixels of images, placed by headers or by a table."""

import contextlib
import json
import tracemalloc
from collections.abc import Mapping

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from intake.formats import cvi42_xml
from intake.formats.cvi42 import read_cvi42
from intake.formats.image_geometry import ImageGeometry
from intake.limits import Limits
from intake.planes import Plane
from intake.study import admit
from schemas.options import Options
from schemas.problem import InputError
from schemas.study import ContourStudy
from schemas.vocabulary import Structure, View
from tests.intake.formats.clinical_bytes import image, workspace
from tests.intake.formats.same_study import assert_on_planes, assert_same_outlines

NAMES = {Structure.LV_ENDO: "endo", Structure.LV_EPI: "epi", Structure.RV_ENDO: "rvendo"}
SPACING = (1.5, 1.25)


def uid(frame: int, slice_: int) -> str:
    return f"1.2.{frame + 1}.{slice_ + 1}"


def key(structure: Structure, view: View) -> str:
    side = "rv" if structure is Structure.RV_ENDO else ""
    layer = "epi" if structure is Structure.LV_EPI else "endo"
    return f"{'sa' if view is View.SAX else 'la'}{side}{layer}cardialContour"


def drawn(study: ContourStudy) -> tuple[dict[str, dict[str, np.ndarray]], dict[str, ImageGeometry]]:
    """What cvi42 would hold of the study, and where its images lie."""
    contours: dict[str, dict[str, np.ndarray]] = {}
    images: dict[str, ImageGeometry] = {}
    for f, frame in enumerate(study.frames):
        for s, slice_ in enumerate(frame.slices):
            plane = Plane.through(np.array(slice_.origin), np.array(slice_.normal))
            position = plane.origin - 150 * plane.u - 140 * plane.v
            images[uid(f, s)] = ImageGeometry(
                position, plane.u, plane.v, SPACING, temporal_position=10 * f + 1
            )
            held = contours.setdefault(uid(f, s), {})
            for c in slice_.contours:
                away = np.array(c.points) - position
                pixels = np.stack(
                    [away @ plane.u / SPACING[1], away @ plane.v / SPACING[0]], axis=1
                )
                held[key(c.structure, slice_.view)] = pixels
    return contours, images


def headers(images: Mapping[str, ImageGeometry]) -> dict[str, bytes]:
    return {f"{name}.dcm": image(name, at) for name, at in images.items()}


def table(images: Mapping[str, ImageGeometry], **more: object) -> bytes:
    entries = [
        {
            "uid": name,
            "position": at.position_mm.tolist(),
            "orientation": [*at.row.tolist(), *at.column.tolist()],
            "spacing": at.spacing_mm,
            "temporal_position": at.temporal_position,
            **more,
        }
        for name, at in images.items()
    ]
    return json.dumps({"images": entries}).encode()


def csv_table(images: Mapping[str, ImageGeometry]) -> bytes:
    lines = ["uid, position, orientation, spacing, temporal_position"]
    for name, at in images.items():
        vectors = (at.position_mm, (*at.row, *at.column), at.spacing_mm)
        cells = ["\\".join(map(str, vector)) for vector in vectors]
        lines.append(", ".join([name, *cells, str(at.temporal_position)]))
    return "\r\n".join(lines).encode()


def flat(n: int = 3) -> dict[str, ImageGeometry]:
    """`n` images on a tilted stack."""
    row, column = np.array([1.0, 0, 0]), np.array([0, 0.6, 0.8])
    return {
        uid(0, i): ImageGeometry(8.0 * i * np.array([0, -0.8, 0.6]), row, column, SPACING)
        for i in range(n)
    }


def circle(radius: float = 20.0, points: int = 30) -> np.ndarray:
    angle = np.linspace(0, 2 * np.pi, points, endpoint=False)
    return 60 + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def refusal(files: dict[str, bytes], limits: Limits | None = None) -> InputError:
    with pytest.raises(InputError) as raised:
        read_cvi42(files, limits=limits or Limits())
    assert "Remedy: " in raised.value.detail
    return raised.value


@pytest.mark.parametrize("kind", ["headers", "json", "csv"])
def test_a_study_comes_back(beat: ContourStudy, kind: str) -> None:
    contours, images = drawn(beat)
    said = {
        "headers": lambda: headers(images),
        "json": lambda: {"images": table(images)},
        "csv": lambda: {"images": csv_table(images)},
    }[kind]()
    imported = read_cvi42({"x.cvi42wsx": workspace(contours), **said})
    assert [f.label for f in imported.study.frames] == ["t01", "t11"]
    opened = [
        s.model_copy(
            update={
                "contours": [
                    c.model_copy(update={"closed": s.view is View.SAX}) for c in s.contours
                ]
            }
        )
        for f in beat.frames
        for s in f.slices
    ]
    count = len(beat.frames[0].slices)
    expected = beat.model_copy(
        update={
            "frames": [
                f.model_copy(update={"slices": part})
                for f, part in zip(beat.frames, (opened[:count], opened[count:]), strict=True)
            ]
        }
    )
    assert_same_outlines(imported.study, expected, 1e-4)
    assert_on_planes(imported.study, 1e-3)
    assert [s.view for s in imported.study.frames[0].slices].count(View.SAX) == 11
    admit(imported.study, Options())


@pytest.mark.parametrize("subpixels", [1, 4, 8])
def test_points_are_divided_by_the_subpixel_resolution(subpixels: int) -> None:
    files = {"w": workspace({uid(0, 0): {"saendocardialContour": circle()}}, subpixels)}
    imported = read_cvi42({**files, "t": table(flat(1))})
    (contour,) = imported.study.frames[0].slices[0].contours
    points = np.array(contour.points)
    # x goes along the row with the spacing between columns, y down the column.
    assert np.ptp(points[:, 0]) == pytest.approx(40 * 1.25, rel=1e-2)
    assert np.ptp(points[:, 2]) == pytest.approx(40 * 1.5 * 0.8, rel=1e-2)


def test_no_subpixel_resolution_is_said() -> None:
    files = {"w": workspace({uid(0, 0): {"saendocardialContour": circle()}}, None)}
    assert "SubpixelResolution" in " ".join(read_cvi42({**files, "t": table(flat(1))}).warnings)


def test_names_are_structures_and_open_where_they_say() -> None:
    held = {
        "saendocardialContour": circle(10),
        "saepicardialOpenContour": circle(14)[:20],
        "sarvendocardialContour0002": circle(8) + np.array([40, 0]),
        "sarvepicardialContour": circle(10) + np.array([40, 0]),
        "sapapilMuscContour": circle(2),
    }
    imported = read_cvi42({"w": workspace({uid(0, 0): held}), "t": table(flat(1))})
    (slice_,) = imported.study.frames[0].slices
    assert {(c.structure, c.closed) for c in slice_.contours} == {
        (Structure.LV_ENDO, True),
        (Structure.LV_EPI, False),
        (Structure.RV_ENDO, True),
        (Structure.RV_EPI, True),
    }
    assert "'sapapilMuscContour'" in " ".join(imported.warnings)
    assert slice_.view is View.SAX


def test_a_long_axis_contour_does_not_come_back_to_its_start() -> None:
    points = circle()
    held = {"laendocardialContour": np.concatenate([points, points[:1]])}
    imported = read_cvi42({"w": workspace({uid(0, 0): held}), "t": table(flat(1), view="lax_2ch")})
    (slice_,) = imported.study.frames[0].slices
    assert (slice_.id, slice_.view) == ("lax_2ch", View.LAX_2CH)
    assert not slice_.contours[0].closed
    assert len(slice_.contours[0].points) == len(points)


def test_images_of_unknown_geometry_are_counted_and_none_known_is_refused() -> None:
    held = {uid(0, i): {"saendocardialContour": circle()} for i in range(5)}
    files = {"w": workspace(held)}
    imported = read_cvi42({**files, "t": table(flat(3))})
    assert len(imported.study.frames[0].slices) == 3
    assert "2 contours on 2 images" in " ".join(imported.warnings)
    assert "5 images" in refusal(files).detail
    assert "geometry" in refusal(files).detail


def test_nothing_of_the_patient_comes_in() -> None:
    files = {"w": workspace({uid(0, 0): {"saendocardialContour": circle()}}), **headers(flat(1))}
    imported = read_cvi42(files)
    assert "Doe" not in imported.study.model_dump_json() + " ".join(imported.warnings)


GOOD = workspace({uid(0, 0): {"saendocardialContour": circle()}})
TABLE = table(flat(1))
BOMB = b"""<?xml version="1.0"?><!DOCTYPE w [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;">]>
<w>&b;</w>"""


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (BOMB, "document type"),
        (b'<!DOCTYPE w SYSTEM "http://127.0.0.1:1/w.dtd"><w/>', "document type"),
        (b"<w/>", "ImageStates"),
        (b"<w>", "line 1"),
        (GOOD[: len(GOOD) // 2], "not well-formed"),
        (b"<w>" + b"\0" * 50, "not well-formed"),
        (b'<?xml version="1.0" encoding="no-such"?><w/>', "encoding"),
        (b'<?xml version="1.0" encoding="shift_jis"?><w/>', "encoding"),
        (GOOD.replace(b">4<", b">0<"), "SubpixelResolution"),
        (GOOD.replace(b">4<", b">nan<"), "SubpixelResolution"),
        (GOOD.replace(b"saendo", b"sxendo"), "no contours of the ventricles"),
        (b"<a>" * 100, "64 deep"),
        (b"PK\x03\x04", "no cvi42 workspace"),
        (b"", "no cvi42 workspace"),
    ],
)
def test_what_is_no_workspace(data: bytes, words: str) -> None:
    assert words in refusal({"w": data, "t": TABLE}).detail


@pytest.mark.parametrize("value", [b"nan", b"inf", b"1e9", b"", b"zero", b"9" * 5000])
def test_coordinates_that_are_no_finite_numbers(value: bytes) -> None:
    first = GOOD.index(b"320.0")
    error = refusal({"w": GOOD[:first] + value + GOOD[first + 5 :], "t": TABLE})
    assert "finite" in error.detail
    assert error.pointer == "w"


def test_pixels_that_are_kilometres_away() -> None:
    assert "kilometres" in refusal({"w": GOOD.replace(b">4<", b">1e-9<"), "t": TABLE}).detail


def test_a_point_without_its_other_half() -> None:
    start = GOOD.index(b":x>320.0")
    before = GOOD.rindex(b"<", 0, start)
    end = GOOD.index(b">", start + 8) + 1
    assert "without x or y" in refusal({"w": GOOD[:before] + GOOD[end:], "t": TABLE}).detail


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (TABLE.replace(b"1.5", b"-1.5"), "spacing"),
        (TABLE.replace(b"0.6, 0.8", b"0.9, 0.8"), "orientation"),
        (b'{"images": []}', "images"),
        (b'{"images": [{"uid": "1"}]}', "position"),
        (b"[1, 2", "JSON"),
        (b"uid,position,orientation,spacing\n1.2,0 0 0,1 0 0 0 1 0,1\n", "`spacing` on line 2"),
        (b"uid,position,orientation,spacing,name\n", "columns"),
        (b"uid,position,orientation,spacing\n\xff", "UTF-8"),
        (b"uid;position\n", "neither"),
    ],
)
def test_what_is_no_table(data: bytes, words: str) -> None:
    error = refusal({"w": GOOD, "t": data})
    assert words in error.detail
    assert error.pointer == "t"


def test_many_elements_cost_little_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cvi42_xml, "MAX_ELEMENTS", 200_000)
    data = b"<w>" + b"<a/>" * (8 << 20)
    tracemalloc.start()
    error = refusal({"w": data, "t": TABLE})
    assert tracemalloc.get_traced_memory()[1] < 4 << 20
    tracemalloc.stop()
    assert error.status == 413


@pytest.mark.parametrize("value", [b"1", b">"])
def test_many_attributes_are_found_before_they_are_read(value: bytes) -> None:
    attributes = b" ".join(b'a%d="%s"' % (i, value) for i in range(20_000))
    assert "attributes" in refusal({"w": b"<w " + attributes + b"/>", "t": TABLE}).detail


def test_more_than_the_limits() -> None:
    assert refusal({"w": GOOD, "t": TABLE}, Limits(max_points=20)).status == 413
    assert refusal({"w": GOOD, "t": TABLE}, Limits(max_points=2)).status == 413


@settings(max_examples=100, deadline=None)
@given(st.data())
def test_any_change_of_bytes_is_read_or_refused(data: st.DataObject) -> None:
    changed = bytearray(GOOD[: data.draw(st.integers(0, len(GOOD)))])
    for _ in range(data.draw(st.integers(0, 4)) if changed else 0):
        changed[data.draw(st.integers(0, len(changed) - 1))] = data.draw(st.integers(0, 255))
    with contextlib.suppress(InputError):
        assert read_cvi42({"w": bytes(changed), "t": TABLE}).study.frames


def test_nothing_is_fetched_or_expanded_in_utf_16() -> None:
    assert "document type" in refusal({"w": BOMB.decode().encode("utf-16"), "t": TABLE}).detail
