"""The background thread that tells endpoints of what has ended."""

import asyncio
import logging
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from datetime import UTC, datetime

import httpx
from redis.exceptions import RedisError

from jobs.periodic_thread import PeriodicThread
from jobs.redis_client import make_redis
from jobs.store_errors import StoreUnavailable
from service.access import JobAccess
from service.webhooks.announcement import Announcer
from service.webhooks.delivering import Postman
from service.webhooks.desk import WebhookDesk
from service.webhooks.dispatch_lock import DispatchLock
from service.webhooks.due import DueMessages
from service.webhooks.sending import Sender
from service.webhooks.target import Resolve, system_addresses

_HOLD_S = 10.0
_AT_ONE_ENDPOINT = 2
"""One that is slow must not take up every attempt there is."""
_AFTER_TROUBLE_S = 60.0

log = logging.getLogger("neuralmri.webhooks")

_Sent = tuple[str, str]
"""Endpoint and message."""


class Dispatcher(PeriodicThread):
    """Puts messages into the outbox and delivers them, in one service process at a time.

    What it was about when it is stopped or killed is tried again by the next, under the same id.
    """

    def __init__(
        self, access: JobAccess, desk: WebhookDesk, resolve: Resolve = system_addresses
    ) -> None:
        super().__init__("webhooks", join_within_s=10.0)
        settings = access.settings
        self._settings = settings
        self._desk = desk
        self._redis = make_redis(settings.redis_url, settings.redis_timeout_s)
        self._lock = DispatchLock(self._redis, _HOLD_S)
        self._announcer = Announcer(
            access.store, desk.endpoints, desk.outbox, access.records.traceparent
        )
        self._due = DueMessages(desk.outbox, settings.webhook_log)
        self._resolvers = ThreadPoolExecutor(settings.webhook_concurrency, "webhook-names")
        sender = Sender(
            rules=settings.webhook_targets,
            timeout_s=settings.webhook_timeout_s,
            resolve=resolve,
            trust=httpx.create_ssl_context(),
            resolvers=self._resolvers,
        )
        self._postman = Postman(settings, desk.endpoints, desk.outbox, sender, desk.attempts)
        self._under_way: dict[_Sent, asyncio.Task[None]] = {}

    def _run(self) -> None:
        asyncio.run(self._serve())

    async def _serve(self) -> None:
        await asyncio.to_thread(self._desk.endpoints.sweep)
        try:
            while await asyncio.to_thread(self._pause, self._settings.webhook_every_s):
                await self._round()
        finally:
            for task in self._under_way.values():
                task.cancel()
            await asyncio.gather(*self._under_way.values(), return_exceptions=True)
            await asyncio.to_thread(self._leave)

    async def _round(self) -> None:
        try:
            if not await asyncio.to_thread(self._lock.hold):
                return
            due = await asyncio.to_thread(self._look)
        except (RedisError, StoreUnavailable) as error:
            log.warning("no webhook is sent: %s", error)
            return
        except Exception:
            # Whatever it was, the next round may go better, and messages wait on disk.
            log.exception("no webhook is sent")
            return
        at_endpoint = Counter(endpoint_id for endpoint_id, _ in self._under_way)
        for sent in due:
            if len(self._under_way) >= self._settings.webhook_concurrency:
                break
            if sent not in self._under_way and at_endpoint[sent[0]] < _AT_ONE_ENDPOINT:
                at_endpoint[sent[0]] += 1
                self._under_way[sent] = asyncio.create_task(self._deliver(sent))

    def _look(self) -> list[_Sent]:
        """Announce what has ended, and list what is to be sent."""
        self._announcer.announce()
        now = datetime.now(UTC)
        return [
            (endpoint.id, message_id)
            for endpoint in self._desk.endpoints.all()
            if endpoint.disabled_at is None
            for message_id in self._due.of(endpoint.id, now)
        ]

    async def _deliver(self, sent: _Sent) -> None:
        try:
            if self._lock.is_held:
                await self._postman.deliver(*sent)
        except Exception:
            log.exception("message %s was not delivered, or it was not noted", sent[1])
            # It is due still: not to be sent each second to a receiver that may have had it.
            await asyncio.sleep(_AFTER_TROUBLE_S)
        finally:
            del self._under_way[sent]

    def _leave(self) -> None:
        try:
            self._lock.release()
        except RedisError as error:
            log.warning("the lock of the dispatcher was not released, it runs out: %s", error)
        self._redis.close()
        self._resolvers.shutdown(wait=False, cancel_futures=True)
