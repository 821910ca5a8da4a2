"""How every wire model behaves: unknown keys refused, values frozen, numbers finite, and a faulty
value kept out of what an error says of it: that may be logged.
"""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, StringConstraints


class WireModel(BaseModel):
    """A value that crosses a wire."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, allow_inf_nan=False, hide_input_in_errors=True
    )


Name = Annotated[
    str,
    StringConstraints(pattern=r"^[A-Za-z0-9._-]{1,64}$"),
]
"""An identifier that is also safe as part of a file name."""

FOLDER_NAME_PATTERN = r"^[A-Za-z0-9_][A-Za-z0-9._-]{0,63}$"

FolderName = Annotated[str, StringConstraints(pattern=FOLDER_NAME_PATTERN)]
"""A name that may be a folder's: it does not begin with a dot or a hyphen."""
