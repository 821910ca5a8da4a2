"""Origins of pages, as a setting lists them."""

import re

OFF = "off"

_ORIGIN = re.compile(r"https?://(?:[a-z0-9.-]+|\[[0-9a-f:.]+\])(?::[0-9]{1,5})?")


def parse_origins(text: str) -> tuple[str, ...]:
    """The origins in `text`, separated by spaces; none where it is `off`.

    Raises ValueError for what is no exact origin: a pattern, a path, `null`.
    """
    if text.strip() == OFF:
        return ()
    origins = tuple(text.split())
    for origin in origins:
        if not _ORIGIN.fullmatch(origin):
            raise ValueError(
                f"{origin!r} is no exact origin; write it as https://viewer.example.org, in small "
                f"letters, without path or trailing slash, several separated by spaces, or {OFF}"
            )
    return origins
