"""Whether a service that starts now would ask its callers for keys or tokens."""

from pathlib import Path

from service.keys.key_file import KeyFile
from service.settings import ServiceSettings


def asks_for_keys(data_dir: Path) -> bool:
    """As the setting says; where it says nothing, whether a key exists or an issuer is named."""
    settings = ServiceSettings(data_dir=data_dir)
    if settings.require_keys is None:
        return settings.takes_tokens or KeyFile(data_dir).has_had_keys()
    return settings.require_keys
