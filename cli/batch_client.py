"""Batches of a server, through a client of it."""

import time
import uuid
from collections.abc import Callable
from pathlib import Path
from typing import Any

from cli.client import Client
from schemas.batch import Batch, MemberState
from schemas.problem import InternalError, ProblemType

_POLL_EVERY_S = 0.5
_PAGE = 1000


class BatchClient:
    """Every method raises InputError or InternalError, as the server's problem says."""

    def __init__(self, client: Client) -> None:
        self._client = client

    def submit(self, body: dict[str, Any]) -> Batch:
        """Send many studies; once, however often the connection breaks on the way."""
        key = {"Idempotency-Key": uuid.uuid4().hex}
        return self._client.get_as(Batch, "POST", "/v1/batches/contours", json=body, headers=key)

    def batch(self, batch_id: str) -> Batch:
        return self._client.get_as(
            Batch, "GET", f"/v1/batches/{batch_id}", params={"limit": str(_PAGE)}
        )

    def cancel(self, batch_id: str) -> Batch:
        return self._client.get_as(Batch, "POST", f"/v1/batches/{batch_id}/cancel")

    def wait(self, batch_id: str, watch: Callable[[Batch], None]) -> Batch:
        """Poll until every job has ended. A server that stays away is asked again for minutes."""
        silent_since_s: float | None = None
        while True:
            try:
                batch = self.batch(batch_id)
            except InternalError as error:
                silent_since_s = silent_since_s or time.monotonic()
                if time.monotonic() - silent_since_s > self._client.patience_s:
                    raise InternalError(
                        ProblemType.UNAVAILABLE,
                        f"batch {batch_id} cannot be followed any more ({error.detail}); it may go "
                        f"on: `neuralmri watch {batch_id}` later",
                    ) from error
            else:
                silent_since_s = None
                watch(batch)
                if batch.ended:
                    return batch
            time.sleep(_POLL_EVERY_S)

    def download(self, batch: Batch, out: Path) -> dict[str, Path]:
        """Fetch the files of each job that succeeded, a folder each; folders by the jobs' ids.

        They are called as in the server's archive. Done again it goes on where it broke off.
        """
        from service.job_archive import archive_folders

        folders = archive_folders((m.job_id, m.name) for m in batch.studies if m.job_id)
        done = [m.job_id for m in batch.studies if m.state is MemberState.SUCCEEDED and m.job_id]
        for job_id in done:
            self._client.download(job_id, out / folders[job_id])
        return {job_id: out / folders[job_id] for job_id in done}
