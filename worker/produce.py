"""A job's folder in, its artifacts out: the way from job to science and back."""

from pathlib import Path

from intake.limits import Limits
from jobs.folder import JobFolder
from schemas.artifacts import Manifest
from schemas.job import Progress, Stage
from worker.fingerprint import fingerprint
from worker.job_checkpoints import JobCheckpoints
from worker.observer import KeepsFound, Observer, nothing_kept
from worker.provenance import provenance
from worker.reading import read_job
from worker.subject import run


def produce(
    folder: JobFolder,
    out_dir: Path,
    observer: Observer,
    keeps_found: KeepsFound = nothing_kept,
    *,
    threads: int,
    processes: int = 1,
    limits: Limits,
) -> Manifest:
    """Compute what the job asks for into `out_dir`, going on from where an earlier attempt came.

    Raises as `read_job` and `run` do.
    """
    observer.advanced(Progress(stage=Stage.READING))
    reading = read_job(folder, limits, out_dir)
    options, input_sha256 = reading.options, reading.input_sha256
    made_by = provenance(seed=options.seed, threads=threads, input_sha256=input_sha256)
    finished = run(
        reading.study,
        options,
        out_dir,
        threads=threads,
        processes=processes,
        input_sha256=input_sha256,
        warnings=reading.warnings,
        references=reading.references,
        job_id=folder.job_id,
        observer=observer,
        keeps_found=keeps_found,
        checkpoints=JobCheckpoints(folder, fingerprint(options, made_by), observer.is_cancelled),
        limits=limits,
    )
    return finished.manifest
