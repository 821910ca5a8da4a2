"""An answer that is a stored file, whole or in ranges, wherever it is kept."""

import os
import stat
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager

import anyio
from starlette.responses import FileResponse

from jobs.stored_file import StoredFile


class StoredFileResponse(FileResponse):
    """Starlette's own answer, which knows Range and If-Range, over any StoredFile.

    The file is read in pieces, each in a thread: neither memory nor the event loop holds it.
    """

    def __init__(
        self,
        file: StoredFile,
        *,
        filename: str,
        media_type: str,
        headers: Mapping[str, str],
        is_shown: bool,
    ) -> None:
        self._file = file
        size, modified_at_s = file.bytes, int(file.modified_at_s)
        super().__init__(
            filename,
            headers=headers,
            media_type=media_type,
            filename=filename,
            stat_result=os.stat_result(
                (stat.S_IFREG, 0, 0, 1, 0, 0, size, modified_at_s, modified_at_s, modified_at_s)
            ),
            content_disposition_type="inline" if is_shown else "attachment",
        )

    @asynccontextmanager
    async def _open_file(self) -> AsyncIterator[anyio.AsyncFile[bytes]]:
        file = anyio.wrap_file(await anyio.to_thread.run_sync(self._file.open))
        try:
            yield file
        finally:
            # Closing must finish even when the transfer is cancelled.
            with anyio.CancelScope(shield=True):
                await file.aclose()
