"""Settings from files: for what should stand in no environment."""

from pathlib import Path

import pytest

from jobs.settings import JobSettings


def test_a_file_gives_what_the_environment_does_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "neuralmri_redis_url").write_text("redis://:secret@redis:6379/0\n")
    (tmp_path / "neuralmri_max_attempts").write_text("7")
    (tmp_path / "password").write_text("of somebody else")
    monkeypatch.setenv("NEURALMRI_SECRETS_DIR", str(tmp_path))
    assert JobSettings().redis_url == "redis://:secret@redis:6379/0"
    assert JobSettings().max_attempts == 7
    monkeypatch.setenv("NEURALMRI_MAX_ATTEMPTS", "5")
    assert JobSettings().max_attempts == 5, "the environment goes first"
    assert JobSettings(max_attempts=4).max_attempts == 4


def test_a_folder_that_is_not_there_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NEURALMRI_SECRETS_DIR", str(tmp_path / "gone"))
    with pytest.raises(NotADirectoryError, match="NEURALMRI_SECRETS_DIR"):
        JobSettings()
