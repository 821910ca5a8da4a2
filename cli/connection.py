"""The way to one server: calls that are made again where that may help, and what refuses them."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import Any, Self, TypeVar

import httpx

from cli.retrying import PASSING, TryAgain, persistently, retry_after_s
from cli.server_errors import ConnectionLostError, document_of, refusal_of
from schemas.problem import InputError, ProblemType, ServiceError

T = TypeVar("T")

_TIMEOUT = httpx.Timeout(10.0, read=60.0, write=60.0)


class Connection:
    """Every method raises InputError or InternalError, as the server's problem says.

    A call that is not answered, or with "not now" (429, 503), is made again for `retry_within_s`;
    `tell` hears of it. So all but `once` is for what is safe to be done twice.
    """

    def __init__(
        self, server: str, api_key: str | None, retry_within_s: float, tell: Callable[[str], None]
    ) -> None:
        self.server = server.rstrip("/")
        self._retry_within_s = retry_within_s
        self._tell = tell
        # Environment proxies are for the outside; a local server is not reached through them.
        local = _parsed(self.server).host in ("127.0.0.1", "localhost", "::1")
        self._http = httpx.Client(
            base_url=self.server,
            headers={"Authorization": f"Bearer {_plain(api_key)}"} if api_key else {},
            timeout=_TIMEOUT,
            trust_env=not local,
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._http.close()

    def call(self, method: str, path: str, **content: Any) -> Any:
        """The JSON that a call is answered with, made again where that may help."""
        return self.again(lambda: self.ask(method, path, **content))

    def once(self, method: str, path: str, **content: Any) -> Any:
        """The JSON that a call is answered with which is not safe to be made twice."""
        try:
            return self.ask(method, path, **content)
        except TryAgain as again:
            raise again.error from again

    def do(self, method: str, path: str) -> None:
        """A call whose answer says nothing, made again where that may help."""
        self.again(lambda: self._response(method, path))

    def again(self, attempt: Callable[[], T]) -> T:
        """What `attempt` returns, made again while it raises TryAgain."""
        return persistently(attempt, self._retry_within_s, self._tell)

    def ask(self, method: str, path: str, **content: Any) -> Any:
        """The JSON that one call is answered with. Raises TryAgain too."""
        return document_of(self._response(method, path, **content))

    @contextmanager
    def stream(self, path: str, headers: dict[str, str]) -> Iterator[httpx.Response]:
        """An answer that is read as it comes. Raises ConnectionLostError where it breaks off."""
        try:
            with self._http.stream("GET", path, headers=headers) as response:
                yield response
        except httpx.TransportError as error:
            raise self._unreachable(error) from error

    def fetch(self, attempt: Callable[[httpx.Client], None]) -> None:
        """An attempt of its own kind at this server, made again where that may help."""

        def reach() -> None:
            try:
                attempt(self._http)
            except httpx.TransportError as error:
                raise TryAgain(self._unreachable(error)) from error

        self.again(reach)

    def _response(self, method: str, path: str, **content: Any) -> httpx.Response:
        try:
            response = self._http.request(method, path, **content)
        except httpx.UnsupportedProtocol as error:
            raise _no_address(self.server, error) from error
        except httpx.TransportError as error:
            raise TryAgain(self._unreachable(error)) from error
        if not response.is_success:
            raise refused(response)
        return response

    def _unreachable(self, error: httpx.TransportError) -> ConnectionLostError:
        return ConnectionLostError(
            ProblemType.UNAVAILABLE,
            f"the server at {self.server} does not answer ({error}); start one with "
            "`neuralmri serve`, or name another with --server",
            status=503,
            is_silence=isinstance(error, httpx.ReadTimeout),
        )


def refused(response: httpx.Response) -> TryAgain | ServiceError:
    """What to raise for an answer that is no success."""
    refusal, after_s = refusal_of(response), retry_after_s(response)
    # An attempt of ours whose answer was lost may still be on its way into the store.
    overtaken = response.status_code == 409 and "Idempotency-Key" in response.request.headers
    if response.status_code in PASSING or (overtaken and after_s is not None):
        return TryAgain(refusal, after_s)
    return refusal


def _plain(api_key: str) -> str:
    """The key as a header takes it. The complaint does not repeat it."""
    if not api_key.strip().isascii() or not api_key.strip().isprintable():
        raise InputError(
            ProblemType.INVALID_REQUEST,
            "the API key holds characters that no key has; give it whole and alone, as "
            "`neuralmri keys create` showed it",
        )
    return api_key.strip()


def _parsed(server: str) -> httpx.URL:
    try:
        return httpx.URL(server)
    except httpx.InvalidURL as error:
        raise _no_address(server, error) from error


def _no_address(server: str, error: Exception) -> InputError:
    return InputError(
        ProblemType.INVALID_REQUEST,
        f"{server!r} is no address ({error}); give one like http://127.0.0.1:8000",
    )
