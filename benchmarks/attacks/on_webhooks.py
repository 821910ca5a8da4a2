"""Having the service call inside its own network, or a receiver believe what it did not send."""

import re
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from benchmarks.attacks.target import Attack, Target, all_of, told
from service.webhooks.signature import new_secret, signed_headers
from service.webhooks.target import TargetRefused, checked_url, permitted_addresses
from service.webhooks.target_rules import TargetRules

_DOCUMENT = Path(__file__).parents[2] / "docs" / "webhooks.md"

_LOOPBACK = (
    *("127.0.0.1", "127.1", "127.0.0.1.", "2130706433", "0x7f000001", "0x7f.1", "0177.0.0.1", "0"),
    *("localhost", "LOCALHOST.", "[::1]", "[::]", "[0:0:0:0:0:0:0:1]", "[::ffff:127.0.0.1]"),
    *("[::ffff:7f00:1]", "[::127.0.0.1]", "[64:ff9b::7f00:1]", "[2002:7f00:1::]"),
)
_INSIDE = (
    *("169.254.169.254", "[fd00:ec2::254]", "100.100.100.200", "10.0.0.1", "172.16.0.1"),
    *("192.168.0.1", "100.64.0.1", "0.0.0.0", "224.0.0.1", "255.255.255.255", "[fe80::1]"),  # noqa: S104 - asked for, not bound
    *("[::ffff:169.254.169.254]", "2852039166", "0xa9fea9fe", "metadata.google.internal"),
)
_FORMS = (
    *(
        "http://example.org/",
        "ftp://example.org/",
        "file:///etc/passwd",
        "gopher://127.0.0.1:6379/",
    ),
    *("//127.0.0.1/", "https://", "https://user@127.0.0.1/", "https://example.org@127.0.0.1/"),
    *("https://127.0.0.1#@example.org/", "https://127.0.0.1\\@example.org/", "https://[::1%25lo]/"),
    *("https://example.org:6379/", "https://example.org:22/", "https://127.0.0.1%00.example.org/"),
    *("https://example.org\r\nX: y/", "javascript:alert(1)", "data:,x", "https:///127.0.0.1/"),
)


def _registered(target: Target, urls: list[str]) -> str:
    return all_of(told(target.ask("POST", "/v1/webhooks", json={"url": url})) for url in urls)


def _name_of(*addresses: str) -> str:
    """What becomes of a name whose server gives these addresses."""
    rules = TargetRules()
    try:
        url = checked_url("https://hooks.example.org/", rules)
        return str(permitted_addresses(url, rules, lambda _host, _port: list(addresses)))
    except TargetRefused:
        return "refused"


def _rebinding(_: Target) -> str:
    """The name server answers a public address once, and then the loopback."""
    answers = iter([["93.184.215.14"], ["127.0.0.1"]])
    asked = []

    def resolve(host: str, _port: int) -> list[str]:
        asked.append(host)
        return next(answers)

    rules = TargetRules()
    url = checked_url("https://hooks.example.org/", rules)
    connected = permitted_addresses(url, rules, resolve)
    try:
        permitted_addresses(url, rules, resolve)
    except TargetRefused:
        return f"connected to {', '.join(connected)}, which was judged; refused at the next attempt"
    return "followed"


def _receiver() -> Callable[..., int]:
    """The receiver that docs/webhooks.md shows."""
    (code,) = re.findall(r"^```python\n(.*?)^```", _DOCUMENT.read_text(), re.M | re.S)
    names: dict[str, Any] = {}
    exec(code, names)  # noqa: S102 - the document's own code is what is tried
    answer: Callable[..., int] = names["answer"]
    return answer


def _signature(ago_s: int = 0, sent: bytes = b"{}", got: bytes = b"{}", times: int = 1) -> str:
    secret, answer = new_secret(), _receiver()
    handled: list[Any] = []
    headers = signed_headers([secret], "msg_1", int(time.time()) - ago_s, sent)
    statuses = [answer(secret, headers, got, handled.append) for _ in range(times)]
    return f"{statuses[-1]}, handled {len(handled)} times"


ATTACKS = (
    Attack(
        f"a webhook to the loopback, {len(_LOOPBACK)} spellings (decimal, octal, hex, mapped)",
        "422 webhook-target-refused",
        lambda t: _registered(t, [f"https://{host}/" for host in _LOOPBACK]),
    ),
    Attack(
        f"a webhook to metadata services and private networks, {len(_INSIDE)} addresses",
        "422 webhook-target-refused",
        lambda t: _registered(t, [f"https://{host}/" for host in _INSIDE]),
    ),
    Attack(
        f"a webhook of another scheme, port or form, {len(_FORMS)} URLs (`user@host`, CRLF, `\\`)",
        "422 webhook-target-refused",
        lambda t: _registered(t, list(_FORMS)),
    ),
    Attack(
        "a name that leads to a private address, alone and beside a public one",
        "refused, refused",
        lambda _: f"{_name_of('10.0.0.1')}, {_name_of('93.184.215.14', '10.0.0.1')}",
    ),
    Attack(
        "a name that leads elsewhere at the second look (rebinding)",
        "connected to 93.184.215.14, which was judged; refused at the next attempt",
        _rebinding,
    ),
    Attack(
        "a genuine message, played back an hour later",
        "400, handled 0 times",
        lambda _: _signature(ago_s=3600),
    ),
    Attack(
        "a genuine message, played back at once",
        "204, handled 1 times",
        lambda _: _signature(times=2),
    ),
    Attack(
        "a message whose body was changed on the way",
        "401, handled 0 times",
        lambda _: _signature(got=b'{"a": 1}'),
    ),
)
