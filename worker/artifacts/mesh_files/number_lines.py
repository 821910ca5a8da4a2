"""Many lines of a few numbers each, as text: all digits of one place at once."""

import numpy as np
from jaxtyping import Int

_ZERO, _MINUS, _POINT, _SPACE, _NEWLINE = b"0-. \n"


def number_lines(letter: str, numbers: Int[np.ndarray, "n k"], decimals: int = 0) -> bytes:
    """A line for each row, as in `v -1.500000 0.000000 12.250000`.

    letter: one, at the beginning of each line. numbers: in units of the last of `decimals` places.
    """
    rows, columns = numbers.shape
    sizes = np.abs(numbers)
    whole = sizes // 10**decimals
    places = len(str(int(whole.max(initial=0))))
    point = decimals > 0
    width = 2 + places + point + decimals
    # Every number as wide as the widest, after a space and room for its sign.
    characters = np.empty((rows, columns, width), dtype=np.uint8)
    kept = np.ones((rows, columns, width), dtype=bool)
    characters[..., 0] = _SPACE
    characters[..., 1] = _MINUS
    kept[..., 1] = numbers < 0
    for place in range(1, places):
        kept[..., 1 + places - place] = whole >= 10**place
    if point:
        characters[..., 2 + places] = _POINT
    left = sizes
    for place in range(decimals + places):
        rest = left // 10
        at = width - 1 - place - (1 if point and place >= decimals else 0)
        characters[..., at] = _ZERO + (left - 10 * rest)
        left = rest
    text = np.empty((rows, 2 + columns * width), dtype=np.uint8)
    shown = np.ones_like(text, dtype=bool)
    text[:, 0], text[:, -1] = ord(letter), _NEWLINE
    text[:, 1:-1] = characters.reshape(rows, columns * width)
    shown[:, 1:-1] = kept.reshape(rows, columns * width)
    return text[shown].tobytes()
