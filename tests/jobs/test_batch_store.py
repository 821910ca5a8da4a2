"""Records of batches: whole or not there, and found by their names."""

import os
import stat
import time
from pathlib import Path

import pytest

from jobs.batch_store import BatchStore, batch_tail, is_batch_id, new_batch_id


@pytest.fixture
def batches(tmp_path: Path) -> BatchStore:
    return BatchStore(tmp_path / "batches")


def test_what_was_written_is_read_until_it_is_erased(batches: BatchStore) -> None:
    one, other = (new_batch_id(batch_tail("ours", None)) for _ in range(2))
    batches.write(one, b"1")
    batches.write(other, b"2")
    batches.write(one, b"3")
    assert (batches.read(one), batches.read(other)) == (b"3", b"2")
    assert batches.ids() == sorted([one, other])
    for _ in range(2):
        batches.erase(one)
    assert (batches.read(one), batches.ids()) == (None, [other])


def test_nobody_else_reads_them_and_no_draft_is_left(batches: BatchStore, tmp_path: Path) -> None:
    batches.write(new_batch_id(batch_tail("ours", None)), b"1")
    (path,) = (tmp_path / "batches").iterdir()
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert stat.S_IMODE(path.parent.stat().st_mode) == 0o700


def test_drafts_of_the_dead_are_swept_when_they_are_old(
    batches: BatchStore, tmp_path: Path
) -> None:
    root = tmp_path / "batches"
    for name in (".draft-1-old", ".draft-2-new"):
        (root / name).write_bytes(b"half")
    long_ago = time.time() - 7200
    os.utime(root / ".draft-1-old", (long_ago, long_ago))
    BatchStore(root)
    assert [path.name for path in root.iterdir()] == [".draft-2-new"]
    assert batches.ids() == []


def test_a_key_gives_the_same_tail_to_one_owner_alone() -> None:
    assert batch_tail("ours", "k") == batch_tail("ours", "k")
    others = [batch_tail("theirs", "k"), batch_tail("ours", "l"), batch_tail("ours", None)]
    assert len({batch_tail("ours", "k"), *others, batch_tail("ours", None)}) == 5
    batch_id = new_batch_id(batch_tail("ours", "k"))
    assert is_batch_id(batch_id)
    assert batch_id.endswith(batch_tail("ours", "k"))


@pytest.mark.parametrize("text", ["", "bt_", "bt_" + "0" * 31, "bt_" + "A" * 32, "../" + "0" * 32])
def test_only_ids_touch_the_disk(batches: BatchStore, text: str) -> None:
    assert not is_batch_id(text)
    for step in (batches.read, batches.erase, lambda id_: batches.write(id_, b"")):
        with pytest.raises(ValueError, match="batch id"):
            step(text)
