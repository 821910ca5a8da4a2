"""The issuer's keys as this process has them: asked for ahead of time, and kept for a while."""

import asyncio
import logging
import time
from types import TracebackType
from typing import Self

from jwt import PyJWK

from jobs.cancelled_tasks import end_tasks
from schemas.problem import InternalError, ProblemType
from service.tokens.issuer import IssuerSilent, keys_of
from service.tokens.key_set import KeySet
from service.tokens.settings import OidcSettings

_LOGGER = logging.getLogger(__name__)


class KeysAtHand:
    """An async context, one a process: while it is open a task keeps the keys fresh.

    Nobody waits for the issuer but a token that names a key of which we have not heard; and however
    many such tokens come, the issuer is asked once in `oidc_refetch_s`. No thread waits either.
    """

    def __init__(self, settings: OidcSettings) -> None:
        self._settings = settings
        self._keys: KeySet | None = None
        self._had_at_s = -float("inf")
        self._asked_at_s = -float("inf")
        self._asking = asyncio.Lock()
        self._why_not: str | None = "they were not asked for yet"
        self._task: asyncio.Task[None] | None = None

    async def __aenter__(self) -> Self:
        if self._settings.takes_tokens:
            self._task = asyncio.create_task(self._keep_fresh(), name="issuer-keys")
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._task is not None:
            await end_tasks(self._task)

    def missing(self) -> str | None:
        """Why no token can be checked now; None where they can, or where none is to be."""
        if not self._settings.takes_tokens or self._usable() is not None:
            return None
        return f"the keys of the token issuer cannot be had: {self._why_not}"

    async def key(self, kid: str | None, algorithm: str) -> PyJWK | None:
        """The key that a token names; None where the issuer has none of that name.

        Raises InternalError (unavailable, 503) where that cannot be told now.
        """
        found = self._known(kid, algorithm)
        if found is None:
            await self._ask_again()
            found = self._known(kid, algorithm)
        if found is None and (self._usable() is None or self._why_not is not None):
            raise self._cannot_tell()
        return found

    def _known(self, kid: str | None, algorithm: str) -> PyJWK | None:
        keys = self._usable()
        return keys.key(kid, algorithm) if keys else None

    def _usable(self) -> KeySet | None:
        is_too_old = time.monotonic() - self._had_at_s > self._settings.oidc_stale_s
        return None if is_too_old else self._keys

    async def _ask_again(self) -> None:
        """Ask the issuer, unless it was asked just now; whoever comes meanwhile waits for that."""
        async with self._asking:
            if time.monotonic() - self._asked_at_s < self._settings.oidc_refetch_s:
                return
            try:
                self._keys = await keys_of(self._settings)
            except IssuerSilent as error:
                if self._why_not != str(error):  # once an outage
                    _LOGGER.warning("the token issuer gives no keys: %s", error)
                self._why_not = str(error)
            else:
                self._why_not = None
                self._had_at_s = time.monotonic()
            finally:
                self._asked_at_s = time.monotonic()

    async def _keep_fresh(self) -> None:
        while True:
            await self._ask_again()
            is_silent = self._why_not is not None
            await asyncio.sleep(
                self._settings.oidc_refetch_s if is_silent else self._settings.oidc_refresh_s
            )

    def _cannot_tell(self) -> InternalError:
        return InternalError(
            ProblemType.UNAVAILABLE,
            "this token cannot be checked now: its issuer does not say by which keys it signs. "
            "Remedy: send the request again later.",
            status=503,
        )
