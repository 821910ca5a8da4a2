"""What comes with a batch beside its body."""

from typing import Annotated

from fastapi import Depends, Header, Query

from schemas.job import Priority
from schemas.messages import Idempotency
from service.payload_hash import batch_sha256
from service.retain_term import RetainS, retained_s
from service.settings import ServiceSettings


class BatchTerms:
    """How a batch wants to be treated, as its parameters say."""

    def __init__(
        self,
        priority: Annotated[
            Priority, Query(description="Of every job of the body; as on a single submission.")
        ] = Priority.BATCH,
        idempotency_key: Annotated[
            str | None,
            Header(
                pattern=r"^[ -~]{1,255}$",
                description="A name of your own for this request, to send it again by: one key "
                "makes one batch, with the same jobs. It is forgotten with the batch.",
            ),
        ] = None,
        retain_s: RetainS = None,
    ) -> None:
        self.priority = priority
        self._key = idempotency_key
        self._retain_s = retain_s

    def retain_s(self, settings: ServiceSettings) -> float | None:
        """How long each job is to be kept after its end; None for ever. Raises InputError."""
        return retained_s(self._retain_s, settings)

    def idempotency(self, body: bytes, *, in_lines: bool) -> Idempotency | None:
        """Key and payload, where there is a key."""
        if self._key is None:
            return None
        named = {} if self._retain_s is None else {"retain_s": str(self._retain_s)}
        digest = batch_sha256(self.priority, body, named, in_lines=in_lines)
        return Idempotency(key=self._key, payload_sha256=digest)


Terms = Annotated[BatchTerms, Depends()]
