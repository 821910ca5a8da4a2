import errno
import os
from pathlib import Path

import pytest

from jobs.errors import JobGone
from jobs.store import JobStore
from jobs.stored_input import StoredInput
from schemas.messages import JobRequest


def test_one_content_under_two_names_outlives_the_first(tmp_path: Path) -> None:
    (tmp_path / "old").write_bytes(b"map")
    StoredInput(tmp_path / "old").give(tmp_path / "new")
    assert (tmp_path / "old").samefile(tmp_path / "new")
    (tmp_path / "old").unlink()
    assert (tmp_path / "new").read_bytes() == b"map"


@pytest.mark.parametrize("code", [errno.EXDEV, errno.EPERM, errno.EMLINK])
def test_where_a_file_has_one_name_only_it_is_copied(
    code: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> None:
        raise OSError(code, os.strerror(code))

    monkeypatch.setattr(os, "link", refuse)
    (tmp_path / "old").write_bytes(b"map")
    StoredInput(tmp_path / "old").give(tmp_path / "new")
    assert not (tmp_path / "old").samefile(tmp_path / "new")
    assert (tmp_path / "new").read_bytes() == b"map"


def test_a_full_disk_is_not_taken_for_one_without_links(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "link", refuse)
    (tmp_path / "old").write_bytes(b"map")
    with pytest.raises(OSError, match="No space"):
        StoredInput(tmp_path / "old").give(tmp_path / "new")


def test_inputs_erased_meanwhile_leave_no_new_job(
    store: JobStore, request_: JobRequest, tmp_path: Path
) -> None:
    gone = StoredInput(tmp_path / "erased")
    with pytest.raises(JobGone):
        store.folder(request_.job_id).create(request_, {"sax.nii": gone})
    assert list(store.root.iterdir()) == []
