"""`neuralmri audit` finds what was done to a job, in files that were rotated too."""

import json
from datetime import UTC, datetime
from pathlib import Path

from typer.testing import CliRunner

from cli.main import app
from schemas.audit import Action, AuditEntry, AuditOutcome
from service.audit_log import AuditLog

ERASED, OTHER = "0" * 31 + "1", "0" * 31 + "2"


def written(data_dir: Path) -> None:
    log = AuditLog(data_dir / "audit", max_bytes=400, kept_files=8)
    now = datetime.now(tz=UTC)
    for job in (ERASED, OTHER):
        for action, actor in ((Action.SUBMIT, "anonymous"), (Action.ERASE, "retention")):
            expiry = now if action is Action.ERASE else None
            log.write(
                AuditEntry(
                    at=now,
                    actor=actor,
                    owner="ours",
                    action=action,
                    outcome=AuditOutcome.DONE,
                    job=job,
                    expires_at=expiry,
                )
            )


def test_the_proof_of_an_erasure_is_shown(tmp_path: Path) -> None:
    written(tmp_path)
    command = ["audit", "--job", ERASED, "--data-dir", str(tmp_path)]
    submit, erase = CliRunner().invoke(app, command).output.splitlines()
    assert "submit" in submit
    assert "by retention of ours, had expired at" in erase
    told = json.loads(CliRunner().invoke(app, [*command, "--json"]).output)["entries"]
    assert [(entry["action"], entry["job"]) for entry in told] == [
        ("submit", ERASED),
        ("erase", ERASED),
    ]


def test_what_is_no_job_is_refused(tmp_path: Path) -> None:
    ended = CliRunner().invoke(app, ["audit", "--job", "x", "--data-dir", str(tmp_path)])
    assert ended.exit_code != 0
