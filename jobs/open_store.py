"""The store that the settings name. The one place that knows which kinds there are."""

from jobs.disk_store import DiskStore
from jobs.scratch import Scratch
from jobs.settings import JobSettings
from jobs.store import JobStore
from jobs.store_errors import StoreMisfit


def open_store(settings: JobSettings) -> JobStore:
    """To be opened in the process that uses it: connections do not survive a fork.

    Raises StoreMisfit where a package for a bucket is not installed.
    """
    if settings.store_url is None:
        return DiskStore(settings.jobs_dir)
    try:
        # Here, so that who keeps jobs on a disk need not have it.
        from jobs.bucket import Bucket
        from jobs.object_store import ObjectStore
    except ImportError as error:
        raise StoreMisfit(
            "NEURALMRI_STORE_URL names a bucket, which needs neuralmri[s3] to be installed"
        ) from error
    name, _, prefix = settings.store_url.removeprefix("s3://").partition("/")
    bucket = Bucket(name, prefix.strip("/"), settings.store_timeout_s)
    return ObjectStore(bucket, Scratch(settings.data_dir / "scratch"))
