"""What the command line was given, as the reading that the pipeline takes."""

from typing import TYPE_CHECKING

from cli.inputs import ContourInput, LabelInput

if TYPE_CHECKING:
    from intake.limits import Limits
    from worker.reading import Reading


def reading_of(given: ContourInput | LabelInput, limits: "Limits") -> tuple["Reading", str]:
    """The reading, and where its study stands in what was given. Raises InputError.

    Loads numpy and more: the threads must be bound before.
    """
    from worker.reading import read_contours, read_labels, with_references

    if isinstance(given, ContourInput):
        reading, pointer = read_contours(given.request), given.pointer
    else:
        reading, pointer = read_labels(given.files, given.request, limits), "/study"
    return with_references(reading, given.references, limits, pointer=pointer), pointer
