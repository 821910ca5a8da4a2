"""Stores of every kind for tests, and what lies in them."""

from contextlib import closing
from typing import Any

import boto3

from jobs.disk_store import DiskStore
from jobs.object_store import ObjectStore
from jobs.store import JobStore
from tests.s3_server import BUCKET, KEY_ID, SECRET


def remains(store: JobStore) -> list[str]:
    """Everything in a store, whatever it is: names of files or keys of objects."""
    if isinstance(store, DiskStore):
        return sorted(str(p.relative_to(store.root)) for p in store.root.rglob("*"))
    assert isinstance(store, ObjectStore)
    return [listed.key for listed in store.bucket.under("")]


def empty_bucket(url: str) -> None:
    """Make the tests' bucket, or make it empty."""
    with closing(_client(url)) as client:
        client.create_bucket(Bucket=BUCKET)
        for key in keys_of(url):
            client.delete_object(Bucket=BUCKET, Key=key)


def keys_of(url: str) -> list[str]:
    """Every key in the tests' bucket."""
    with closing(_client(url)) as client:
        pages = client.get_paginator("list_objects_v2").paginate(Bucket=BUCKET)
        return [entry["Key"] for page in pages for entry in page.get("Contents", ())]


def _client(url: str) -> Any:
    return boto3.client(
        "s3",
        endpoint_url=url,
        aws_access_key_id=KEY_ID,
        aws_secret_access_key=SECRET,
        region_name="us-east-1",
    )
