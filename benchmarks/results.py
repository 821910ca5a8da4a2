"""`results.json`: everything a run measured, from which tables and plots are made."""

from pydantic import BaseModel, ConfigDict

from schemas.vocabulary import Structure


class Value(BaseModel):
    """A frozen value of the results file; numbers finite, keys known."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class Errors(Value):
    """A surface, or a part of one, held against the truth. An open surface has no volume."""

    mean_mm: float
    rms_mm: float
    p95_mm: float
    max_mm: float
    volume_error_percent: float | None


class Record(Value):
    """One method on one surface of one case.

    failure: why there are no errors. wall_s, cpu_s, peak_mib, libraries_mib: of the method on the
    whole case, all its surfaces; None when its process failed. shift_rms_mm: what is left of the
    slices' displacement, for a method that looks for shifts.
    """

    case: str
    method: str
    surface: Structure
    failure: str | None = None
    whole: Errors | None = None
    apex: Errors | None = None
    mid: Errors | None = None
    base: Errors | None = None
    wall_s: float | None = None
    cpu_s: float | None = None
    peak_mib: float | None = None
    libraries_mib: float | None = None
    shift_rms_mm: float | None = None


class CaseFacts(Value):
    """What was reconstructed.

    factors: of the slicing plan, empty for a case from a folder. displaced_rms_mm: RMS length of
    the short-axis slices' displacements, zero where they are in place. truth_ml: volumes.
    """

    name: str
    short_axis_slices: int
    long_axis_slices: int
    factors: dict[str, float]
    displaced_rms_mm: float
    truth_ml: dict[Structure, float]


class Pair(Value):
    """One fit, and its own matrix products alone, one right after the other."""

    fit_s: float
    products_s: float


class Speed(Value):
    """Where the time goes, and how many subjects a machine does.

    gflop: 1e9 multiplications and additions in the matrix products of one fit. products: how many
    products. Throughputs are subjects a minute, one entry a repetition.
    """

    gflop: float
    products: int
    pairs: list[Pair]
    workers: int
    subjects_per_minute_alone: list[float]
    subjects_per_minute_together: list[float]


class Environment(Value):
    """Where it was measured. load: runnable processes (one minute's mean) before the run began."""

    cpu: str
    cores: int
    threads: int
    memory_gib: float
    load: float
    system: str
    python: str
    libraries: dict[str, str]


class Results(Value):
    """One run."""

    environment: Environment
    cases: list[CaseFacts]
    records: list[Record]
    speed: Speed | None = None
