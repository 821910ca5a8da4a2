"""Saying one thing and meaning another: browsers' tricks, HTTP's ambiguities, JSON's; and leaks."""

import json
import re
from collections.abc import Iterator

import httpx

from benchmarks.attacks.target import SUBJECT, Attack, Target, all_of, told, told_raw
from service.examples import CONTOUR_REQUEST
from service.security_headers import SECURITY_HEADERS

_CONTOURS = "POST /v1/jobs/contours HTTP/1.1"
_JSON = "Content-Type: application/json"
_AS_JSON = {"Content-Type": "application/json"}
_AS_FORM = {"Content-Type": "multipart/form-data"}
_GOOD = json.dumps(CONTOUR_REQUEST)
_FOREIGN = (
    {"Origin": "https://evil.example"},
    {"Origin": "null"},
    {"Sec-Fetch-Site": "cross-site"},
    {"Sec-Fetch-Site": "same-site"},
)


def _forgery(target: Target) -> str:
    """A page of another origin asks for a change with the victim's key."""
    return all_of(
        told(target.ask(method, path, headers={**target.victim, **said}))
        for method, path in (
            ("POST", "/v1/jobs/contours"),
            ("POST", f"/v1/jobs/{target.job}/cancel"),
            ("DELETE", f"/v1/jobs/{target.job}"),
        )
        for said in _FOREIGN
    )


def _reading_page(target: Target) -> str:
    answer = target.ask("GET", "/v1/jobs", headers={"Origin": "https://evil.example"})
    allowed = [name for name in answer.headers if name.startswith("access-control-")]
    return "no CORS header" if not allowed else ", ".join(allowed)


def _preflight(target: Target) -> str:
    asked = {"Origin": "https://evil.example", "Access-Control-Request-Method": "DELETE"}
    return told(target.ask("OPTIONS", f"/v1/jobs/{target.job}", headers=asked))


def _host(target: Target) -> str:
    """Another Host must not get into addresses that the service hands out."""
    said = {"Host": "evil.example", "X-Forwarded-Host": "evil.example", "X-Forwarded-Proto": "ftp"}
    answer = target.ask(
        "POST",
        "/v1/jobs/contours",
        content=_GOOD,
        headers={**said, "Content-Type": "application/json"},
    )
    handed_out = f"{answer.headers}{answer.text}"
    return f"{told(answer)}; {'taken up' if 'evil' in handed_out else 'not taken up'}"


def _line_ends(target: Target) -> str:
    """Line ends in what is given back: id, key, preference, trace."""
    answers = [
        target.ask("GET", "/v1/jobs/x%0d%0aSet-Cookie:%20a=b"),
        target.ask("GET", f"/v1/jobs/{target.job}/artifacts/x%0d%0aSet-Cookie:%20a=b"),
        target.ask("GET", "/v1/jobs", params={"cursor": "\r\nSet-Cookie: a=b"}),
    ]
    split = any("set-cookie" in answer.headers for answer in answers)
    return f"{all_of(map(told, answers))}; {'split' if split else 'not split'}"


def _raw_line_ends(target: Target) -> str:
    heads = (
        target.raw("GET /v1/jobs HTTP/1.1", "Idempotency-Key: a\rb"),
        target.raw("GET /v1/jobs HTTP/1.1", "Prefer: a\x00b"),
        target.raw("GET /v1/jobs HTTP/1.1", " folded: x"),
        target.raw("GET /v1/jobs HTTP/1.1", "no colon"),
        target.raw("GET /v1/jobs HTTP/1.1", "space before : x"),
    )
    return all_of(told_raw(target.say(head)) for head in heads)


