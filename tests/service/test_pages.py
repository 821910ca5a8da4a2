"""The pages about the API: whole without any other origin, and inert but for their own scripts."""

import re
from html.parser import HTMLParser
from urllib.parse import urljoin, urlsplit

import pytest

from schemas.problem import ProblemType
from tests.service.conftest import Api
from tests.service.test_jobs import problem_of

pages = pytest.mark.parametrize("page", ["/docs", "/redoc"])


class References(HTMLParser):
    """What a page points to, and what it runs or paints from within itself."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.found: list[str] = []
        self.scripts_within = 0
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        self.found += [
            value
            for name in ("src", "href", "action", "data", "spec-url")
            if (value := given.get(name)) is not None
        ]
        self.scripts_within += tag == "script" and "src" not in given
        self.scripts_within += any(name.startswith("on") for name in given)


@pages
def test_a_page_points_nowhere_else_and_everything_it_needs_is_here(api: Api, page: str) -> None:
    answer = api.client.get(page)
    assert answer.status_code == 200
    assert answer.headers["content-type"].startswith("text/html")
    references = References(answer.text)
    assert len(references.found) >= 3
    assert "//" not in answer.text
    for reference in references.found:
        assert not urlsplit(reference).netloc
        asset = api.client.get(urljoin(page, reference))
        assert asset.status_code == 200, reference
        assert asset.content


@pages
def test_the_policy_lets_only_own_files_run(api: Api, page: str) -> None:
    answer = api.client.get(page)
    policy = dict(
        part.strip().split(" ", 1) for part in answer.headers["content-security-policy"].split(";")
    )
    assert policy["default-src"] == "'none'"
    assert policy["script-src"] == "'self'"
    assert policy["connect-src"] == "'self'"
    assert policy["frame-ancestors"] == "'none'"
    assert not [value for value in policy.values() if "http" in value or "*" in value]
    assert References(answer.text).scripts_within == 0


def test_what_starts_swagger_reads_the_description_from_here(api: Api) -> None:
    script = api.client.get("/docs/start.js")
    assert script.headers["content-type"].startswith("text/javascript")
    (url,) = re.findall(r'url: "([^"]+)"', script.text)
    assert api.client.get(urljoin("/docs", url)).json()["openapi"].startswith("3.")


def test_redoc_s_mark_is_here_and_no_script_asks_for_it_elsewhere(api: Api) -> None:
    assert api.client.get("/redoc/logo-mini.svg").headers["content-type"] == "image/svg+xml"
    script = api.client.get("/docs/assets/redoc.standalone.js").text
    assert "cdn.redoc.ly" not in script


def test_files_may_be_kept_and_pages_not(api: Api) -> None:
    assert "max-age" in api.client.get("/docs/assets/swagger-ui.css").headers["cache-control"]
    assert api.client.get("/docs").headers["cache-control"] == "no-store"


@pytest.mark.parametrize("name", ["nothing.js", "..%2f..%2fscripts.py", "%2e%2e"])
def test_no_other_file_is_served(api: Api, name: str) -> None:
    problem_of(api.client.get(f"/docs/assets/{name}"), 404, ProblemType.NOT_FOUND)
