"""Schemathesis against a running service: whether it does what openapi.yaml says, and only that."""

import json
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.fuzzing.answers_by_operation import Counts, answers_by_operation
from benchmarks.fuzzing.running_service import RunningService

ROOT = Path(__file__).parents[2]

SETTINGS: Mapping[str, str] = {
    # A target of webhooks that needs no name server, see schemathesis_hooks.py.
    "NEURALMRI_WEBHOOK_ALLOW": "127.0.0.0/8",
    # The tool asks each operation without a key, more often than one address may be refused.
    "NEURALMRI_REFUSALS_PER_MINUTE": "0",
}
"""What the service is started with."""

# All checks are on. Three are told what no schema says, each where it applies and nowhere else:
# - a study, a label map, a contour file, a key that was used or options of an ended job may fit the
#   schema and be judged unfit: 409, 413, 422. That good ones are accepted is what the statuses'
#   counts show.
# - of forms whose files have media types of their own, the tool sends some whose part `request` is
#   no JSON and calls them valid; they are 400.
# - OpenAPI 3.1 has no words for one event of a stream. Its schema is the stream's, a string; the
#   tool reads it as each event's, which 3.2 means by `itemSchema`.
_CONFIGURATION = """\
seed = {seed}
continue-on-failure = true
request-timeout = 30.0
hooks = "benchmarks.fuzzing.schemathesis_hooks"

[cache]
enabled = false

[generation]
max-examples = {examples}
database = "none"

[auth.openapi.bearer]
bearer = "{key}"

[[operations]]
include-path-regex = "^/v1/(jobs|validate)/(labels|files)$"
[operations.checks.positive_data_acceptance]
expected-statuses = ["2xx", "400", "401", "403", "404", "409", "413", "422", "429"]

[[operations]]
include-method = "POST"
include-path-regex = "^(?!.*/(labels|files)$)"
[operations.checks.positive_data_acceptance]
expected-statuses = ["2xx", "401", "403", "404", "409", "413", "422", "429"]

[[operations]]
include-operation-id = "job_event_stream"
[operations.checks.response_schema_conformance]
enabled = false
"""


@dataclass(frozen=True)
class Described:
    """What came of a run.

    generated: requests. failures: each a check and the operations at which it failed.
    """

    generated: int
    seconds: float
    failures: tuple[str, ...]
    untested: tuple[str, ...]
    answers: Counts
    transcript: str

    @property
    def is_clean(self) -> bool:
        return not self.failures and not self.untested


def run_schemathesis(
    service: RunningService, folder: Path, *, examples: int, seed: int = 1
) -> Described:
    """Every operation in every phase (examples, coverage, fuzzing, stateful), every check.

    Raises RuntimeError where the tool itself fails.
    """
    configuration, report = folder / "schemathesis.toml", folder / "report.json"
    configuration.write_text(_CONFIGURATION.format(seed=seed, examples=examples, key=service.key))
    command = [
        *(sys.executable, "-m", "schemathesis.cli", "--no-color"),
        *("--config-file", str(configuration), "run", str(ROOT / "openapi.yaml")),
        *("--url", service.url, "--report", "json", "--report-json-path", str(report)),
    ]
    before = answers_by_operation(service)
    ended = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    if not report.is_file():
        raise RuntimeError(f"schemathesis did not come to an end:\n{ended.stdout}{ended.stderr}")
    said = json.loads(report.read_text())
    return Described(
        generated=said["test_cases"]["generated"],
        seconds=said["running_time"],
        failures=(*map(_failure, said["failures"]), *map(str, said["errors"])),
        untested=tuple(said["warnings"]["missing_test_data"]),
        answers=answers_by_operation(service) - before,
        transcript=ended.stdout,
    )


def _failure(found: dict[str, Any]) -> str:
    return f"{found['title']}: {', '.join(found['operations'])}"
