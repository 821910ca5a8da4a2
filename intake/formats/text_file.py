"""The lines of a text file, with their numbers."""

from collections.abc import Iterator

from intake.formats.faults import unreadable


def numbered_lines(name: str, content: bytes) -> Iterator[tuple[int, str]]:
    """Every line that is not blank, its number from 1. Raises InputError for what is no UTF-8."""
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise unreadable(
            name, "this is no text in UTF-8", "send the text file as it was written"
        ) from error
    # Not splitlines(): form feeds and other separators are not line ends to an editor.
    for number, line in enumerate(text.replace("\r\n", "\n").split("\n"), start=1):
        if line.strip():
            yield number, line


def fields(line: str) -> list[str]:
    """The values of a line: between tabs, else between commas, else between blanks."""
    separator = "\t" if "\t" in line else "," if "," in line else None
    return [value.strip() for value in line.split(separator)]
