"""Cross-section files: written and read again, labelled, damaged."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from intake.formats.csl import read_csl
from intake.formats.csl_out import write_csl
from intake.formats.guide_points import read_guide_points
from schemas.contour_files import CslSettings
from schemas.problem import InputError, ProblemType
from schemas.study import Contour, ContourStudy, Frame, Slice
from schemas.vocabulary import Axes, Structure, Units, View
from tests.intake.formats.guide_point_files import heart, said_of

RING = [(10.0, 0.0, 0.0), (0.0, 10.0, 0.0), (-10.0, 0.0, 0.0), (0.0, -10.0, 0.0)]
HOLE = [(x / 4, y / 4, z) for x, y, z in RING]


def closed_study() -> ContourStudy:
    made = read_guide_points(heart()).study
    frame = made.frames[0]
    sax = [s for s in frame.slices if s.view is View.SAX]
    frames = [Frame(label=label, slices=sax) for label in ("ED", "ES")]
    return made.model_copy(update={"frames": frames})


def test_writing_and_reading_again_gives_the_same_study() -> None:
    study = closed_study()
    exported = write_csl(study)
    assert sorted(exported.files) == sorted(
        f"{frame}_{s}.csl" for frame in ("ED", "ES") for s in ("lv_endo", "lv_epi", "rv_endo")
    )
    assert exported.warnings == ()
    again = read_csl(dict(exported.files)).study
    assert [f.label for f in again.frames] == ["ED", "ES"]
    for f, g in zip(study.frames, again.frames, strict=True):
        for s, t in zip(f.slices, g.slices, strict=True):
            assert t.view is View.SAX
            assert {c.structure: c.points for c in s.contours} == {
                c.structure: c.points for c in t.contours
            }
            assert s.normal is not None
            assert t.normal is not None
            assert s.origin is not None
            assert t.origin is not None
            np.testing.assert_allclose(s.normal, t.normal, atol=1e-12)
            assert abs(np.dot(np.subtract(s.origin, t.origin), s.normal)) < 1e-9


def test_a_hole_is_a_component_and_an_open_contour_is_closed_and_said() -> None:
    contours = [
        Contour(structure=Structure.LV_ENDO, points=RING),
        Contour(structure=Structure.LV_ENDO, points=HOLE, closed=False),
    ]
    slice_ = Slice(id="a", origin=(0, 0, 0), normal=(0, 0, 1), contours=contours)
    study = ContourStudy(
        subject_id="a", units=Units.MM, axes=Axes.LPS, frames=[Frame(label="ED", slices=[slice_])]
    )
    exported = write_csl(study)
    assert "1 open contours are closed by a chord" in exported.warnings[0]
    (back,) = read_csl(dict(exported.files)).study.frames[0].slices
    assert [c.points for c in back.contours] == [RING, HOLE]


LABELLED = b"""CSLC
2 3

1 6 2 0 0 2 -10

0 0 5
4 0 5
0 4 5
0 0 5
9 0 5
0 9 5

3 1 0 1 2
3 2 3 4 5
2 3 1 0 0 1 -8
0 0 8
9 0 8
0 9 8
3 2 0 1 2
"""


def test_labels_are_structures_that_the_caller_names() -> None:
    named = CslSettings(structures={"1": Structure.LV_ENDO, "2": Structure.LV_EPI})
    study = read_csl({"heart.csl": LABELLED}, named, subject_id="s").study
    first, second = study.frames[0].slices
    assert [c.structure for c in first.contours] == [Structure.LV_ENDO, Structure.LV_EPI]
    assert first.origin == (0.0, 0.0, 5.0)
    assert second.absent == [Structure.LV_ENDO]


@pytest.mark.parametrize(
    ("name", "structures", "words"),
    [
        ("heart.csl", {}, "not known which structure"),
        ("ED_lv_endo.csl", {}, "several labels"),
        ("heart.csl", {"1": Structure.LV_ENDO}, "label 2 is not among"),
    ],
)
def test_a_structure_is_never_guessed(
    name: str, structures: dict[str, Structure], words: str
) -> None:
    with pytest.raises(InputError, match=r"csl\.structures") as caught:
        read_csl({name: LABELLED}, CslSettings(structures=structures))
    assert words in caught.value.detail


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (b"CSLC", b"CSLX", "line 1: the first line"),
        (b"2 3\n", b"2\n", "line 2: the counts"),
        (b"2 3\n", b"999999999 3\n", "line 19: the file ends"),
        (b"1 6 2", b"1 999999999 2", "line 4: more than"),
        (b"1 6 2", b"1 6 -2", "line 4: a count"),
        (b"0 0 2 -10", b"0 0 0 -10", "line 4: A, B, C"),
        (b"4 0 5", b"4 0 inf", "line 7: a value"),
        (b"4 0 5", b"4 0", "line 7: a vertex"),
        (b"3 1 0 1 2", b"3 1 0 1 6", "line 13: a component names"),
        (b"3 1 0 1 2", b"4 1 0 1 2", "line 13: a component announces"),
        (b"0 9 8\n3 2 0 1 2\n", b"0 9 8\n3 2 0 1 2\nmore\n", "line 20: there is more"),
    ],
)
def test_a_bad_line_is_named(old: bytes, new: bytes, words: str) -> None:
    with pytest.raises(InputError, match="Remedy") as caught:
        read_csl({"ED_lv_endo.csl": LABELLED.replace(old, new, 1)})
    assert caught.value.type is ProblemType.UNREADABLE_CONTOUR_FILE
    assert words in caught.value.detail


@settings(max_examples=100, deadline=None)
@given(st.data())
def test_damaged_files_are_read_or_refused_never_worse(data: st.DataObject) -> None:
    body = bytearray(LABELLED)
    for _ in range(data.draw(st.integers(1, 5))):
        at = data.draw(st.integers(0, len(body) - 1))
        body[at : at + data.draw(st.integers(0, 9))] = data.draw(st.binary(max_size=5))
    named = CslSettings(structures={"1": Structure.LV_ENDO, "2": Structure.LV_EPI})
    assert "Remedy" in said_of(lambda: read_csl({"heart.csl": bytes(body)}, named))
