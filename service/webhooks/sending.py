"""One POST to one address, and what came back."""

import asyncio
import ssl
from collections.abc import Mapping
from concurrent.futures import Executor
from dataclasses import dataclass

import httpx

from service.webhooks.target import Resolve, checked_url, permitted_addresses
from service.webhooks.target_rules import TargetRules

_ANSWER_BYTES = 200
_CONNECT_WITHIN_S = 5.0


@dataclass(frozen=True)
class Answer:
    """What a receiver said. Its body is read no further than is kept."""

    status: int
    body: bytes
    retry_after: str | None


@dataclass(frozen=True)
class Sender:
    """How to send.

    trust: which certificates are believed.
    resolvers: where names are looked up, which may take long and cannot be interrupted.
    """

    rules: TargetRules
    timeout_s: float
    resolve: Resolve
    trust: ssl.SSLContext
    resolvers: Executor

    async def post(self, url: str, body: bytes, headers: Mapping[str, str]) -> Answer:
        """Send, and wait for the answer for no longer than `timeout_s`, name and all.

        No redirect is followed, and no proxy of the environment is used: either would connect to
        another address than was judged. Raises TargetRefused, httpx.TransportError or TimeoutError.
        """
        async with asyncio.timeout(self.timeout_s):
            target = checked_url(url, self.rules)
            addresses = await asyncio.get_running_loop().run_in_executor(
                self.resolvers, permitted_addresses, target, self.rules, self.resolve
            )
            async with httpx.AsyncClient(
                verify=self.trust,
                trust_env=False,
                follow_redirects=False,
                timeout=httpx.Timeout(
                    self.timeout_s, connect=min(_CONNECT_WITHIN_S, self.timeout_s)
                ),
            ) as client:
                return await _post(client, target, addresses, body, headers)


async def _post(
    client: httpx.AsyncClient,
    target: httpx.URL,
    addresses: list[str],
    body: bytes,
    headers: Mapping[str, str],
) -> Answer:
    """POST to the first address that takes a connection."""
    *others, last = addresses
    for address in others:
        try:
            return await _post_to(client, target, address, body, headers)
        except (httpx.ConnectError, httpx.ConnectTimeout):
            continue  # nothing was sent: the next address is as good
    return await _post_to(client, target, last, body, headers)


async def _post_to(
    client: httpx.AsyncClient,
    target: httpx.URL,
    address: str,
    body: bytes,
    headers: Mapping[str, str],
) -> Answer:
    request = client.build_request(
        "POST",
        target.copy_with(host=address),
        content=body,
        headers={
            # The connection goes to the address; certificate and virtual host go by the name.
            "Host": target.netloc.decode("ascii"),
            "Content-Type": "application/json",
            "User-Agent": "neuralmri-webhooks",
            "Accept-Encoding": "identity",
            **headers,
        },
        extensions={"sni_hostname": target.raw_host.decode("ascii")},
    )
    response = await client.send(request, stream=True)
    try:
        kept = b""
        async for chunk in response.aiter_raw():
            kept += chunk
            if len(kept) >= _ANSWER_BYTES:
                break
        return Answer(
            response.status_code, kept[:_ANSWER_BYTES], response.headers.get("retry-after")
        )
    finally:
        await response.aclose()
