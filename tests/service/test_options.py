"""What may be chosen: told as the code has it, and cheap to ask for again."""

from collections.abc import Callable
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from intake.limits import Limits
from schemas.choices import Choices
from schemas.options import Options, Preset
from service.settings import ServiceSettings
from tests.service.conftest import Api


def choices(api: Api) -> Choices:
    answer = api.client.get("/v1/options")
    assert answer.status_code == 200, answer.text
    return Choices.model_validate(answer.json())


def merged(under: dict[str, Any], over: dict[str, Any]) -> dict[str, Any]:
    return {
        key: merged(under[key], over[key])
        if isinstance(under.get(key), dict) and key in over
        else over.get(key, under.get(key))
        for key in {**under, **over}
    }


@pytest.mark.parametrize("preset", Preset)
def test_defaults_and_preset_together_are_what_a_request_gets(api: Api, preset: Preset) -> None:
    told = choices(api)
    full = Options.model_validate({"preset": preset}).model_dump(mode="json")
    assert merged({**told.defaults, "preset": preset}, told.presets[preset]) == full


def test_the_schema_takes_the_defaults_and_refuses_what_is_out_of_bounds(api: Api) -> None:
    told = choices(api)
    Draft202012Validator.check_schema(told.options)
    schema = Draft202012Validator(told.options)
    assert schema.is_valid(told.defaults)
    assert not schema.is_valid({"levels": 99})
    assert not schema.is_valid({"level": 3})


def test_label_schemes_are_by_view(api: Api) -> None:
    schemes = choices(api).label_schemes
    assert schemes["acdc"]["sax"].lv_cavity == schemes["mnms"]["sax"].rv_cavity == [3]
    assert schemes["biv_me"]["sax"] != schemes["biv_me"]["lax_4ch"]


def test_limits_are_this_service_s_own(
    serve: Callable[[ServiceSettings], Api], settings: ServiceSettings
) -> None:
    api = serve(settings.model_copy(update={"max_points": 1234}))
    limits = choices(api).limits
    assert limits["max_points"] == 1234
    assert limits["max_slices"] == Limits.max_slices


def test_it_is_asked_for_once(api: Api) -> None:
    first = api.client.get("/v1/options")
    assert "max-age" in first.headers["cache-control"]
    again = api.client.get("/v1/options", headers={"If-None-Match": first.headers["etag"]})
    assert (again.status_code, again.content) == (304, b"")
    assert again.headers["etag"] == first.headers["etag"]
    other = api.client.get("/v1/options", headers={"If-None-Match": '"another"'})
    assert other.status_code == 200
