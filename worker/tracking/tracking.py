"""The whole of tracking: surfaces of all frames in, one mesh carried through them out."""

from collections.abc import Sequence

import numpy as np

from schemas.job import Progress, Stage
from worker.observer import Cancelled, Observer, Unobserved
from worker.surface_mesh import SurfaceMesh
from worker.tracking.carrier import Carried, Carrier
from worker.tracking.frame_measures import measured
from worker.tracking.frame_surface import FrameSurface
from worker.tracking.interpolation import interpolated
from worker.tracking.patch import Patch
from worker.tracking.tracked_surface import TrackedSurface
from worker.tracking.untangling import untangled


def track(
    rest: SurfaceMesh,
    surfaces: Sequence[tuple[str, SurfaceMesh]],
    rest_frame: int,
    observer: Observer | None = None,
    *,
    is_whole_cycle: bool = True,
) -> TrackedSurface:
    """Carry `rest` onto the surface of every frame, in order from its own, round the cycle.

    Where the frames are no whole cycle, it is carried forward to the last and back to the first.

    Args:
        rest: Even triangles on the surface of frame `rest_frame`; closed, outward, mm.
        surfaces: Label and closed, outward surface of every frame, mm, in order of time.
        rest_frame: Index of the frame that `rest` is of, end-diastole as a rule.
        observer: Told of each frame, and asked whether to stop.

    At `rest_frame` the result is `rest` itself. Deterministic. Raises ValueError for a mesh that is
    not closed, InternalError for a surface without faces, Cancelled when asked to stop.
    """
    watcher = observer or Unobserved()
    carrier, whole = Carrier(rest), Patch.whole(rest)
    count = len(surfaces)
    vertices = np.empty((count, *rest.vertices_mm.shape))
    frames = {}
    start = Carried(rest.vertices_mm, rest.vertices_mm)
    drift_mm: np.ndarray | None = None
    ways = _ways(rest_frame, count, is_whole_cycle=is_whole_cycle)
    steps, done = sum(map(len, ways)), 0
    for indices in ways:
        now = before = start
        for passed, index in enumerate(indices):
            if watcher.is_cancelled():
                raise Cancelled
            label, mesh = surfaces[index]
            watcher.advanced(Progress(stage=Stage.MEASURING, frame=label, fraction=done / steps))
            done += 1
            surface = FrameSurface(mesh)
            if passed:
                carried = carrier.carried(now, surface)
                if watcher.is_cancelled():
                    raise Cancelled
                smooth = untangled(SurfaceMesh(carried.vertices_mm, rest.faces), surface, whole)
                sound = interpolated(smooth, carried.copy_mm, whole)
                before, now = now, Carried(sound.vertices_mm, carried.copy_mm)
            if passed and index == rest_frame:
                drift_mm = np.linalg.norm(now.vertices_mm - rest.vertices_mm, axis=1)
            else:
                vertices[index] = now.vertices_mm
                here = SurfaceMesh(now.vertices_mm, rest.faces)
                frames[index] = measured(label, here, surface, rest, before.vertices_mm)
    return TrackedSurface(
        vertices_mm=vertices,
        faces=rest.faces,
        rest=rest_frame,
        frames=tuple(frames[index] for index in range(count)),
        drift_mean_mm=None if drift_mm is None else float(drift_mm.mean()),
        drift_max_mm=None if drift_mm is None else float(drift_mm.max()),
    )


def _ways(rest: int, count: int, *, is_whole_cycle: bool) -> list[list[int]]:
    """Frames in the order in which the mesh comes to them, from `rest`: round and back to it, or
    to either end.
    """
    if is_whole_cycle:
        return [[(rest + passed) % count for passed in range(count + 1)]]
    return [list(range(rest, count)), list(range(rest, -1, -1))]
