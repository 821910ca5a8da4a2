"""Guide points become contours that are whole, simple and in order."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from intake.crossing_edges import crossing_edges
from intake.formats.guide_points import read_guide_points
from intake.formats.guide_points_out import write_guide_points
from intake.limits import Limits
from intake.simplicity import shoelace_mm2
from intake.study import admit
from schemas.contour_files import GuidePointSettings
from schemas.options import Options
from schemas.problem import InputError, ProblemType
from schemas.study import Contour, ContourStudy
from schemas.vocabulary import Structure, View
from tests.intake.formats.guide_point_files import HEADER, heart, said_of

REAL = Path(__file__).parents[4] / "shared" / "data"


def by_place(study: ContourStudy) -> dict[tuple[str, str, Structure], Contour]:
    return {
        (f.label, s.id, c.structure): c for f in study.frames for s in f.slices for c in s.contours
    }


def flat(contour: Contour) -> np.ndarray:
    return np.array(contour.points)[:, :2]


def test_pieces_of_a_short_axis_slice_are_joined_into_closed_simple_outlines() -> None:
    imported = read_guide_points(heart())
    assert admit(imported.study, Options()) == []
    contours = by_place(imported.study)
    expected_mm2 = {Structure.LV_ENDO: np.pi * 20**2, Structure.LV_EPI: np.pi * 30**2}
    for slice_ in "123":
        for structure in (Structure.LV_ENDO, Structure.LV_EPI, Structure.RV_ENDO):
            contour = contours["t000", slice_, structure]
            assert contour.closed
            ring = flat(contour)
            (found,) = crossing_edges([(ring, True)])
            assert found is not None
            assert len(found[0]) == 0
            if structure in expected_mm2:
                assert abs(shoelace_mm2(ring)) == pytest.approx(expected_mm2[structure], rel=0.01)
    # The crescent: free wall and septum, every point of either once.
    assert len(contours["t000", "1", Structure.RV_ENDO].points) == 50 + 30


def test_a_long_axis_outline_is_open_at_the_valve() -> None:
    imported = read_guide_points(heart())
    (slice_,) = [s for s in imported.study.frames[0].slices if s.id == "4"]
    assert slice_.view is View.LAX_2CH
    for contour in slice_.contours:
        assert not contour.closed
        ends = np.array(contour.points)[[0, -1]]
        assert np.abs(ends[:, 2]).max() < 1e-4  # both at the base


@pytest.mark.parametrize("seed", range(5))
def test_the_order_of_the_points_does_not_matter(seed: int) -> None:
    assert read_guide_points(heart(seed)).study == read_guide_points(heart()).study


def test_writing_and_reading_again_gives_the_same_study() -> None:
    study = read_guide_points(heart()).study
    again = read_guide_points(dict(write_guide_points(study).files)).study
    assert_same(study, again)


def assert_same(study: ContourStudy, again: ContourStudy) -> None:
    then, now = by_place(study), by_place(again)
    assert list(then) == list(now)
    for place, contour in then.items():
        assert now[place].closed == contour.closed
        np.testing.assert_allclose(now[place].points, contour.points, atol=3e-5)
    for f, g in zip(study.frames, again.frames, strict=True):
        for s, t in zip(f.slices, g.slices, strict=True):
            assert (s.id, s.view) == (t.id, t.view)
            assert s.normal is not None
            assert t.normal is not None
            np.testing.assert_allclose(s.normal, t.normal, atol=1e-9)


def test_frames_come_in_time_and_get_their_times() -> None:
    files = heart()
    body = files.pop("GPFile_000.txt")
    files |= {f"GPFile_{k:03d}.txt": body for k in (10, 2, 0, 5)}
    study = read_guide_points(files, GuidePointSettings(rr_interval_ms=1100.0)).study
    assert [f.label for f in study.frames] == ["t000", "t002", "t005", "t010"]
    assert [f.time_ms for f in study.frames] == [0.0, 200.0, 500.0, 1000.0]
    named = {"GP_ES.txt": body, "GP_ED.txt": body, "S.txt": files["SliceInfoFile.txt"]}
    assert [f.label for f in read_guide_points(named).study.frames] == ["ED", "ES"]


def test_a_spike_is_cut_and_said() -> None:
    files = heart()
    lines = files["GPFile_000.txt"].decode().split("\n")
    lines[30] = lines[30].replace(lines[30].split("\t")[0], "90.0", 1)
    imported = read_guide_points(files | {"GPFile_000.txt": "\n".join(lines).encode()})
    assert any("1 points far off the line of a lv_endo" in w for w in imported.warnings)
    contour = by_place(imported.study)["t000", "1", Structure.LV_ENDO]
    assert np.linalg.norm(flat(contour), axis=1).max() < 21


def test_without_slice_info_planes_are_fitted() -> None:
    files = heart()
    del files["SliceInfoFile.txt"]
    imported = read_guide_points(files)
    assert imported.study.frames[0].slices[0].normal is None
    assert any("No SliceInfo" in warning for warning in imported.warnings)
    assert admit(imported.study, Options()) == []


def test_a_slice_without_points_in_a_frame_is_unknown_there() -> None:
    files = heart()
    text = files["GPFile_000.txt"].decode()
    kept = "".join(line + "\n" for line in text.split("\n")[:-1] if "\t2\t1.0" not in line)
    study = read_guide_points(files | {"GPFile_001.txt": kept.encode()}).study
    assert [s.id for s in study.frames[1].slices] == ["1", "3", "4"]
    assert not any(s.absent for f in study.frames for s in f.slices)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("1\t2\tx\tSAX_LV_ENDOCARDIAL\t1\t1.0\t0", "line 2: z is no number"),
        ("1\t2\tnan\tSAX_LV_ENDOCARDIAL\t1\t1.0\t0", "line 2: z is no number"),
        ("1\t2\t3e9\tSAX_LV_ENDOCARDIAL\t1\t1.0\t0", "line 2: z is no number"),
        ("1\t2\t3", "line 2: 3 values"),
        ("1\t2\t3\t../etc\t1\t1.0\t0", "line 2: the fourth value"),
        ("1\t2\t3\tSAX_LV_ENDOCARDIAL\t../1\t1.0\t0", "line 2: the fifth value"),
        ("1\t2\t3\tSAX_LV_ENDOCARDIAL\t77\t1.0\t0", "line 2: slice 77 is not in"),
        ("1\t2\t60\tSAX_LV_ENDOCARDIAL\t1\t1.0\t0", "line 2: the point is 100 mm off"),
        ("1\t2\t-40\tMITRAL_VALVE\t1\t1.0\t0", "no contour can be made"),
        ("", "no point is in it"),
    ],
)
def test_a_bad_line_is_named(line: str, words: str) -> None:
    files = heart() | {"GPFile_000.txt": (HEADER + line).encode()}
    with pytest.raises(InputError) as caught:
        read_guide_points(files)
    assert caught.value.type is ProblemType.UNREADABLE_CONTOUR_FILE
    assert words in caught.value.detail
    assert "Remedy" in caught.value.detail


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a\tsliceID: \t1\tImagePositionPatient\t0\t0", "line 1: ImagePositionPatient has not 3"),
        ("a\tImagePositionPatient\t0\t0\t0", "line 1: no slice id"),
        (
            "sliceID: \t1\tImagePositionPatient\t0\t0\t0"
            "\tImageOrientationPatient\t1\t0\t0\t1\t0\t0",
            "right angles",
        ),
    ],
)
def test_a_bad_slice_info_is_named(text: str, words: str) -> None:
    files = heart() | {"SliceInfoFile.txt": (text + "\tsliceID:").encode()}
    with pytest.raises(InputError, match="Remedy") as caught:
        read_guide_points(files)
    assert words in caught.value.detail


def test_points_are_counted_while_they_are_read() -> None:
    with pytest.raises(InputError, match="more than 100 points"):
        read_guide_points(heart(), limits=Limits(max_points=100))


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_damaged_files_are_read_or_refused_never_worse(data: st.DataObject) -> None:
    files = heart()
    name = data.draw(st.sampled_from(sorted(files)))
    body = bytearray(files[name])
    for _ in range(data.draw(st.integers(1, 8))):
        at = data.draw(st.integers(0, len(body) - 1))
        body[at : at + data.draw(st.integers(0, 40))] = data.draw(st.binary(max_size=6))
    assert "Remedy" in said_of(lambda: read_guide_points(files | {name: bytes(body)}))


needs_real = pytest.mark.skipif(not REAL.is_dir(), reason=f"no real guide points in {REAL}")


@needs_real
@pytest.mark.parametrize(
    ("folder", "frames", "views"),
    [
        (
            "bivme_guide_points/patient1",
            25,
            {"7": View.LAX_4CH, "8": View.LAX_3CH, "9": View.LAX_2CH, "11": View.OTHER},
        ),
        (
            "cap_venus1",
            2,
            {"8": View.LAX_4CH, "4": View.LAX_3CH, "0": View.LAX_2CH, "1": View.OTHER},
        ),
    ],
)
def test_real_guide_points_are_admitted(folder: str, frames: int, views: dict[str, View]) -> None:
    files = {path.name: path.read_bytes() for path in (REAL / folder).glob("*.txt")}
    imported = read_guide_points(files)
    assert len(imported.study.frames) == frames
    admit(imported.study, Options())
    for frame in imported.study.frames:
        for slice_ in frame.slices:
            assert slice_.view is views.get(slice_.id, slice_.view)
            if slice_.view is View.SAX:
                assert all(contour.closed for contour in slice_.contours)


@needs_real
def test_the_order_of_real_points_hardly_matters() -> None:
    """Outlines enclose the same area, where they have points enough to be told from them alone."""
    folder = REAL / "bivme_guide_points" / "patient1"
    names = ("GPFile_000.txt", "SliceInfoFile.txt")
    files = {name: (folder / name).read_bytes() for name in names}
    header, *lines = files[names[0]].decode().strip().split("\n")
    order = np.random.default_rng(0).permutation(len(lines))
    mixed = "\n".join([header, *(lines[k] for k in order)]).encode()
    then = by_place(read_guide_points(files).study)
    now = by_place(read_guide_points(files | {names[0]: mixed}).study)
    for place, contour in then.items():
        if contour.closed and len(contour.points) >= 30 and place[2] is not Structure.RV_EPI:
            area, other = area_mm2(contour), area_mm2(now[place])
            assert other == pytest.approx(area, rel=0.01), place


def area_mm2(contour: Contour) -> float:
    points = np.array(contour.points)
    about = np.cross(points - points[0], np.roll(points, -1, axis=0) - points[0])
    return 0.5 * float(np.linalg.norm(about.sum(axis=0)))
