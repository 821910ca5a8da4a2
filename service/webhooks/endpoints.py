"""The registered endpoints, on disk.

    <root>/<endpoint id>/endpoint.json   mode 0600: it holds the secrets
                         deliveries/     see `outbox.py`

Redis knows nothing of them. Every change is made under one lock, and shown by one rename.
"""

import os
import re
import shutil
from collections.abc import Callable
from pathlib import Path

from jobs.durable import sync_folder
from service.webhooks.endpoint import ENDPOINT_ID_PATTERN, Endpoint
from service.webhooks.private_file import create_private, locked, replace_private

_ID = re.compile(ENDPOINT_ID_PATTERN)
_ERASED = ".erased-"


class TooManyEndpoints(Exception):  # noqa: N818 - it reads as what happened
    """The owner has as many as are allowed."""


class Endpoints:
    """The folder of endpoints. Made where it is missing, readable by its owner only."""

    def __init__(self, root: Path) -> None:
        self.root = root
        root.mkdir(mode=0o700, parents=True, exist_ok=True)

    def add(self, endpoint: Endpoint, most: int) -> None:
        """Store a new endpoint. Raises TooManyEndpoints where its owner has `most` already."""
        with locked(self.root):
            if len(self.of_owner(endpoint.owner)) >= most:
                raise TooManyEndpoints
            folder = self.root / endpoint.id
            folder.mkdir(mode=0o700)
            (folder / "deliveries").mkdir(mode=0o700)
            create_private(folder / "endpoint.json", endpoint.model_dump_json().encode())
            sync_folder(self.root)

    def get(self, endpoint_id: str) -> Endpoint | None:
        """The endpoint; None for an unknown id, malformed ones included."""
        if not _ID.fullmatch(endpoint_id):
            return None
        try:
            content = (self.root / endpoint_id / "endpoint.json").read_bytes()
        except FileNotFoundError:
            return None
        return Endpoint.model_validate_json(content)

    def all(self) -> list[Endpoint]:
        """Every endpoint, oldest first."""
        names = [entry.name for entry in os.scandir(self.root) if _ID.fullmatch(entry.name)]
        found = [endpoint for name in names if (endpoint := self.get(name))]
        return sorted(found, key=lambda endpoint: (endpoint.created_at, endpoint.id))

    def of_owner(self, owner: str) -> list[Endpoint]:
        return [endpoint for endpoint in self.all() if endpoint.owner == owner]

    def change(self, endpoint_id: str, step: Callable[[Endpoint], Endpoint]) -> Endpoint | None:
        """Take a step and return what the endpoint is then; None for one that is gone."""
        with locked(self.root):
            before = self.get(endpoint_id)
            if before is None:
                return None
            after = step(before)
            if after != before:
                path = self.root / endpoint_id / "endpoint.json"
                replace_private(path, after.model_dump_json().encode())
            return after

    def remove(self, endpoint_id: str) -> None:
        """Forget an endpoint and its deliveries. Nothing happens where there is none."""
        if not _ID.fullmatch(endpoint_id):
            return
        grave = self.root / f"{_ERASED}{endpoint_id}-{os.urandom(6).hex()}"
        with locked(self.root):
            try:
                (self.root / endpoint_id).rename(grave)
            except FileNotFoundError:
                return
            sync_folder(self.root)
        shutil.rmtree(grave, ignore_errors=True)  # `sweep` takes what is left

    def sweep(self) -> None:
        """Remove what a crash left of removals half done, and of registrations never shown."""
        with locked(self.root):
            for entry in os.scandir(self.root):
                unborn = _ID.fullmatch(entry.name) and self.get(entry.name) is None
                if unborn or entry.name.startswith(_ERASED):
                    shutil.rmtree(entry.path, ignore_errors=True)
