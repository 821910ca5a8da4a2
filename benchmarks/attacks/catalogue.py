"""Every attack, by what it goes for."""

from collections.abc import Mapping

from benchmarks.attacks import on_identity, on_names, on_protocol, on_resources, on_webhooks
from benchmarks.attacks.target import Attack

CATALOGUE: Mapping[str, tuple[Attack, ...]] = {
    "Being somebody else": on_identity.ATTACKS,
    "Names that lead elsewhere": on_names.ATTACKS,
    "Using the service up": on_resources.ATTACKS,
    "Calls inside the network, messages that are not ours": on_webhooks.ATTACKS,
    "Saying one thing and meaning another": on_protocol.ATTACKS,
}
