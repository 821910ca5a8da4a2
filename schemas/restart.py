"""Doing a job anew: what may be said about it, and what becomes of its options."""

from typing import Any

from pydantic import Field

from schemas.base import WireModel
from schemas.options import Options, Preset, under


class RestartRequest(WireModel):
    """The body of `POST /v1/jobs/{job_id}/restart`; it may be left out."""

    options: dict[str, Any] = Field(
        default_factory=dict,
        description="Options to change, as in `Options`; of a group (`mesh`, `loss`, ...) only "
        "what it names. Everything else is as the job had it.",
    )


class RestartedOptions(WireModel):
    """The options of the new job, to be judged under the names that the caller used."""

    options: Options


def options_as_chosen(options: Options) -> dict[str, Any]:
    """What a request would have to name to get `options`: the preset, and what differs from it.

    So that a change of the preset changes what the preset had filled in, and nothing else.
    """
    preset = Options(preset=Preset(options.preset)).model_dump(mode="json")
    chosen: dict[str, Any] = {"preset": options.preset.value}
    for name, value in options.model_dump(mode="json").items():
        if isinstance(value, dict):
            value = {key: v for key, v in value.items() if v != preset[name][key]}
            if not value:
                continue
        if value != preset[name]:
            chosen[name] = value
    return chosen


def changed_options(options: Options, change: RestartRequest) -> dict[str, Any]:
    """`options` with the change over them, as a request would name them. Not yet judged."""
    return under(options_as_chosen(options), change.options)
