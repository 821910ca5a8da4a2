"""The helper's own end: `python -m worker.helper_main PIPE PARENT THREADS`. See `worker.helper`."""

import sys
import time
import traceback
from multiprocessing.connection import Connection

from schemas.job import Progress
from worker.helper import Advanced, Done, Failed, Held, Load, Ready, Save, Stop
from worker.own_pipe import receive, send
from worker.parent_death import die_with_parent
from worker.threads import bind_libraries, use_threads

_TELL_EVERY_S = 0.2


def main(pipe: int, parent_pid: int, threads: int) -> None:
    """Do parts until the parent closes the pipe."""
    die_with_parent(parent_pid)
    bind_libraries(threads)
    use_threads(threads)
    # While the parent is busy: by the time that there is a part to do, all is loaded.
    import worker.reconstruction.pipeline
    import worker.subject  # noqa: F401

    with Connection(pipe) as connection:
        send(connection, Ready())
        while True:
            try:
                part = receive(connection)
            except EOFError:
                return
            if isinstance(part, Stop):
                # Of the part before, which was done already.
                continue
            parent = _Parent(connection)
            try:
                result = part.done(parent, parent)
            except Exception as error:  # noqa: BLE001  the parent raises it
                error.add_note(traceback.format_exc())
                send(connection, Failed(error))
            else:
                send(connection, Done(result))


class _Parent:
    """The parent's observer and checkpoints, from here."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._tell_at_s = 0.0
        self._is_stopped = False

    def advanced(self, progress: Progress) -> None:
        now_s = time.monotonic()
        if now_s >= self._tell_at_s or progress.is_taken_up:
            self._tell_at_s = now_s + _TELL_EVERY_S
            send(self._connection, Advanced(progress))

    def is_cancelled(self) -> bool:
        while self._connection.poll():
            self._heed(receive(self._connection))
        return self._is_stopped

    def load(self, key: str) -> bytes | None:
        send(self._connection, Load(key))
        while not isinstance(answer := receive(self._connection), Held):
            self._heed(answer)
        return answer.content

    def save(self, key: str, content: bytes) -> None:
        send(self._connection, Save(key, content))

    def _heed(self, _: Stop) -> None:
        self._is_stopped = True


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
