"""A batch followed to its end, with a bar that shows how far it is."""

from cli.batch_client import BatchClient
from cli.progress import progress_bar
from schemas.batch import Batch
from schemas.job import Progress


def watched(batches: BatchClient, batch_id: str, *, quiet: bool) -> Batch:
    """The batch, once every job of it has ended."""
    with progress_bar(batch_id[:11], quiet=quiet) as bar:
        return batches.wait(batch_id, lambda batch: bar.advanced(Progress(fraction=batch.fraction)))
