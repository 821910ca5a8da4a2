"""What lies among the jobs and is none goes into quarantine, whole; the jobs go on."""

import json
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from datetime import UTC, datetime
from pathlib import Path

import pytest
from redis import Redis

from jobs.disk_folder import DiskFolder
from jobs.disk_store import DiskStore
from jobs.quarantine import Quarantine
from jobs.queue import JobQueue
from jobs.reconcile import Reconciled, reconcile
from jobs.records import JobRecords
from jobs.soundness import fault_of
from jobs.submission import submit
from schemas.job import Job, JobState
from schemas.messages import JobRequest, Outcome

LONG_S = 3600.0
Spoil = Callable[[Path], None]


def without_request(folder: Path) -> None:
    (folder / "request.json").unlink()


def results_without_request(folder: Path) -> None:
    without_request(folder)
    (folder / "results").mkdir()
    (folder / "results" / "ED_lv_endo.stl").write_bytes(b"solid")


def empty_request(folder: Path) -> None:
    (folder / "request.json").write_bytes(b"")


def request_cut_short(folder: Path) -> None:
    whole = (folder / "request.json").read_bytes()
    (folder / "request.json").write_bytes(whole[: len(whole) // 2])


def request_of_zeros(folder: Path) -> None:
    """As a power cut may leave a file that was not fsynced."""
    (folder / "request.json").write_bytes(b"\0" * 512)


def request_that_is_no_object(folder: Path) -> None:
    (folder / "request.json").write_text("[]")


def request_of_another_job(folder: Path) -> None:
    request = json.loads((folder / "request.json").read_text())
    (folder / "request.json").write_text(json.dumps({**request, "job_id": "0" * 32}))


def request_that_is_a_folder(folder: Path) -> None:
    without_request(folder)
    (folder / "request.json").mkdir()


def outcome_cut_short(folder: Path) -> None:
    (folder / "outcome.json").write_text('{"state": "succ')


def a_file_in_its_place(folder: Path) -> None:
    folder.rename(folder.with_name(".aside"))
    folder.write_text("what is this?")


DAMAGES: list[Spoil] = [
    without_request,
    results_without_request,
    empty_request,
    request_cut_short,
    request_of_zeros,
    request_that_is_no_object,
    request_of_another_job,
    request_that_is_a_folder,
    outcome_cut_short,
    a_file_in_its_place,
]


@pytest.fixture
def quarantine(store: DiskStore) -> Quarantine:
    return Quarantine(store.root)


@pytest.fixture
def make_job(
    store: DiskStore,
    records: JobRecords,
    queue: JobQueue,
    make_request: Callable[[], JobRequest],
) -> Callable[[], Job]:
    return lambda: submit(store, records, queue, make_request(), {"sax.nii": b"patient"})


def content(folder: Path) -> dict[str, bytes]:
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file()
    }


@pytest.mark.parametrize("spoil", DAMAGES)
def test_a_bad_folder_costs_the_good_ones_nothing_and_is_kept_whole(
    store: DiskStore,
    records: JobRecords,
    queue: JobQueue,
    redis: Redis,
    quarantine: Quarantine,
    make_job: Callable[[], Job],
    caplog: pytest.LogCaptureFixture,
    spoil: Spoil,
) -> None:
    before, bad, after = (make_job().id for _ in range(3))
    spoil(store.root / bad)
    held = content(store.root / bad)
    redis.flushall()

    mended = reconcile(store, records, queue, LONG_S)

    assert mended.quarantined == (bad,)
    assert mended.enqueued == (before, after)
    assert queue.waiting() == {before, after}
    assert records.ids() == [before, after]
    assert records.wholeness.is_certain(), "idempotency keys wait for no bad folder"
    assert not (store.root / bad).exists()
    (place,) = quarantine.root.iterdir()
    assert place.name.startswith(f"{bad}-")
    note = json.loads((place / "why.json").read_text())
    assert note["name"] == bad
    assert note["why"]
    if spoil is not a_file_in_its_place:
        assert content(place / bad) == held
    assert [r.levelname for r in caplog.records].count("ERROR") == 1
    assert not reconcile(store, records, queue, LONG_S).is_something
    assert [r.levelname for r in caplog.records].count("ERROR") == 1, "it is said once"
    assert quarantine.count() == 1


def test_a_known_job_whose_request_vanished_is_known_no_more(
    store: DiskStore, records: JobRecords, queue: JobQueue, make_job: Callable[[], Job]
) -> None:
    job = make_job()
    without_request(store.root / job.id)
    mended = reconcile(store, records, queue, LONG_S)
    assert mended.quarantined == mended.forgotten == (job.id,)
    assert records.ids() == []


def test_folders_of_other_names_are_put_aside_and_what_is_not_ours_stays(
    store: DiskStore, records: JobRecords, queue: JobQueue, quarantine: Quarantine
) -> None:
    for name in ("019c-copy", "results", "x" * 250, "lost+found", ".snapshot"):
        (store.root / name).mkdir()
        (store.root / name / "kept").write_text(name)
    (store.root / "notes.txt").write_text("a file harms nobody")
    assert set(reconcile(store, records, queue, LONG_S).quarantined) == {
        "019c-copy", "results", "x" * 250,
    }  # fmt: skip
    left = sorted(path.name for path in store.root.iterdir())
    assert left == [".snapshot", "lost+found", "notes.txt"]
    assert sorted(p.read_text() for p in quarantine.root.glob("*/*/kept")) == [
        "019c-copy", "results", "x" * 250,
    ]  # fmt: skip


def test_a_mended_folder_that_is_put_back_is_a_job_again(
    store: DiskStore,
    records: JobRecords,
    queue: JobQueue,
    redis: Redis,
    quarantine: Quarantine,
    make_job: Callable[[], Job],
) -> None:
    job = make_job()
    sound = (store.root / job.id / "request.json").read_bytes()
    request_cut_short(store.root / job.id)
    redis.flushall()
    assert reconcile(store, records, queue, LONG_S).quarantined == (job.id,)

    (place,) = quarantine.root.iterdir()
    (place / job.id / "request.json").write_bytes(sound)
    (place / job.id).rename(store.root / job.id)

    assert reconcile(store, records, queue, LONG_S).enqueued == (job.id,)
    assert records.get(job.id) is not None


def test_a_job_of_a_newer_release_is_left_where_it_is(
    store: DiskStore,
    records: JobRecords,
    queue: JobQueue,
    redis: Redis,
    make_job: Callable[[], Job],
    caplog: pytest.LogCaptureFixture,
) -> None:
    """Two releases run side by side while one is being replaced."""
    newer, known = make_job().id, make_job().id
    path = store.root / newer / "request.json"
    path.write_text(json.dumps({**json.loads(path.read_text()), "of_a_newer_release": True}))
    redis.flushall()
    mended = reconcile(store, records, queue, LONG_S)
    assert mended.quarantined == ()
    assert mended.enqueued == (known,)
    assert path.exists()
    assert "left as it is" in caplog.text


def test_a_disk_that_fails_for_one_job_is_no_damage(
    store: DiskStore,
    records: JobRecords,
    queue: JobQueue,
    redis: Redis,
    quarantine: Quarantine,
    make_job: Callable[[], Job],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    bad, good = make_job().id, make_job().id
    redis.flushall()
    real = Path.read_bytes

    def fails(path: Path) -> bytes:
        if bad in path.parts:
            raise OSError(5, "Input/output error")
        return real(path)

    with monkeypatch.context() as patch:
        patch.setattr(Path, "read_bytes", fails)
        mended = reconcile(store, records, queue, LONG_S)
    assert mended == Reconciled(restored=(good,), enqueued=(good,))
    assert quarantine.count() == 0
    assert not records.wholeness.is_certain(), "the folder may know an idempotency key"
    assert reconcile(store, records, queue, LONG_S).enqueued == (bad,)
    assert records.wholeness.is_certain()


def test_sound_jobs_in_every_state_are_sound(store: DiskStore, make_job: Callable[[], Job]) -> None:
    folder = store.folder(make_job().id)
    assert fault_of(folder) is None
    folder.staging(7)
    folder.write_checkpoint("a", b"1")
    now = datetime.now(tz=UTC)
    folder.write_outcome(
        Outcome(state=JobState.FAILED, started_at=None, finished_at=now, attempt=0)
    )
    assert fault_of(folder) is None
    folder.erase()
    assert fault_of(folder) is None, "one that is gone has no fault"


def test_two_that_find_the_same_take_it_once(store: DiskStore, quarantine: Quarantine) -> None:
    with ThreadPoolExecutor(2) as finders:
        for count in range(20):
            found = store.root / f"stranger-{count}"
            found.mkdir()
            taken = list(finders.map(lambda path: quarantine.take(path, "why"), [found] * 2))
            assert [place is None for place in taken].count(False) == 1
    assert quarantine.count() == 20


def test_what_cannot_be_moved_stays_and_blocks_nothing(
    store: DiskStore,
    records: JobRecords,
    queue: JobQueue,
    quarantine: Quarantine,
    make_job: Callable[[], Job],
    redis: Redis,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    (store.root / "stranger").mkdir()
    job = make_job()
    redis.flushall()
    real = Path.rename

    def refuses(path: Path, target: Path) -> Path:
        if path.name == "stranger":
            raise PermissionError(13, "Permission denied")
        return real(path, target)

    monkeypatch.setattr(Path, "rename", refuses)
    mended = reconcile(store, records, queue, LONG_S)
    assert mended == Reconciled(restored=(job.id,), enqueued=(job.id,))
    assert "cannot be moved" in caplog.text
    assert quarantine.count() == 0
    assert (store.root / "stranger").is_dir()


def test_nobody_else_may_look_into_it(store: DiskStore, quarantine: Quarantine) -> None:
    (store.root / "stranger").mkdir()
    place = quarantine.take(store.root / "stranger", "why")
    assert place is not None
    for folder in (quarantine.root, place):
        assert os.stat(folder).st_mode & 0o077 == 0


def test_a_job_erased_while_it_is_judged_is_not_taken(
    store: DiskStore, quarantine: Quarantine, make_job: Callable[[], Job]
) -> None:
    folder: DiskFolder = store.folder(make_job().id)
    folder.erase()
    assert quarantine.take(folder.path, "why") is None
    assert quarantine.count() == 0
