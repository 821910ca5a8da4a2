import json

import pytest

from worker.artifacts.page.script_json import script_json

HOSTILE = "</script><!-- & \u2028\u2029 \"'\\ é"


def test_the_value_comes_back() -> None:
    value = {"a": [1, 2.5, None, True], HOSTILE: HOSTILE}
    assert json.loads(script_json(value)) == value


def test_nothing_in_it_ends_a_script() -> None:
    text = script_json(HOSTILE)
    assert not set(text) & set("<>&\u2028\u2029")


def test_what_json_has_no_word_for_is_refused() -> None:
    with pytest.raises(ValueError, match="JSON"):
        script_json(float("nan"))
