"""Ports of this machine: one that is free, whether one is taken, and who reaches it."""

import ipaddress
import socket

from schemas.problem import InputError, ProblemType


def free_port() -> int:
    """A port of the loopback that nobody listens on now."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port


def refuse_taken_port(host: str, port: int) -> None:
    """Raise InputError where nobody can listen on this address."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with socket.socket(family) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except OSError as error:
            raise InputError(
                ProblemType.INVALID_REQUEST,
                f"cannot listen on {host} port {port}: {error.strerror}; "
                "choose another with --port or --host",
            ) from error


def refuse_remote_host(host: str) -> None:
    """Raise InputError for an address that other machines may reach: no caller would be known.

    A name is no loopback but for `localhost`.
    """
    try:
        is_loopback = ipaddress.ip_address(host).is_loopback
    except ValueError:
        is_loopback = host == "localhost"
    if not is_loopback:
        raise InputError(
            ProblemType.INVALID_REQUEST,
            f"other machines may reach {host}, and the service asks for no keys: whoever reaches "
            "it reads and erases every job. Make a key with `neuralmri keys create`, listen on "
            "127.0.0.1 behind a proxy that authenticates, or add --allow-remote on a network where "
            "all may",
        )
