"""Names that lead elsewhere: of jobs, artifacts, uploads; and text that ends up in logs."""

from benchmarks.attacks.target import Attack, Target, all_of, told, told_raw
from service.examples import CONTOUR_REQUEST

_TRAVERSALS = (
    *("../request.json", "../outcome.json", "..%2frequest.json", "%2e%2e%2frequest.json"),
    *(
        "%2e%2e/request.json",
        "..%5crequest.json",
        "..\\request.json",
        "%252e%252e%252frequest.json",
    ),
    *("/etc/passwd", "%2fetc%2fpasswd", "....//request.json", "results/../../request.json"),
    *(
        "report.json%00.stl",
        "%00",
        "report.json/",
        "REPORT.JSON",
        "report.json%20",
        "C:%5cx",
        "~",
        ".",
    ),
    *("..;/request.json", "%c0%ae%c0%ae%c0%afrequest.json", "a" * 5000),
)
_JOB_IDS = (
    *(
        "..",
        ".",
        "%2e%2e",
        "%2e%2e%2f",
        "*",
        "0" * 31,
        "0" * 33,
        "G" * 32,
        "%00" * 32,
        "%ef%bc%90",
    ),
    *("__proto__", "constructor", "null", "-1", "1;DROP", "$where", "a" * 5000),
)
_FILE_NAMES = (
    "../../etc/passwd",
    "/etc/passwd",
    "..\\x",
    "x" * 10_000,
    "a;b",
    "%2e%2e%2fx",
    ".",
    "",
)


def _artifacts(target: Target) -> str:
    """As the job's own owner: nothing but its artifacts."""
    names = [f"/v1/jobs/{target.job}/artifacts/{name}" for name in _TRAVERSALS]
    heads = (target.raw(f"GET {name} HTTP/1.1", "Connection: close", key=False) for name in names)
    owner = f"Authorization: {target.victim['Authorization']}".encode()
    answers = (
        told_raw(target.say(head.replace(b"Host: x", b"Host: x\r\n" + owner))) for head in heads
    )
    return all_of(answers)


def _jobs(target: Target) -> str:
    heads = (
        target.raw(f"GET /v1/jobs/{name}/report HTTP/1.1", "Connection: close") for name in _JOB_IDS
    )
    return all_of(told_raw(target.say(head)) for head in heads)


def _uploads(target: Target) -> str:
    before = _files(target)
    answers = [
        told(
            target.ask(
                "POST",
                "/v1/validate/labels",
                files={
                    "request": (None, b"{}", "application/json"),
                    "sax": (name or "x", b"x", "application/octet-stream"),
                },
            )
        )
        for name in _FILE_NAMES
    ]
    written = "nothing written" if _files(target) == before else "something written"
    return f"{all_of(iter(answers))}; {written}"


def _part_names(target: Target) -> str:
    before = _files(target)
    answers = [
        told(
            target.ask(
                "POST",
                "/v1/jobs/contours",
                files={
                    "request": (None, b"{}", "application/json"),
                    name: ("x", b"x", "application/octet-stream"),
                },
            )
        )
        for name in ("../x", "/etc/passwd", "reference_../x_lv_endo", "reference_%2e%2e_lv_endo")
    ]
    written = "nothing written" if _files(target) == before else "something written"
    return f"{all_of(iter(answers))}; {written}"


def _subject_ids(target: Target) -> str:
    names = ("../x", "a\r\nb", "a\x00b", "<script>", "x" * 65, "${jndi:ldap://x}", "")
    answers = []
    for name in names:
        study = {**CONTOUR_REQUEST["study"], "subject_id": name}
        body = {**CONTOUR_REQUEST, "study": study}
        answers.append(told(target.ask("POST", "/v1/jobs/contours", json=body)))
    return all_of(iter(answers))


def _log_lines(target: Target) -> str:
    """Forged lines by address, header and parameter; then they are looked for in the log."""
    forged = "FORGED-LINE"
    for path in (f"/v1/jobs/x%0d%0a{forged}", f"/v1/jobs?state=%0a{forged}", f"/%0a{forged}"):
        target.ask("GET", path)
    head = target.raw("GET /v1/jobs HTTP/1.1", f"traceparent: 00-{forged}", "Connection: close")
    target.say(head)
    target.ask("POST", "/v1/jobs/contours", content=forged, headers={"Content-Type": forged})
    return "not in the log" if forged not in _logs(target) else "in the log"


def _logs(target: Target) -> str:
    folder = target.service.settings.data_dir
    audit = [p.read_text(errors="replace") for p in folder.rglob("*audit*") if p.is_file()]
    return "".join([target.service.log.read_text(errors="replace"), *audit])


def _files(target: Target) -> list[str]:
    return sorted(str(p) for p in target.service.settings.jobs_dir.iterdir())


ATTACKS = (
    Attack(
        f"{len(_TRAVERSALS)} artifact names that lead out of a job's results (`../`, `%2e%2e%2f`, "
        "`\\`, NUL, absolute, over-long)",
        "404 not-found",
        _artifacts,
    ),
    Attack(f"{len(_JOB_IDS)} job ids that are none", "404 not-found", _jobs),
    Attack(
        f"{len(_FILE_NAMES)} file names with paths in uploads",
        "400 invalid-request, 422 invalid-request; nothing written",
        _uploads,
    ),
    Attack("part names with paths in uploads", "422 invalid-request; nothing written", _part_names),
    Attack(
        "subject ids with paths, line ends, NUL, markup, look-ups",
        "422 invalid-request",
        _subject_ids,
    ),
    Attack(
        "lines forged into log and audit by address, query, header, media type",
        "not in the log",
        _log_lines,
    ),
)
