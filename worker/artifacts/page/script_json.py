"""Values inside a <script>, where the browser looks for tags before it looks for strings."""

import json
from typing import Any

from markupsafe import Markup

# As JSON itself writes them: the value stays the same, and nothing in it ends the script. The last
# two end a line in JavaScript, though not in JSON.
_ESCAPED = {c: f"\\u{ord(c):04x}" for c in "<>&\u2028\u2029"}


def script_json(value: Any) -> Markup:
    """`value` as JSON without a character that HTML could take for its own.

    Raises ValueError for NaN and infinities: JSON has none.
    """
    text = json.dumps(value, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
    for character, escape in _ESCAPED.items():
        text = text.replace(character, escape)
    return Markup(text)  # noqa: S704  it holds no < any more