def _smuggling(target: Target) -> str:
    """Two framings at once; behind them a second request that only one reading sees."""
    inner = target.raw(f"DELETE /v1/jobs/{target.job} HTTP/1.1")
    heads = (
        ["Content-Length: 5", "Transfer-Encoding: chunked"],
        ["Transfer-Encoding: chunked", "Content-Length: 5"],
        ["Content-Length: 5", "Content-Length: 6"],
        ["Transfer-Encoding: xchunked"],
        ["Transfer-Encoding: chunked, identity"],
        ["Transfer-Encoding: identity, chunked"],
        ["Content-Length: +5"],
        ["Content-Length: 0x5"],
        ["Content-Length: -1"],
    )
    answers = [
        target.say(target.raw(_CONTOURS, _JSON, *head, body=b"0\r\n\r\n" + inner)) for head in heads
    ]
    lone = [told_raw(answer) for answer in answers if answer.count(b"HTTP/1.1 ") <= 1]
    return (
        f"{all_of(iter(lone))}; {'one answer each' if len(lone) == len(heads) else 'two answers'}"
    )


def _override(target: Target) -> str:
    said = {
        "X-HTTP-Method-Override": "DELETE",
        "X-Method-Override": "DELETE",
        "X-HTTP-Method": "DELETE",
    }
    answer = target.ask("GET", f"/v1/jobs/{target.job}", headers={**target.victim, **said})
    also = target.ask("GET", f"/v1/jobs/{target.job}?_method=DELETE", headers=target.victim)
    return f"{told(answer)}, {told(also)}; {'still there' if target.is_well() else 'gone'}"


def _odd_methods(target: Target) -> str:
    return all_of(
        told(target.ask(method, f"/v1/jobs/{target.job}", headers=target.victim))
        for method in ("TRACE", "CONNECT", "PUT", "PATCH", "PROPFIND", "OPTIONS")
    )


def _confusion(target: Target) -> str:
    """A body that says to be another thing than it is."""
    types = (
        "text/plain",
        "application/x-www-form-urlencoded",
        "application/xml",
        "",
        "json",
        "*/*",
    )
    return all_of(
        told(target.ask("POST", "/v1/jobs/contours", content=_GOOD, headers={"Content-Type": t}))
        for t in types
    )


def _json_as_form(target: Target) -> str:
    said = {"Content-Type": "multipart/form-data; boundary=x"}
    return told(target.ask("POST", "/v1/jobs/contours", content=_GOOD, headers=said))


def _bad_json(target: Target) -> str:
    bodies = (
        _GOOD.replace('"study":', '"study": 1, "study":'),
        _GOOD.replace("25.0", "NaN", 1),
        _GOOD.replace("25.0", "1e999", 1),
        "\ufeff" + _GOOD,
        _GOOD + _GOOD,
    )
    return all_of(_sent(target, body.encode()) for body in bodies)


def _prototype(target: Target) -> str:
    names = ("__proto__", "constructor", "__class__", "__init__", "model_config", "$ref")
    return all_of(
        _sent(target, json.dumps({**CONTOUR_REQUEST, name: {"admin": True}}).encode())
        for name in names
    )


def _sent(target: Target, body: bytes) -> str:
    return told(target.ask("POST", "/v1/jobs/contours", content=body, headers=_AS_JSON))


def _event_ids(target: Target) -> str:
    """Rubbish for `Last-Event-ID`: the stream begins anew, or there is nothing to follow."""
    rubbish = ("x", "-1-0", "9" * 40, "0-0; DROP", "$", ">", "*", "\x01", "é" * 10, "(1-0")
    answers = (
        told(
            target.ask(
                "GET",
                f"/v1/jobs/{target.job}/events",
                headers={**target.victim, "Last-Event-ID": value.encode("latin-1")},
            )
        )
        for value in rubbish
    )
    return all_of(answers)


