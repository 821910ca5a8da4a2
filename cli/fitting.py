"""A server's documents as the models that they should fit."""

from typing import Any, TypeVar

from pydantic import ValidationError

from schemas.base import WireModel
from schemas.problem import InternalError, ProblemType

M = TypeVar("M", bound=WireModel)


def fitting(model: type[M], document: Any) -> M:
    """Raises InternalError where it does not fit."""
    try:
        return model.model_validate(document)
    except ValidationError as error:
        raise InternalError(
            ProblemType.INTERNAL,
            f"the server answered with something else than a {model.__name__.lower()}; is it a "
            "neuralmri server, and of this version?",
        ) from error
