"""Some frames of a cycle, for a run that is to be short."""


def spread_out(count: int, wanted: int | None) -> list[int]:
    """`wanted` of `count` frames evenly over the cycle, the first among them; all where None."""
    if wanted is None or wanted >= count:
        return list(range(count))
    return [count * k // wanted for k in range(wanted)]
