"""Which addresses a message may be sent to: public ones, and those that the operator names."""

from dataclasses import dataclass
from ipaddress import IPv4Address, IPv4Network, IPv6Address, IPv6Network, ip_address, ip_network

Network = IPv4Network | IPv6Network

# `is_global` of Python 3.11 lets some of these through. Of IPv6 only what is routed at all is
# public: that leaves out loopback, unique local, link-local, mapped IPv4 and NAT64.
_ROUTED_V6 = ip_network("2000::/3")
_NOT_PUBLIC: tuple[Network, ...] = tuple(
    ip_network(text)
    for text in (
        *("0.0.0.0/8", "10.0.0.0/8", "100.64.0.0/10", "127.0.0.0/8", "169.254.0.0/16"),
        *("172.16.0.0/12", "192.0.0.0/24", "192.0.2.0/24", "192.88.99.0/24", "192.168.0.0/16"),
        *("198.18.0.0/15", "198.51.100.0/24", "203.0.113.0/24", "224.0.0.0/4", "240.0.0.0/4"),
        # Teredo and its neighbours, examples, and 6to4, which has any IPv4 address inside.
        *("2001::/23", "2001:db8::/32", "2002::/16", "3fff::/20"),
    )
)


@dataclass(frozen=True)
class TargetRules:
    """What an operator allows.

    allow: networks that may be sent to although they are not public.
    """

    http: bool = False
    high_ports: bool = False
    allow: tuple[Network, ...] = ()

    def permit_port(self, port: int) -> bool:
        return port in (80, 443) or (self.high_ports and 1024 <= port <= 65535)

    def permit_address(self, text: str) -> bool:
        """Whether to connect there; what is no address is not permitted."""
        try:
            address = ip_address(text)
        except ValueError:
            return False
        return _is_in(address, self.allow) or _is_public(address)


def _is_public(address: IPv4Address | IPv6Address) -> bool:
    if address.version == 6 and address not in _ROUTED_V6:
        return False
    return address.is_global and not _is_in(address, _NOT_PUBLIC)


def _is_in(address: IPv4Address | IPv6Address, networks: tuple[Network, ...]) -> bool:
    return any(address.version == network.version and address in network for network in networks)
