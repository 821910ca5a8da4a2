"""A heart of the same proportions and another size."""

from dataclasses import fields, replace

from worker.phantom.contraction import layout
from worker.phantom.shape import HeartShape


def of_edv(shape: HeartShape, edv_ml: float) -> HeartShape:
    """`shape` with all its lengths scaled so that the LV cavity holds `edv_ml` at end-diastole.

    Raises InputError where a length leaves its bounds.
    """
    parts = layout(shape, 0.0)
    scale = (edv_ml / parts.lv_inner.volume_below_ml(parts.base_mm)) ** (1.0 / 3.0)
    lengths = [item.name for item in fields(shape) if item.name.endswith("_mm")]
    return replace(shape, **{name: scale * getattr(shape, name) for name in lengths})
