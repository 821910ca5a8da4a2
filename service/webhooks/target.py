"""The door against request forgery: a URL in, the very addresses to connect to out.

A name is resolved once for each attempt and every address that it has must be permitted; the
connection is then made to such an address and not to the name, so nothing that the name server says
later counts.
"""

import re
import socket
from collections.abc import Callable
from typing import cast

import httpx

from service.webhooks.target_rules import TargetRules

Resolve = Callable[[str, int], list[str]]
"""The addresses of a host. Raises OSError where it has none."""

_HOST = re.compile(r"^[A-Za-z0-9_]([A-Za-z0-9._-]*[A-Za-z0-9_.])?$|^[0-9A-Fa-f:.]+$")
_DEFAULT_PORTS = {"https": 443, "http": 80}


class TargetRefused(Exception):  # noqa: N818 - it reads as what happened
    """Not to be sent to. The text says why and what to do, and nothing about our network."""


def system_addresses(host: str, port: int) -> list[str]:
    """What the machine's own resolver says, the preferred address first."""
    found = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM, proto=socket.IPPROTO_TCP)
    return list(dict.fromkeys(cast(str, entry[4][0]) for entry in found))


def checked_url(text: str, rules: TargetRules) -> httpx.URL:
    """The URL, if its own words permit sending there. Raises TargetRefused."""
    try:
        url = httpx.URL(text)
        host = url.raw_host.decode("ascii")
    except (httpx.InvalidURL, UnicodeError) as error:
        raise TargetRefused(f"it is no URL ({error}). Remedy: send it percent-encoded.") from error
    if url.scheme != "https" and not (rules.http and url.scheme == "http"):
        raise TargetRefused("its scheme is not https. Remedy: serve the endpoint over https.")
    if url.userinfo:
        raise TargetRefused(
            "it holds credentials. Remedy: leave them out; the signature says who sends."
        )
    if url.fragment:
        raise TargetRefused("it has a fragment. Remedy: leave out the part from # on.")
    if not _HOST.match(host):
        raise TargetRefused("it names no host. Remedy: send it as https://host/path.")
    if not rules.permit_port(port_of(url)):
        raise TargetRefused(
            "its port is not permitted. Remedy: listen on 443, or have the operator set "
            "NEURALMRI_WEBHOOK_HIGH_PORTS."
        )
    return url


def permitted_addresses(url: httpx.URL, rules: TargetRules, resolve: Resolve) -> list[str]:
    """Where to connect to, best first. Raises TargetRefused.

    A host that cannot be found and one that leads into a private network get the same words: who
    registers endpoints shall not learn which names we can resolve.
    """
    try:
        addresses = resolve(url.raw_host.decode("ascii"), port_of(url))
    except (OSError, UnicodeError):
        addresses = []
    if not addresses or not all(rules.permit_address(address) for address in addresses):
        raise TargetRefused(
            "its host does not lead to public addresses only. Remedy: check the name; for a "
            "network of your own have the operator name it in NEURALMRI_WEBHOOK_ALLOW."
        )
    return addresses


def port_of(url: httpx.URL) -> int:
    """The port that a URL means."""
    return _DEFAULT_PORTS.get(url.scheme, 0) if url.port is None else url.port
