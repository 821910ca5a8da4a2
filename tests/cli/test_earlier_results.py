from pathlib import Path

import pytest

from cli.earlier_results import check_whole, job_at, results_in
from schemas.problem import InputError
from tests.worker.artifacts.page.example_report import report

ID = "0" * 32


@pytest.mark.parametrize(
    ("text", "found"),
    [
        (f"http://127.0.0.1:8000/v1/jobs/{ID}", ("http://127.0.0.1:8000", ID)),
        (f"https://example.org/heart/v1/jobs/{ID}/", ("https://example.org/heart", ID)),
        (f"http://127.0.0.1:8000/v1/jobs/{ID[1:]}", None),
        (f"results/v1/jobs/{ID}", None),
        ("results", None),
    ],
)
def test_an_address_of_a_job_is_told_from_a_folder(
    text: str, found: tuple[str, str] | None
) -> None:
    assert job_at(text) == found


def test_a_folder_without_a_report_is_refused_with_a_remedy(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"report\.json; name a folder of results"):
        results_in(tmp_path)


def test_a_report_of_another_version_is_refused_with_a_remedy(tmp_path: Path) -> None:
    (tmp_path / "report.json").write_text('{"schema_version": "1.0"}')
    with pytest.raises(InputError, match="rerun it with the version"):
        results_in(tmp_path)


def test_what_a_cancelled_job_kept_is_refused_with_a_remedy() -> None:
    check_whole(report())
    with pytest.raises(InputError, match="restart the job"):
        check_whole(report().model_copy(update={"stopped_early": True}))
