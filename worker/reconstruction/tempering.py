"""The noisier the outlines, the more slowly the field learns them, and the less each one weighs.

A slow field takes up what many slices agree on before what one hand drew: stopping early is a
smoothness prior. Exact outlines are followed as closely as the options say.
"""

from schemas.options import Options

_SLOWEST = 0.1
"""Least share of the learning rate: slower, and the field has not arrived when it ends."""


def tempered(options: Options, noise: float) -> Options:
    """The options with a learning rate and a contour weight that suit `noise`.

    noise: standard deviation of outlines, unit lengths. It is measured against the last level's
    radius, closer than which no sample tells inside from outside anyway.
    """
    closeness = 1.0 / (1.0 + (noise / options.sampling.last_radius) ** 2)
    optimizer, loss = options.optimizer, options.loss
    rate = optimizer.learning_rate * max(closeness, _SLOWEST)
    # Never below that of a sample inside or outside, unless it was asked for.
    weight = max(loss.contour_weight * closeness, min(loss.contour_weight, 1.0))
    return options.model_copy(
        update={
            "optimizer": optimizer.model_copy(update={"learning_rate": rate}),
            "loss": loss.model_copy(update={"contour_weight": weight}),
        }
    )
