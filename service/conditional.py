"""Conditional requests: RFC 9110, section 13.1.2."""


def is_unmodified(if_none_match: str | None, etag: str) -> bool:
    """Whether `If-None-Match` names the quoted `etag`, by weak comparison."""
    if if_none_match is None:
        return False
    if if_none_match.strip() == "*":
        return True
    return etag in (tag.strip().removeprefix("W/") for tag in if_none_match.split(","))
