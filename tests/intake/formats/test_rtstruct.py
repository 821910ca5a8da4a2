"""RT Structure Sets: what is written comes back, and what is not sure is said."""

from pathlib import Path

import numpy as np
import pytest
from pydicom.data import get_testdata_file
from pydicom.uid import (
    DeflatedExplicitVRLittleEndian,
    ExplicitVRLittleEndian,
    ImplicitVRLittleEndian,
)

from intake.formats.image_geometry import ImageGeometry
from intake.formats.rtstruct import read_rtstruct
from intake.study import admit
from schemas.options import Options
from schemas.problem import InputError
from schemas.study import ContourStudy
from schemas.vocabulary import Structure, View
from tests.intake.formats.clinical_bytes import contour, image, rois_of, rtstruct
from tests.intake.formats.same_study import assert_on_planes, assert_same_outlines

SUFFIX = {"ED": "_ED", "ES": " (end-systole)"}
SYNTAXES = [ImplicitVRLittleEndian, ExplicitVRLittleEndian, DeflatedExplicitVRLittleEndian]


def ring(z: float = 0.0, radius: float = 20.0, x: float = 0.0, points: int = 24) -> np.ndarray:
    angle = np.linspace(0, 2 * np.pi, points, endpoint=False)
    return np.stack([x + radius * np.cos(angle), radius * np.sin(angle), 0 * angle + z], axis=1)


def tilted(points: np.ndarray) -> np.ndarray:
    """Turned out of the body's planes, as a heart is."""
    c, s = np.cos(0.8), np.sin(0.8)
    return points @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]]).T


def stack(heights: list[float], image: str = "") -> list:
    return [
        contour(tilted(ring(z)), image=f"{image}{i}" if image else "")
        for i, z in enumerate(heights)
    ]


def at(uid_number: int, **time: float) -> ImageGeometry:
    directions = tilted(np.array([[1.0, 0, 0], [0, 1, 0]]))
    return ImageGeometry(
        tilted(np.array([[-50.0, -50, 8 * uid_number]]))[0], *directions, (1.0, 1.0), **time
    )


def refused(files: dict[str, bytes], **given: object) -> str:
    with pytest.raises(InputError) as raised:
        read_rtstruct(files, **given)
    assert "Remedy: " in raised.value.detail
    return raised.value.detail


@pytest.mark.parametrize("syntax", SYNTAXES)
def test_a_study_comes_back(beat: ContourStudy, syntax: str) -> None:
    imported = read_rtstruct({"a": rtstruct(rois_of(beat, SUFFIX), syntax)})
    assert [f.label for f in imported.study.frames] == ["ED", "ES"]
    assert_same_outlines(imported.study, beat, 1e-5)
    assert_on_planes(imported.study, 1e-3)
    admit(imported.study, Options())


def test_planes_are_shared_by_frames_and_views_told(beat: ContourStudy) -> None:
    imported = read_rtstruct({"a": rtstruct(rois_of(beat, SUFFIX))})
    ed, es = ({s.id: s for s in f.slices} for f in imported.study.frames)
    assert set(es) <= set(ed)
    assert all(es[name].origin == ed[name].origin for name in es)
    views = [s.view for s in ed.values()]
    assert views.count(View.SAX) == 11
    assert views.count(View.LAX_4CH) == 1
    assert "short-axis stack" in " ".join(imported.warnings)


def test_a_name_tells_the_view() -> None:
    long_axis = contour(ring(0)[:, [0, 2, 1]], "OPEN_PLANAR")
    rois = [("LV_ENDO", stack([0, 8, 16])), ("LV endo 2CH", [long_axis])]
    (frame,) = read_rtstruct({"a": rtstruct(rois)}).study.frames
    assert [s.view for s in frame.slices].count(View.LAX_2CH) == 1


def test_planes_across_the_body_are_no_short_axis_stack() -> None:
    axial = [contour(ring(z)) for z in (0, 3, 6)]
    imported = read_rtstruct({"a": rtstruct([("LV_ENDO", axial)])})
    assert {s.view for s in imported.study.frames[0].slices} == {View.OTHER}
    assert "across the body" in " ".join(imported.warnings)


def test_unknown_names_are_listed_and_never_guessed() -> None:
    rois = [("LV_ENDO", stack([0, 8])), ("Myocardium", stack([0, 8])), ("heart", [])]
    imported = read_rtstruct({"a": rtstruct(rois)})
    assert {c.structure for s in imported.study.frames[0].slices for c in s.contours} == {
        Structure.LV_ENDO
    }
    assert "'Myocardium', 'heart'" in " ".join(imported.warnings)
    assert "'Myocardium', 'heart'" in refused({"a": rtstruct(rois[1:])})


def test_a_given_name_goes_before_the_known_ones() -> None:
    rois = [("LV_ENDO", stack([0, 8])), ("inner", stack([0]))]
    given = {"lv_endo": Structure.LV_EPI, "Inner": Structure.LV_ENDO}
    (frame,) = read_rtstruct({"a": rtstruct(rois)}, structures=given).study.frames
    assert {c.structure for c in frame.slices[1].contours} <= set(given.values())
    assert sum(len(s.contours) for s in frame.slices) == 3
    assert "'outer'" in refused({"a": rtstruct(rois)}, structures={"outer": Structure.LV_EPI})


