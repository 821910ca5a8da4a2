import multiprocessing
import os
from datetime import timedelta
from pathlib import Path

import pytest

from schemas.api_key import Scope
from schemas.problem import InternalError
from service.keys import keyring
from service.keys.key_file import KeyFile, Keys


@pytest.fixture
def file(tmp_path: Path) -> KeyFile:
    return KeyFile(tmp_path / "data")


def create(file: KeyFile, owner: str = "ours") -> str:
    return keyring.create(file, owner, owner, (Scope.READ,), None)[0].id


def test_no_file_is_no_key(file: KeyFile) -> None:
    assert file.keys() == {}
    assert not file.has_had_keys()


def test_a_change_is_seen_by_who_has_read_before(file: KeyFile, tmp_path: Path) -> None:
    other = KeyFile(tmp_path / "data")
    assert other.keys() == {}
    for count in range(1, 20):  # faster than the clock of the file system ticks
        create(file)
        assert len(other.keys()) == count
    assert list(other.keys()) == list(file.keys())


def test_an_edit_by_hand_is_seen(file: KeyFile, tmp_path: Path) -> None:
    key_id = create(file)
    assert list(file.keys()) == [key_id]
    (tmp_path / "data" / "keys.json").write_text('{"keys": []}')
    assert file.keys() == {}
    assert file.has_had_keys()


def test_it_is_private_durable_and_has_no_secret(
    file: KeyFile, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    synced: list[str] = []
    fsync = os.fsync

    def noting(descriptor: int) -> None:
        synced.append(Path(os.readlink(f"/proc/self/fd/{descriptor}")).name)
        fsync(descriptor)

    monkeypatch.setattr("os.fsync", noting)
    _, token = keyring.create(file, "ours", "ours", (Scope.READ,), timedelta(days=1))
    path = tmp_path / "data" / "keys.json"
    assert path.stat().st_mode & 0o777 == 0o600
    assert path.parent.stat().st_mode & 0o777 == 0o700
    assert token.secret not in path.read_text()
    draft, folder = synced
    assert draft.startswith(".keys-")
    assert folder == "data"


def test_a_step_that_fails_changes_nothing(file: KeyFile, tmp_path: Path) -> None:
    create(file)
    before = (tmp_path / "data" / "keys.json").read_bytes()

    def step(_keys: Keys) -> Keys:
        raise KeyError

    with pytest.raises(KeyError):
        file.change(step)
    assert (tmp_path / "data" / "keys.json").read_bytes() == before


def test_a_disk_that_is_full_changes_nothing(
    file: KeyFile, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    key_id = create(file)

    def full(_descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patched:
        patched.setattr("jobs.durable.os.fsync", full)
        with pytest.raises(OSError, match="No space"):
            create(file)
    assert list(file.keys()) == [key_id]
    assert sorted(p.name for p in (tmp_path / "data").iterdir()) == ["keys.json", "keys.lock"]


@pytest.mark.parametrize("content", ["", "{", '{"keys": [{"id": "x"}]}', '{"other": 1}', "[]"])
def test_a_damaged_file_is_said_to_be(file: KeyFile, tmp_path: Path, content: str) -> None:
    create(file)
    (tmp_path / "data" / "keys.json").write_text(content)
    for _ in range(2):
        with pytest.raises(InternalError, match="Remedy"):
            file.keys()


def _create_ten(data_dir: Path) -> None:
    for _ in range(10):
        create(KeyFile(data_dir))


def test_processes_that_write_at_once_lose_no_key(file: KeyFile, tmp_path: Path) -> None:
    context = multiprocessing.get_context("spawn")
    writers = [context.Process(target=_create_ten, args=(tmp_path / "data",)) for _ in range(3)]
    for writer in writers:
        writer.start()
    for writer in writers:
        writer.join()
        assert writer.exitcode == 0
    assert len(file.keys()) == 30
