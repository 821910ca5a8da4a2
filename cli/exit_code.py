"""What an error means for the exit code: 1 our fault, 2 bad input."""

from schemas.problem import InputError, ServiceError

EXIT_OUR_FAULT = 1
EXIT_BAD_INPUT = 2


def exit_code(error: ServiceError) -> int:
    """The code that a command ends with."""
    return EXIT_BAD_INPUT if isinstance(error, InputError) else EXIT_OUR_FAULT