def test_a_keyhole_and_two_rings_are_the_same_hole() -> None:
    outer, inner = tilted(ring(0, 20)), tilted(ring(0, 8))[::-1]
    keyhole = np.concatenate([outer, outer[:1], inner, inner[:1]])
    one = read_rtstruct({"a": rtstruct([("LV_ENDO", [contour(keyhole)])])})
    two = read_rtstruct(
        {"a": rtstruct([("LV_ENDO", [contour(r, "CLOSEDPLANAR_XOR") for r in (outer, inner)])])}
    )
    for study in (one.study, two.study):
        lengths = sorted(
            float(np.linalg.norm(np.ptp(np.array(c.points), axis=0)))
            for c in study.frames[0].slices[0].contours
        )
        assert len(lengths) == 2
        assert lengths == pytest.approx([16 * 2**0.5, 40 * 2**0.5], rel=1e-3)


def test_a_contour_that_stands_twice_is_read_once() -> None:
    imported = read_rtstruct({"a": rtstruct([("LV_ENDO", stack([0]) * 2)])})
    assert len(imported.study.frames[0].slices[0].contours) == 1
    assert "twice" in " ".join(imported.warnings)


def test_temporal_positions_of_the_images_make_frames() -> None:
    rois = [("LV_ENDO", [c for t in "12" for c in stack([0, 8, 16], f"{t}.")])]
    files = {"rs": rtstruct(rois)} | {
        f"{t}{i}": image(f"{t}.{i}", at(i, temporal_position=n, trigger_ms=30.0 * n + i))
        for t, n in (("1", 12), ("2", 3))
        for i in range(3)
    }
    files["Ed.dcm"] = files.pop("rs")  # a name of a file says less than images do
    frames = read_rtstruct(files).study.frames
    assert [f.label for f in frames] == ["t03", "t12"]
    assert [f.time_ms for f in frames] == pytest.approx([91, 361])
    assert [len(f.slices) for f in frames] == [3, 3]


def test_trigger_times_of_the_images_make_frames() -> None:
    rois = [("LV_ENDO", [c for t in "12" for c in stack([0, 8, 16], f"{t}.")])]
    rows = ["uid,position,orientation,spacing,trigger_ms"]
    for t, time in (("1", 0.0), ("2", 330.0)):
        for i in range(3):
            g = at(i)
            numbers = [" ".join(map(str, v)) for v in (g.position_mm, (*g.row, *g.column), (1, 1))]
            rows.append(f"{t}.{i},{','.join(numbers)},{time + 5 * i}")
    files = {"rs": rtstruct(rois), "images.csv": "\n".join(rows).encode()}
    frames = read_rtstruct(files).study.frames
    assert [(f.label, len(f.slices)) for f in frames] == [("t00", 3), ("t01", 3)]


def test_images_of_several_instants_without_their_times_are_refused() -> None:
    rois = [("LV_ENDO", [c for t in "12" for c in stack([0, 8, 16], f"{t}.")])]
    assert "3 planes" in refused({"rs": rtstruct(rois)})


def test_each_file_is_a_frame_where_files_outline_the_same_planes() -> None:
    files = {n: rtstruct([("LV_ENDO", stack([0, 8, 16]))]) for n in ("one", "two")}
    assert [f.label for f in read_rtstruct(files).study.frames] == ["t00", "t01"]
    files = {f"case_{n}.dcm": data for n, data in zip(("ES", "ED"), files.values(), strict=True)}
    assert [f.label for f in read_rtstruct(files).study.frames] == ["ED", "ES"]


def test_files_of_different_planes_are_one_frame() -> None:
    files = {
        "sax": rtstruct([("LV_ENDO", stack([0, 8, 16]))]),
        "lax": rtstruct([("LV_ENDO", [contour(ring(0)[:, [0, 2, 1]], "OPEN_PLANAR")])]),
    }
    (frame,) = read_rtstruct(files).study.frames
    assert len(frame.slices) == 4
    assert sorted({c.closed for s in frame.slices for c in s.contours}) == [False, True]


def test_points_and_curves_in_space_are_left_out_and_counted() -> None:
    rois = [("LV_ENDO", [*stack([0]), contour(ring()[:1], "POINT"), contour(ring()[:2])])]
    imported = read_rtstruct({"a": rtstruct(rois)})
    assert len(imported.study.frames[0].slices[0].contours) == 1
    said = " ".join(imported.warnings)
    assert "1 contours are points or not planar" in said
    assert "1 contours have fewer than three points" in said


@pytest.mark.parametrize("syntax", SYNTAXES[:2])
def test_a_data_set_without_the_header_of_files_is_read(syntax: str) -> None:
    data = rtstruct([("LV_ENDO", stack([0, 8, 16]))], syntax)
    start = data.index(b"\x08\x00\x16\x00")
    assert len(read_rtstruct({"a": data[start:]}).study.frames[0].slices) == 3


def test_a_structure_set_of_another_program() -> None:
    """pydicom's example: no header, boxes across the body under a name of no structure."""
    data = Path(get_testdata_file("rtstruct.dcm")).read_bytes()
    assert "'patient'" in refused({"a": data})
    imported = read_rtstruct({"a": data}, structures={"Patient": Structure.LV_EPI})
    assert [len(s.contours[0].points) for s in imported.study.frames[0].slices] == [4, 5, 5]


def test_nothing_of_the_patient_comes_in(
    beat: ContourStudy, caplog: pytest.LogCaptureFixture
) -> None:
    imported = read_rtstruct({"Doe.dcm": rtstruct([*rois_of(beat, SUFFIX), ("x", [])])})
    said = imported.study.model_dump_json() + " ".join(imported.warnings) + caplog.text
    assert imported.study.subject_id == "subject"
    assert not any(word in said for word in ("Doe", "MRN", "19611224"))
    assert (
        read_rtstruct({"a": rtstruct(rois_of(beat, SUFFIX))}, subject_id="s1").study.subject_id
        == "s1"
    )
