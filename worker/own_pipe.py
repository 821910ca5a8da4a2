"""Objects over a pipe between two of our own processes.

`Connection.send` would hand tensors over as shared memory, by a server of its own in the sender:
here everything goes by value.
"""

import pickle  # noqa: TID251  between our own processes, over a pipe that nobody else has
from multiprocessing.connection import Connection
from typing import Any


def send(pipe: Connection, what: Any) -> None:
    """Raises OSError where nobody is at the other end."""
    pipe.send_bytes(pickle.dumps(what, protocol=pickle.HIGHEST_PROTOCOL))


def receive(pipe: Connection) -> Any:
    """The next object, once it is there. Raises EOFError or OSError where nobody sends any more."""
    return pickle.loads(pipe.recv_bytes())  # noqa: S301  as above
