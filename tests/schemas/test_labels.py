"""What a label request accepts and what it refuses."""

from typing import Any

import pytest
from pydantic import ValidationError

from schemas.labels import LabelRequest, LabelScheme, TissueLabels


@pytest.mark.parametrize("scheme", list(LabelScheme))
def test_every_published_scheme_is_accepted(scheme: LabelScheme) -> None:
    request = LabelRequest.model_validate({"subject_id": "a", "label_scheme": scheme.value})
    assert request.label_scheme is scheme


def test_a_scheme_is_never_guessed() -> None:
    with pytest.raises(ValidationError, match="label_scheme"):
        LabelRequest.model_validate({"subject_id": "a"})


def test_a_tissue_may_have_several_values() -> None:
    assert TissueLabels(lv_wall=[1, 2], ignored=[9]).lv_wall == [1, 2]


@pytest.mark.parametrize(
    ("labels", "said"),
    [
        ({}, "at least one tissue"),
        ({"ignored": [1]}, "at least one tissue"),
        ({"lv_wall": [0]}, "0 is the background"),
        ({"lv_wall": [1], "rv_cavity": [1]}, r"two tissues: \[1\]"),
        ({"lv_wall": [1], "ignored": [1]}, r"two tissues: \[1\]"),
        ({"lv_wall": [1.5]}, "lv_wall"),
    ],
)
def test_labels_are_a_partition(labels: dict[str, Any], said: str) -> None:
    with pytest.raises(ValidationError, match=said):
        TissueLabels.model_validate(labels)


@pytest.mark.parametrize("second", ["ED", "ed"])
def test_frame_labels_are_unique_whatever_their_case(second: str) -> None:
    with pytest.raises(ValidationError, match="repeats a name"):
        LabelRequest(subject_id="a", label_scheme="acdc", frame_labels=["ED", second])
