"""`beating.json`: everything that was measured of hearts over a cycle. A list has a number for each
frame, in the order of time.
"""

from benchmarks.results import Environment, Value
from schemas.cycle_report import Series
from schemas.vocabulary import Structure


class RunRow(Value):
    """One run from the study to all files, in a process of its own.

    process_s: from its start to its end. wall_s, cpu_s: of the run alone, without the start of
    Python and the import of libraries; cpu_s with its child processes. fit_cpu_s: by frame.
    """

    processes: int
    process_s: float
    wall_s: float
    cpu_s: float
    peak_mib: float
    stages_s: dict[str, float]
    fit_cpu_s: dict[str, float]
    from_nothing: list[str]
    failed: list[str]


class Residuals(Value):
    """From a surface's contours, where the alignment puts them, to it."""

    mean_mm: Series
    p95_mm: Series


class RealCycle(Value):
    """Guide points of a real heart. cold_cpu_s: of the fits from nothing, a frame. model_ml: of
    what others fitted to the same points.
    """

    environment: Environment
    frames: list[str]
    times_ms: list[float] | None
    runs: list[RunRow]
    residuals: dict[Structure, Residuals]
    warm_ml: dict[Structure, Series]
    cold_ml: dict[Structure, Series]
    model_ml: dict[Structure, Series]
    cold_cpu_s: float


class TrackedRow(Value):
    """One mesh carried through the cycle. to_own_mm, from_own_mm: mean distances to the frame's own
    surface, and back. Faults: sums over all frames. Drift: after one round.
    """

    vertices: int
    to_own_mm: list[float]
    from_own_mm: list[float]
    turned_over: int
    against_surface: int
    folded: int
    self_intersections: int
    least_angle_deg: float
    drift_mean_mm: float | None
    drift_max_mm: float | None


class SlicedSurface(Value):
    """One surface, sliced and reconstructed: mean distances to the truth both ways, and volumes."""

    surface: Structure
    warm_mm: list[float]
    cold_mm: list[float]
    true_ml: list[float]
    warm_ml: list[float]
    cold_ml: list[float]
    tracked: TrackedRow
    tracked_mm: list[float]


class SlicedCycle(Value):
    """Known surfaces of a real heart, sliced. CPU seconds: of all, surfaces only."""

    environment: Environment
    frames: int
    surfaces: list[SlicedSurface]
    warm_cpu_s: float
    cold_cpu_s: float


class PhantomSurface(Value):
    """One mesh tracked through a phantom's beat, beside the paths that its points really take.

    tracked: what it was carried over. normal_mm, tangential_mm: mean error of the vertices' places
    along the true surface's normal, and within it; p95_mm: of its length. Strain: of the area, to
    end-diastole; its error is the mean over the surface of the absolute one.
    """

    preset: str
    tracked: str
    surface: Structure
    normal_mm: list[float]
    tangential_mm: list[float]
    p95_mm: list[float]
    true_strain_percent: list[float]
    strain_percent: list[float]
    strain_error_percent: list[float]
    true_ml: list[float]
    found_ml: list[float]
    mesh: TrackedRow


class PhantomBeats(Value):
    """Hearts whose every point has a known path."""

    environment: Environment
    frames: int
    surfaces: list[PhantomSurface]


class KilledRun(Value):
    """A job whose computing process was killed, beside the same job unbroken.

    finished: frames that were fitted when it died; taken_up: those of them whose fit the next
    attempt said to have taken up; fitted_again: those whose state was written once more. noticed_s:
    from the kill until another attempt ran; next_frame_s: until it had fitted a frame that was not
    fitted before. broken_s, unbroken_s: from submission to the end. artifacts: how many
    compare how.
    """

    environment: Environment
    frames: int
    finished: int
    taken_up: int
    fitted_again: int
    attempts: int
    noticed_s: float
    next_frame_s: float
    broken_s: float
    unbroken_s: float
    artifacts: dict[str, int]
    not_the_same: list[str]


class BeatingResults(Value):
    """Parts are measured one by one; None for what was not."""

    patient1: RealCycle | None = None
    sliced: SlicedCycle | None = None
    phantom: PhantomBeats | None = None
    killed: KilledRun | None = None
