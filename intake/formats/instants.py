"""Which contours are of the same instant: by name, by the images' time, or by file."""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from intake.formats.clinical_faults import unusable
from intake.formats.found_contour import FoundContour
from intake.formats.image_geometry import Images

SAME_INSTANT_MS = 12.0
"""Trigger times of one instant differ less than this from one to the next; frames of a cine lie
20 ms apart or more."""

_BY_TABLE = (
    "send a geometry table with `temporal_position`, or mark the names of regions with ED and ES"
)


@dataclass(frozen=True, eq=False)
class Instant:
    """A frame to be: its label, its time where it is known, and its contours."""

    label: str
    time_ms: float | None
    contours: list[FoundContour]


def instants(contours: Sequence[FoundContour], images: Images) -> tuple[list[Instant], list[str]]:
    """Contours by instant, in the order of the cycle, and what had to be left out.

    In this order: labels that the contours bring (as soon as one has one), temporal positions of
    their images, trigger times of their images; contours with none of them are one instant.

    Raises:
        InputError: images that say nothing of time, or not enough.
    """
    labelled = [c for c in contours if c.instant is not None]
    if labelled:
        rest = len(contours) - len(labelled)
        left = [f"{rest} contours are of no named instant and were left out."] if rest else []
        return _by_label(labelled, images), left
    known = [images.get(c.image) for c in contours]
    if all(image is not None and image.temporal_position is not None for image in known):
        return _grouped(contours, images, lambda i: f"t{images[i].temporal_position:02d}"), []
    if all(image is not None and image.trigger_ms is not None for image in known):
        return _by_trigger(contours, images), []
    return [Instant("t00", None, list(contours))], []


def _by_label(contours: Sequence[FoundContour], images: Images) -> list[Instant]:
    """ED before ES, files in their order: as their labels sort."""
    groups: dict[str, list[FoundContour]] = {}
    for contour in contours:
        groups.setdefault(contour.instant or "", []).append(contour)
    return [
        Instant(label, _time_ms(group, images), group) for label, group in sorted(groups.items())
    ]


def _by_trigger(contours: Sequence[FoundContour], images: Images) -> list[Instant]:
    times = np.unique([images[c.image].trigger_ms or 0.0 for c in contours])
    number = np.concatenate([[0], np.cumsum(np.diff(times) > SAME_INSTANT_MS)])
    label = {time: f"t{n:02d}" for time, n in zip(times.tolist(), number.tolist(), strict=True)}
    return _grouped(contours, images, lambda i: label[images[i].trigger_ms or 0.0])


def _grouped(
    contours: Sequence[FoundContour], images: Images, label: Callable[[str], str]
) -> list[Instant]:
    groups: dict[str, list[FoundContour]] = {}
    for contour in contours:
        groups.setdefault(label(contour.image), []).append(contour)
    ordered = sorted(groups, key=lambda name: int(name[1:]))
    return [Instant(name, _time_ms(groups[name], images), groups[name]) for name in ordered]


def _time_ms(contours: Sequence[FoundContour], images: Images) -> float | None:
    times = [images[c.image].trigger_ms for c in contours if c.image in images]
    known = [time for time in times if time is not None]
    return float(np.median(known)) if known and len(known) == len(times) else None


def check_one_image_a_plane(instant: Instant, planes: Sequence[int]) -> None:
    """Refuse a structure outlined on two images of one plane in one instant.

    `planes` has the plane of each of the instant's contours.

    Raises:
        InputError: it is of two instants, and nothing says which is which.
    """
    drawn = {
        (c.structure, plane, c.image)
        for c, plane in zip(instant.contours, planes, strict=True)
        if c.image
    }
    twice = [key for key, n in Counter((s, p) for s, p, _ in drawn).items() if n > 1]
    if twice:
        structure = twice[0][0]
        raise unusable(
            f"{structure} is outlined on several images of {len(twice)} planes, and nothing "
            "says of which instants they are",
            f"send the images' headers too, {_BY_TABLE}",
        )
