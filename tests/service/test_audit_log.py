import json
import threading
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pytest

from schemas.audit import Action, AuditEntry, AuditOutcome
from service.audit_log import AuditLog

MAX_BYTES = 4096


@pytest.fixture
def log(tmp_path: Path) -> AuditLog:
    return AuditLog(tmp_path / "audit", max_bytes=MAX_BYTES, kept_files=3)


def entry(number: int, action: Action = Action.SUBMIT, outcome: str = "done") -> AuditEntry:
    return AuditEntry(
        at=datetime.now(tz=UTC),
        actor="anonymous",
        action=action,
        outcome=AuditOutcome(outcome),
        job=f"{number:032x}",
    )


def numbers(path: Path) -> list[int]:
    return [int(json.loads(line)["job"], 16) for line in path.read_text().splitlines()]


def files(log: AuditLog) -> list[Path]:
    """Of what was done, the oldest first."""
    return [
        path
        for name in ("done.2.jsonl", "done.1.jsonl", "done.jsonl")
        if (path := log.folder / name).exists()
    ]


def test_lines_are_appended_in_order(log: AuditLog) -> None:
    for number in range(5):
        log.write(entry(number))
    assert numbers(log.folder / "done.jsonl") == list(range(5))


def test_size_is_bounded_and_the_newest_lines_are_kept_without_a_gap(log: AuditLog) -> None:
    for number in range(200):
        log.write(entry(number))
        assert all(path.stat().st_size <= MAX_BYTES for path in log.folder.iterdir())
    assert sorted(p.name for p in log.folder.iterdir()) == [
        "done.1.jsonl",
        "done.2.jsonl",
        "done.jsonl",
        "lock",
    ]
    kept = [number for path in files(log) for number in numbers(path)]
    assert kept == list(range(kept[0], 200))
    assert len(kept) > 2 * MAX_BYTES // 200


def test_a_flood_of_refusals_pushes_no_deed_out(log: AuditLog) -> None:
    log.write(entry(1, Action.ERASE))
    for number in range(200):
        log.write(entry(number, outcome="refused"))
    assert numbers(log.folder / "done.jsonl") == [1]


@pytest.mark.parametrize(
    ("action", "synced"),
    [(Action.ERASE, True), (Action.KEY_REVOKED, True), (Action.SUBMIT, False)],
)
def test_proofs_are_on_disk_before_the_answer(
    log: AuditLog, monkeypatch: pytest.MonkeyPatch, action: Action, synced: bool
) -> None:
    log.write(entry(0))
    done: list[int] = []
    monkeypatch.setattr("service.audit_log.os.fsync", done.append)
    log.write(entry(1, action))
    assert bool(done) is synced


def test_a_full_disk_leaves_no_half_line(log: AuditLog, monkeypatch: pytest.MonkeyPatch) -> None:
    import os

    log.write(entry(0))
    write, calls = os.write, 0

    def full(descriptor: int, content: bytes) -> int:
        nonlocal calls
        calls += 1
        if calls > 1:
            raise OSError(28, "No space left on device")
        return write(descriptor, content[:10])

    with monkeypatch.context() as patched:
        patched.setattr("service.audit_log.os.write", full)
        with pytest.raises(OSError, match="No space"):
            log.write(entry(1))
    log.write(entry(2))
    assert numbers(log.folder / "done.jsonl") == [0, 2]


def test_many_writers_lose_no_line(log: AuditLog) -> None:
    def write(start: int) -> None:
        for number in range(start, start + 10):
            log.write(entry(number))

    threads: list[Any] = [threading.Thread(target=write, args=(10 * k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(n for path in files(log) for n in numbers(path)) == list(range(40))