def _errors(target: Target) -> Iterator[httpx.Response]:
    yield target.ask("GET", "/nowhere")
    yield target.ask("PUT", "/v1/jobs")
    yield target.ask("GET", "/v1/jobs/x")
    yield target.ask("GET", "/v1/jobs?limit=x")
    yield target.ask("GET", f"/v1/jobs/{target.job}")
    yield target.ask("GET", "/v1/jobs", headers={"Authorization": "Bearer x"})
    yield target.ask("GET", f"/v1/jobs/{target.job}/artifacts/%00", headers=target.victim)
    yield target.ask(
        "POST", "/v1/jobs/contours", content=b"\xff", headers={"Content-Type": "application/json"}
    )
    yield target.ask(
        "POST", "/v1/jobs/labels", content=b"x", headers={"Content-Type": "multipart/form-data"}
    )
    yield target.ask("POST", "/v1/webhooks", json={"url": "https://127.0.0.1/"})
    study = {**CONTOUR_REQUEST["study"], "subject_id": SUBJECT, "units": "um"}
    yield target.ask("POST", "/v1/jobs/contours", json={"study": study})


def _leaks(target: Target) -> str:
    """Paths, tracebacks, versions and patients in what errors say."""
    secret = re.compile(
        rf"Traceback|File \"|\.py\b|/tmp/|/home|site-packages|{SUBJECT}|redis|pydantic|uvicorn|"
        rf"{re.escape(str(target.service.settings.data_dir))}"
    )
    said = [f"{answer.headers}{answer.text}" for answer in _errors(target)]
    found = sorted({match[0] for text in said for match in secret.finditer(text)})
    return ", ".join(found) or "nothing"


def _logged(target: Target) -> str:
    log = target.service.log.read_text(errors="replace")
    key = target.attacker["Authorization"].rpartition("_")[2]
    found = [name for name, text in (("subject", SUBJECT), ("key", key)) if text in log]
    return ", ".join(found) or "nothing"


def _bare(target: Target) -> str:
    answers = [*_errors(target), target.ask("GET", "/v1/jobs"), target.ask("GET", "/healthz")]
    lacking = {name for name in SECURITY_HEADERS for a in answers if name not in a.headers}
    named = [a for a in answers if "server" in a.headers or "x-powered-by" in a.headers]
    return f"{', '.join(sorted(lacking)) or 'all there'}; {'named' if named else 'no Server'}"


ATTACKS = (
    Attack(
        "a page of another origin submits, cancels, erases (CSRF)", "403 cross-origin", _forgery
    ),
    Attack("a page of another origin reads", "no CORS header", _reading_page),
    Attack("a preflight of another origin", "405 method-not-allowed", _preflight),
    Attack("another `Host`, `X-Forwarded-Host`", "202; not taken up", _host),
    Attack(
        "line ends in ids, names, parameters (response splitting)",
        "404 not-found, 422 invalid-request; not split",
        _line_ends,
    ),
    Attack(
        "line ends, NUL, folding, blanks in header fields",
        "400, 401 unauthenticated",
        _raw_line_ends,
    ),
    Attack(
        "`Content-Length` beside `Transfer-Encoding`, twice, signed, hex (smuggling)",
        "400, 400 invalid-request; one answer each",
        _smuggling,
    ),
    Attack("method override by header and query", "200, 200; still there", _override),
    Attack("TRACE, CONNECT, PUT, PATCH, PROPFIND, OPTIONS", "405 method-not-allowed", _odd_methods),
    Attack("JSON under other media types, or none", "415 unsupported-media-type", _confusion),
    Attack("JSON called a form", "400 invalid-request", _json_as_form),
    Attack(
        "JSON with a key twice, NaN, 1e999, BOM, a second document",
        "400 malformed-json, 422 invalid-request",
        _bad_json,
    ),
    Attack(
        "keys called `__proto__`, `constructor`, `__class__`", "422 invalid-request", _prototype
    ),
    Attack("rubbish for `Last-Event-ID`", "200", _event_ids),
    Attack("errors that tell paths, traces, libraries, patients", "nothing", _leaks),
    Attack("patients or keys in the log", "nothing", _logged),
    Attack("answers without security headers, or with a `Server`", "all there; no Server", _bare),
)
