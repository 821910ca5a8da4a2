from ipaddress import ip_network

import httpx
import pytest

from service.webhooks.target import (
    TargetRefused,
    checked_url,
    permitted_addresses,
    system_addresses,
)
from service.webhooks.target_rules import TargetRules

STRICT = TargetRules()
PUBLIC = ["93.184.215.14", "8.8.8.8", "2606:2800:21f:cb07:6820:80da:af6b:8b2c", "2a00:1450::1"]
NOT_PUBLIC = [
    *("127.0.0.1", "127.255.255.254", "0.0.0.1", "0.1.2.3", "10.0.0.1", "172.16.0.1"),
    *("172.31.255.255", "192.168.1.1", "169.254.169.254", "169.254.0.1", "100.64.0.1"),
    *("100.100.100.200", "100.127.255.255", "192.0.0.192", "192.0.0.9", "192.0.2.1"),
    *("192.88.99.1", "198.18.0.1", "198.51.100.7", "203.0.113.7", "224.0.0.1", "239.255.255.250"),
    *("240.0.0.1", "255.255.255.255"),
    *("::", "::1", "::127.0.0.1", "::ffff:127.0.0.1", "::ffff:169.254.169.254"),
    *("::ffff:8.8.8.8", "64:ff9b::7f00:1", "64:ff9b::a9fe:a9fe", "64:ff9b:1::1"),
    *("2002:7f00:1::", "2002:a9fe:a9fe::1", "2001::1", "2001:db8::1", "3fff::1", "100::1"),
    *("fc00::1", "fd00:ec2::254", "fe80::1", "fe80::1%eth0", "fec0::1", "ff02::1", "ff0e::1"),
    *("5f00::1", "nonsense", ""),
]


def resolving_to(*addresses: str) -> list[str]:
    url = checked_url("https://hooks.example.org/", STRICT)
    return permitted_addresses(url, STRICT, lambda _host, _port: list(addresses))


@pytest.mark.parametrize("address", PUBLIC)
def test_public_addresses_are_permitted(address: str) -> None:
    assert resolving_to(address) == [address]


@pytest.mark.parametrize("address", NOT_PUBLIC)
def test_everything_else_is_refused_even_beside_public_ones(address: str) -> None:
    for addresses in ([address], [PUBLIC[0], address]):
        with pytest.raises(TargetRefused, match="does not lead to public"):
            resolving_to(*addresses)


@pytest.mark.parametrize(
    "host",
    [
        *("127.0.0.1", "127.1", "2130706433", "0x7f000001", "0177.0.0.1", "0", "[::1]"),
        *("[::ffff:127.0.0.1]", "[::ffff:7f00:1]", "localhost", "LOCALHOST.", "169.254.169.254"),
        *("[64:ff9b::7f00:1]", "0x7f.1"),
        "①②⑦.⓪.⓪.①",
    ],
)
def test_every_spelling_of_loopback_is_refused_by_the_real_resolver(host: str) -> None:
    with pytest.raises(TargetRefused):
        permitted_addresses(checked_url(f"https://{host}/", STRICT), STRICT, system_addresses)


def test_a_name_that_cannot_be_found_is_refused_in_the_same_words() -> None:
    def unknown(_host: str, _port: int) -> list[str]:
        raise OSError("Name or service not known")

    url = checked_url("https://hooks.example.org/", STRICT)
    with pytest.raises(TargetRefused) as unknown_name:
        permitted_addresses(url, STRICT, unknown)
    with pytest.raises(TargetRefused) as private_name:
        resolving_to("10.0.0.1")
    assert str(unknown_name.value) == str(private_name.value)


@pytest.mark.parametrize(
    "url",
    [
        *(
            "http://hooks.example.org/",
            "ftp://hooks.example.org/",
            "file:///etc/passwd",
            "gopher://x",
        ),
        *("hooks.example.org", "//hooks.example.org/", "https://", "https:///path", "", "https:"),
        *("https://user:secret@hooks.example.org/", "https://user@hooks.example.org/"),
        *("https://hooks.example.org/#part", "https://hooks.example.org:22/"),
        *("https://hooks.example.org:6379/", "https://hooks.example.org:8443/"),
        *("https://hooks.example.org:0/", "https://hooks.example.org:99999/"),
        *("https://a b/", "https://[::1%25eth0]/", "https://hooks.example.org\r\nX: y/"),
        *("https://hooks.example.org:x/", "https://-/", "https://[fe80::1/", "unix:///run/x.sock"),
    ],
)
def test_urls_that_are_refused_by_their_words(url: str) -> None:
    with pytest.raises(TargetRefused, match="Remedy: "):
        checked_url(url, STRICT)


@pytest.mark.parametrize(
    "url",
    [
        *("https://hooks.example.org", "https://hooks.example.org:443/a?b=c", "HTTPS://HOOKS.org/"),
        *("https://my_hooks.example.org:80/", "https://bücher.example/", "https://8.8.8.8/"),
        "https://[2606:2800:21f:cb07:6820:80da:af6b:8b2c]/",
    ],
)
def test_urls_that_are_fit(url: str) -> None:
    assert isinstance(checked_url(url, STRICT), httpx.URL)


def test_what_an_operator_may_open() -> None:
    rules = TargetRules(http=True, high_ports=True, allow=(ip_network("10.1.0.0/16"),))
    for url in ("http://hooks.local/", "http://hooks.local:8080/", "https://hooks.local:65535/"):
        checked_url(url, rules)
    for url in ("http://hooks.local:22/", "http://hooks.local:1023/", "http://hooks.local:65536/"):
        with pytest.raises(TargetRefused):
            checked_url(url, rules)
    assert rules.permit_address("10.1.2.3")
    assert not rules.permit_address("10.2.0.1")
    assert not rules.permit_address("::ffff:10.1.2.3")
