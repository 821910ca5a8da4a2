"""Schemes are checked against the anatomy, never guessed."""

import json
import re

import numpy as np
import pytest

from schemas.label_schemes import published_labels
from schemas.labels import LabelRequest, LabelScheme, TissueLabels
from schemas.problem import InputError, ProblemType
from schemas.vocabulary import View
from tests.labelmaps.heart_maps import lax, renamed, sax
from worker.labelmaps.check import check_labels
from worker.labelmaps.scheme import values_by_tissue

VIEWS = {View.SAX: sax, View.LAX_3CH: lax, View.LAX_4CH: lax}


def written(scheme: LabelScheme, view: View) -> np.ndarray:
    """The heart with the values of a scheme."""
    values = values_by_tissue(published_labels(scheme, view))
    names = {int(t): listed[0] if listed else 0 for t, listed in values.items()}
    return renamed(VIEWS[view](), names).astype(np.int16)


def check(labels: np.ndarray, scheme: object, view: View = View.SAX) -> None:
    request = LabelRequest.model_validate({"subject_id": "s", "label_scheme": scheme})
    check_labels(view, [labels], 2, request)


@pytest.mark.parametrize("scheme", LabelScheme)
@pytest.mark.parametrize("view", VIEWS)
def test_every_scheme_reads_its_own_maps(scheme: LabelScheme, view: View) -> None:
    check(written(scheme, view), scheme, view)


SAME_ON_SHORT_AXIS = {LabelScheme.MNMS, LabelScheme.UKBB, LabelScheme.BIV_ME}


@pytest.mark.parametrize("scheme", LabelScheme)
@pytest.mark.parametrize("other", LabelScheme)
def test_no_scheme_reads_anothers_maps(scheme: LabelScheme, other: LabelScheme) -> None:
    labels = written(scheme, View.SAX)
    if scheme is other or {scheme, other} <= SAME_ON_SHORT_AXIS:
        check(labels, other)
        return
    with pytest.raises(InputError) as raised:
        check(labels, other)
    assert raised.value.type in (ProblemType.WRONG_LABEL_SCHEME, ProblemType.UNKNOWN_LABELS)
    assert f"`{scheme.value}`" in raised.value.detail


def test_an_explicit_scheme_is_checked_too() -> None:
    labels = sax().astype(np.int16)
    check(labels, TissueLabels(lv_cavity=[1], lv_wall=[2], rv_cavity=[3]))
    with pytest.raises(InputError, match="`mnms`") as raised:
        check(labels, TissueLabels(lv_cavity=[3], lv_wall=[2], rv_cavity=[1]))
    assert raised.value.type is ProblemType.WRONG_LABEL_SCHEME


def test_a_cavity_alone_needs_an_explicit_scheme() -> None:
    labels = (sax() == 1).astype(np.int16)
    check(labels, TissueLabels(lv_cavity=[1]))
    with pytest.raises(InputError, match="no lv_wall"):
        check(labels, LabelScheme.MNMS)


def test_atrial_maps_do_not_pass_for_ventricles() -> None:
    """UK Biobank's atrial maps have LA 1 and RA 2, side by side."""
    atria = np.zeros((64, 64, 1), np.int16)
    atria[10:30, 20:40] = 1
    atria[31:52, 20:40] = 2
    with pytest.raises(InputError) as raised:
        check(atria, LabelScheme.UKBB, View.LAX_4CH)
    assert raised.value.type is ProblemType.WRONG_LABEL_SCHEME


def test_a_gap_of_a_pixel_between_cavity_and_wall_is_allowed() -> None:
    labels = sax().astype(np.int16)
    cavity = labels == 1
    core = cavity.copy()
    for axis in (0, 1):
        for step in (1, -1):
            core &= np.roll(cavity, step, axis)
    labels[cavity & ~core] = 0
    check(labels, LabelScheme.MNMS)


def test_unknown_values_come_with_the_scheme_that_ignores_them() -> None:
    labels = sax().astype(np.int16)
    labels[:2, :2, 5] = 77
    labels[2:4, :2, 5] = -3
    with pytest.raises(InputError, match="-3, 77") as raised:
        check(labels, LabelScheme.MNMS)
    remedy = re.search(r"\{.*\}", raised.value.detail)
    assert remedy
    check(labels, json.loads(remedy[0]))


def test_a_map_of_ignored_values_is_empty() -> None:
    labels = (lax() > 0).astype(np.int16) * 4
    with pytest.raises(InputError, match="only the ignored values 4") as raised:
        check(labels, LabelScheme.UKBB, View.LAX_4CH)
    assert raised.value.type is ProblemType.EMPTY_LABEL_MAP


def test_biv_me_numbers_each_view_on_its_own() -> None:
    atrium = lax().astype(np.int16)
    atrium[atrium == 3] = 0
    atrium[20:40, 60:] = 3
    check(atrium, LabelScheme.BIV_ME, View.LAX_2CH)
    assert published_labels(LabelScheme.BIV_ME, View.LAX_4CH).rv_wall == [6]
    assert published_labels(LabelScheme.BIV_ME, View.SAX).rv_wall == [4]
