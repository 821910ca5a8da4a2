"""How much one request may hold, counted before any array exists."""

from dataclasses import dataclass

from schemas.problem import InputError, ProblemType
from schemas.study import ContourStudy

_MIB = 2**20


@dataclass(frozen=True)
class Limits:
    """Bounds on a request. Bytes are bytes; everything else is a count.

    The defaults leave room for a dense cine study (25 frames of 18 slices with three contours each)
    and for a 4D label map of a whole heart at 1.5 mm, and keep the memory of one request in the
    hundreds of megabytes.
    """

    max_request_bytes: int = 32 * _MIB
    """Bytes of a request's body as sent, all parts together."""
    max_inflated_bytes: int = 256 * _MIB
    """Bytes of one label map after decompression."""
    max_voxels: int = 64 * _MIB
    """Voxels of one label map, all its frames together."""
    max_frames: int = 64
    """Frames of a study or a label map."""
    max_slices: int = 256
    """Slices of one frame."""
    max_contours: int = 5_000
    """Contours of a study, all frames together."""
    max_points_per_contour: int = 5_000
    """Points of one contour."""
    max_points: int = 300_000
    """Points of a study, all frames together."""
    max_json_depth: int = 32
    """Arrays and objects inside one another."""
    max_json_values: int = 2_000_000
    """Numbers, strings, arrays and objects of a JSON document, counted before it is parsed."""
    max_references: int = 64
    """Reference meshes of a request."""
    max_mesh_triangles: int = 2_000_000
    """Triangles of one reference mesh."""


def check_size(study: ContourStudy, limits: Limits, pointer: str = "/study") -> None:
    """Refuse a study larger than `limits`; `pointer` is where the study stands in the request.

    Raises:
        InputError: `TOO_LARGE` (413), naming the limit, the count found and what to do.
    """
    frames = f"{pointer}/frames"
    _refuse_above(limits.max_frames, len(study.frames), "frames", frames, "send fewer frames a job")
    contours = points = 0
    for i, frame in enumerate(study.frames):
        slices = f"{frames}/{i}/slices"
        _refuse_above(
            limits.max_slices, len(frame.slices), "slices in one frame", slices, "send fewer slices"
        )
        for j, slice_ in enumerate(frame.slices):
            contours += len(slice_.contours)
            for k, contour in enumerate(slice_.contours):
                _refuse_above(
                    limits.max_points_per_contour,
                    len(contour.points),
                    "points in one contour",
                    f"{slices}/{j}/contours/{k}/points",
                    "resample the contour; 100 to 300 points are ample",
                )
                points += len(contour.points)
    _refuse_above(
        limits.max_contours, contours, "contours in the study", frames, "send fewer frames a job"
    )
    _refuse_above(
        limits.max_points,
        points,
        "points in the study",
        frames,
        "resample the contours to 100 to 300 points each, or send fewer frames a job",
    )


def _refuse_above(limit: int, found: int, what: str, pointer: str, remedy: str) -> None:
    if found > limit:
        raise InputError(
            ProblemType.TOO_LARGE,
            f"{found} {what}; at most {limit} are accepted. Remedy: {remedy}.",
            pointer=pointer,
            status=413,
        )
