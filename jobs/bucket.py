"""The few things that are asked of an S3-compatible server, through s3fs.

Reads see every write that was answered before them, and a write under `put_new` is refused where
the key is taken (`If-None-Match: *`): `ObjectStore.prove` tries that. Raises StoreUnavailable
everywhere. It is to be made after a fork, and any thread may ask.
"""

import time
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

from s3fs import S3FileSystem

from jobs.bucket_errors import Conflict, NoSuchObject, Taken, answers
from jobs.store_errors import StoreUnavailable

_ATTEMPTS = 3
_PART_BYTES = 8 << 20
_PAGE = 1000
_CONFLICTS = 10


@dataclass(frozen=True)
class Listed:
    """An object as a listing shows it."""

    key: str
    bytes: int
    modified_at: datetime


class Bucket:
    """The objects of a bucket whose keys begin with a prefix, which callers leave out.

    timeout_s: how long connecting, and each silence of the server, may take. Server and
    credentials are botocore's matter: AWS_ENDPOINT_URL, AWS_ACCESS_KEY_ID and so on.
    """

    def __init__(self, name: str, prefix: str, timeout_s: float) -> None:
        self._name = name
        self._prefix = f"{prefix}/" if prefix else ""
        self._files = S3FileSystem(
            skip_instance_cache=True,
            use_listings_cache=False,
            max_concurrency=2,
            config_kwargs={
                "connect_timeout": timeout_s,
                "read_timeout": timeout_s,
                "retries": {"max_attempts": _ATTEMPTS, "mode": "standard"},
            },
        )
        self._files.retries = 1  # botocore's are enough

    def put_new(self, key: str, content: bytes) -> bool:
        """Write an object unless there is one, and say whether this content stands.

        A request of ours that was sent twice, since its first answer was lost, stands.
        """
        for _ in range(_CONFLICTS):
            try:
                self._call("put_object", Key=self._whole(key), Body=content, IfNoneMatch="*")
            except Taken:
                standing = self.get(key)
                if standing is not None:
                    return standing == content
            except Conflict:
                time.sleep(0.05)
            else:
                return True
        raise StoreUnavailable("the store does not settle who wrote an object first")

    def put(self, key: str, content: bytes) -> None:
        self._call("put_object", Key=self._whole(key), Body=content)

    def put_file(self, key: str, path: Path) -> None:
        path.stat()  # a file that is missing here is not the server's fault
        with answers():
            self._files.put_file(str(path), self._path(key), chunksize=_PART_BYTES)

    def get(self, key: str) -> bytes | None:
        """The whole object; None where there is none."""
        return self._get(key)

    def get_range(self, key: str, start: int, end: int) -> bytes | None:
        """The bytes from `start`, which the object has, up to `end`; None without an object."""
        return self._get(key, start=start, end=end)

    def exists(self, key: str) -> bool:
        """Whether there is such an object. It is not to be an empty one."""
        # Not by HEAD: its 404 does not tell a missing object from a missing bucket.
        return self.get_range(key, 0, 1) is not None

    def look(self, key: str) -> Listed | None:
        """Size and time of one object."""
        first = next(self.under(key, at_most=1), None)
        return first if first is not None and first.key == key else None

    def copy(self, source: str, key: str) -> bool:
        """Copy within the bucket; False where there is no source."""
        try:
            self._call(
                "copy_object",
                Key=self._whole(key),
                CopySource={"Bucket": self._name, "Key": self._whole(source)},
            )
        except NoSuchObject:
            return False
        return True

    def under(self, start: str, *, at_most: int | None = None) -> Iterator[Listed]:
        """Objects whose keys begin with `start`, by key."""
        for page in self._pages(start, MaxKeys=at_most or _PAGE):
            for entry in page.get("Contents", ()):
                key = entry["Key"].removeprefix(self._prefix)
                yield Listed(key, entry["Size"], entry["LastModified"])
            if at_most:
                return

    def folders(self, start: str) -> Iterator[str]:
        """Names that follow `start` and end with a slash, without it."""
        for page in self._pages(start, Delimiter="/", MaxKeys=_PAGE):
            for entry in page.get("CommonPrefixes", ()):
                yield entry["Prefix"].removeprefix(self._prefix + start).rstrip("/")

    def delete(self, key: str) -> None:
        """Delete an object, if it is there."""
        try:
            self._call("delete_object", Key=self._whole(key))
        except NoSuchObject:
            return  # as some servers answer

    def _get(self, key: str, **between: int) -> bytes | None:
        try:
            with answers():
                # With one at a time it asks for no size first.
                content: bytes = self._files.cat_file(self._path(key), max_concurrency=1, **between)
        except NoSuchObject:
            return None
        return content

    def _pages(self, start: str, **how: Any) -> Iterator[dict[str, Any]]:
        more: dict[str, str] = {}
        while True:
            page = self._call("list_objects_v2", Prefix=self._whole(start), **how, **more)
            yield page
            if not page.get("IsTruncated"):
                return
            more = {"ContinuationToken": page["NextContinuationToken"]}

    def _call(self, method: str, **arguments: Any) -> dict[str, Any]:
        with answers():
            answer: dict[str, Any] = self._files.call_s3(method, Bucket=self._name, **arguments)
        return answer

    def _whole(self, key: str) -> str:
        return self._prefix + key

    def _path(self, key: str) -> str:
        return f"{self._name}/{self._prefix}{key}"
