"""`neuralmri rerun`: do a job again, and say whether the results are the same."""

import tempfile
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cli.console import say, say_json
from cli.earlier_results import EarlierResults, check_whole, job_at, results_in
from cli.input_arguments import (
    InputArgument,
    JsonFlag,
    References,
)
from cli.inputs import ContourInput, LabelInput, read_input
from cli.label_arguments import LabelArguments, takes_label_maps
from cli.progress import progress_bar
from cli.references import reference_files
from cli.same_results import compare, version_differences
from cli.server_arguments import DEFAULT_RETRY_WITHIN_S, ApiKeyText, RetryWithin, connected
from schemas.messages import ContourRequest
from schemas.problem import InputError, ProblemType
from schemas.report import Report
from worker.threads import bind_libraries

if TYPE_CHECKING:
    from cli.client import Client


@takes_label_maps(without=("subject_id",))
def rerun(
    job: Annotated[
        str,
        typer.Argument(
            metavar="JOB", help="A job's address, http://.../v1/jobs/ID, or a folder of results."
        ),
    ],
    study: InputArgument = None,
    *,
    maps: LabelArguments,
    reference: References = None,
    api_key: ApiKeyText = None,
    retry_within: RetryWithin = DEFAULT_RETRY_WITHIN_S,
    as_json: JsonFlag = False,
) -> None:
    """Do a job again here, with its options, seed and threads, and compare every artifact.

    What was sent must be given again, but for a contour job on a server, which gives it back.
    Exit code 0: the same. 1: not the same.
    """
    with tempfile.TemporaryDirectory(prefix="neuralmri-rerun-") as scratch:
        is_given = bool(study) or maps.sax is not None
        address = job_at(job)
        if address is None:
            then, request = results_in(Path(job)), None
        else:
            server, job_id = address
            with connected(server, api_key, retry_within) as client:
                then, request = _served(client, job_id, Path(scratch) / "then", is_given=is_given)
        check_whole(then.report)
        bind_libraries(then.report.provenance.threads)
        if request is not None:
            given: ContourInput | LabelInput = ContourInput(
                request, "/study", reference_files(reference or ())
            )
        else:
            maps = replace(maps, subject_id=then.report.subject_id)
            given = read_input(study, maps, None, reference or ())
        now_folder = Path(scratch) / "now"
        now_folder.mkdir()
        now = _run(given, then, now_folder, quiet=as_json)
        names = sorted({*then.names(), *results_in(now_folder).names()})
        artifacts = [compare(name, then.folder, now_folder) for name in names]
    versions = version_differences(then.report.provenance, now.provenance)
    is_same = all(artifact.verdict.is_same for artifact in artifacts)
    if as_json:
        say_json(
            {
                "same": is_same,
                "artifacts": [artifact.model_dump(mode="json") for artifact in artifacts],
                "versions": [version.model_dump(mode="json") for version in versions],
            }
        )
    else:
        for artifact in artifacts:
            say(f"{artifact.verdict}: {artifact.name}")
        for version in versions:
            say(f"version: {version.name} was {version.then}, is {version.now}")
        say(_conclusion(is_same, bool(versions)))
    if not is_same:
        raise typer.Exit(1)


def _served(
    client: "Client", job_id: str, folder: Path, *, is_given: bool
) -> tuple[EarlierResults, ContourRequest | None]:
    """The results, and the request where it is not given here."""
    client.download(job_id, folder)
    request = None if is_given else client.request(job_id)
    return replace(results_in(folder), job_id=job_id), request


def _run(
    given: ContourInput | LabelInput, then: EarlierResults, out: Path, *, quiet: bool
) -> Report:
    """Do it again as it was done. Raises InputError where the input is another."""
    # The science, and only now: it takes seconds to load.
    from cli.reading import reading_of
    from intake.settings import LimitSettings
    from worker.subject import run

    limits = LimitSettings().limits()
    reading, pointer = reading_of(given, limits)
    provenance = then.report.provenance
    if reading.input_sha256 != provenance.input_sha256:
        raise InputError(
            ProblemType.INVALID_REQUEST,
            "these results were made from something else: give the very study, or label maps with "
            "scheme, frame labels and spacing, and with --reference every reference that was sent",
        )
    with progress_bar(reading.study.subject_id, quiet=quiet) as bar:
        return run(
            reading.study,
            then.report.options,
            out,
            threads=provenance.threads,
            input_sha256=reading.input_sha256,
            warnings=reading.warnings,
            references=reading.references,
            # Mesh files name their job, and are the same only with it.
            job_id=then.job_id,
            observer=bar,
            pointer=pointer,
            limits=limits,
        ).report


def _conclusion(is_same: bool, are_versions_different: bool) -> str:
    if is_same:
        return "the same"
    if are_versions_different:
        return "not the same: install the versions of then, and rerun"
    return "not the same, with the same versions: another kind of CPU, most likely"
