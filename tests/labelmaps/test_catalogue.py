"""Every map of the catalogue is answered as the catalogue says, where it says."""

from collections import Counter
from pathlib import Path

import pytest

from intake.label_maps import check_label_maps
from intake.limits import Limits
from schemas.labels import LabelRequest
from schemas.problem import Fault, InputError
from schemas.vocabulary import View
from tests.labelmaps.catalogue import CATALOGUE, LabelMapCase
from worker.labelmaps.reading import read_label_maps

every_case = pytest.mark.parametrize("case", CATALOGUE, ids=lambda case: case.name)


def test_names_are_unique_and_cases_many() -> None:
    assert max(Counter(case.name for case in CATALOGUE).values()) == 1
    assert sum(case.where != "accepted" for case in CATALOGUE) >= 20


def saved(case: LabelMapCase, folder: Path) -> dict[View, Path]:
    """The case's files under names that say nothing of their format."""
    files = {}
    for part, data in case.files().items():
        files[View(part)] = folder / part
        files[View(part)].write_bytes(data)
    return files


def check_problem(case: LabelMapCase, error: InputError) -> None:
    assert error.type is case.problem, error.detail
    assert (error.status, error.pointer, error.fault) == (case.status, case.pointer, Fault.CALLER)
    assert "Remedy: " in error.detail
    for words in case.says:
        assert words in error.detail


@every_case
def test_door(case: LabelMapCase, tmp_path: Path) -> None:
    files = saved(case, tmp_path)
    request = LabelRequest.model_validate(case.request)
    if case.where == "door":
        with pytest.raises(InputError) as raised:
            check_label_maps(files, request, Limits())
        check_problem(case, raised.value)
    else:
        assert check_label_maps(files, request, Limits()).keys() == files.keys()


@every_case
def test_worker(case: LabelMapCase, tmp_path: Path) -> None:
    files = saved(case, tmp_path)
    request = LabelRequest.model_validate(case.request)
    if case.where == "accepted":
        study, _ = read_label_maps(files, request, Limits())
        assert len(study.frames) == 1
    else:
        with pytest.raises(InputError) as raised:
            read_label_maps(files, request, Limits())
        check_problem(case, raised.value)
