"""The API description as pages: Swagger UI at /docs, ReDoc at /redoc. No other origin is asked.

Scripts and styles are files of the package `fastapi-standalone-docs` (Swagger UI: Apache-2.0,
ReDoc: MIT); of its code nothing is used. Addresses are relative, so that a proxy may put the
service below a path.
"""

from pathlib import Path

import fastapi_standalone_docs
from fastapi import APIRouter
from starlette.responses import FileResponse, HTMLResponse, Response

from schemas.problem import InputError, ProblemType

router = APIRouter(include_in_schema=False)

_STATIC = Path(fastapi_standalone_docs.__path__[0]) / "static"
_FILES = {
    "swagger-ui-bundle.js": _STATIC / "swagger" / "swagger-ui-bundle.js",
    "swagger-ui.css": _STATIC / "swagger" / "swagger-ui.css",
    "redoc.standalone.js": _STATIC / "redoc" / "redoc.standalone.js",
    "favicon.png": _STATIC / "fastapi" / "favicon.png",
}
_LOGO = _STATIC / "redoc" / "logo-mini.svg"

_KEPT_FOR = {"Cache-Control": "public, max-age=86400"}

# Both write style elements from their scripts; no script but the files themselves runs.
_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' data:; connect-src 'self'; worker-src blob:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)

_HEAD = """\
<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>neuralmri</title>
<link rel="icon" href="docs/assets/favicon.png">
"""
_SWAGGER = f"""\
{_HEAD}<link rel="stylesheet" href="docs/assets/swagger-ui.css">
</head>
<body>
<div id="swagger-ui"></div>
<script src="docs/assets/swagger-ui-bundle.js"></script>
<script src="docs/start.js"></script>
</body>
</html>
"""
_START = """\
SwaggerUIBundle({
  url: "openapi.json",
  dom_id: "#swagger-ui",
  deepLinking: true,
  validatorUrl: null,
  presets: [SwaggerUIBundle.presets.apis],
});
"""
_REDOC = f"""\
{_HEAD}</head>
<body style="margin: 0">
<redoc spec-url="openapi.json"></redoc>
<script src="docs/assets/redoc.standalone.js"></script>
</body>
</html>
"""


def _page(html: str) -> HTMLResponse:
    return HTMLResponse(html, headers={"Content-Security-Policy": _POLICY})


@router.get("/docs")
def swagger_page() -> HTMLResponse:
    """The description with a form for each call."""
    return _page(_SWAGGER)


@router.get("/redoc")
def redoc_page() -> HTMLResponse:
    """The description to read."""
    return _page(_REDOC)


@router.get("/docs/start.js")
def start_swagger() -> Response:
    """What starts Swagger UI: a file, since the page's policy allows no script within it."""
    return Response(_START, media_type="text/javascript", headers=_KEPT_FOR)


@router.get("/docs/assets/{name}")
def page_asset(name: str) -> FileResponse:
    """A script, style or picture of the two pages."""
    if name not in _FILES:
        raise InputError(
            ProblemType.NOT_FOUND, "the pages have no such file. Remedy: see /docs.", status=404
        )
    return FileResponse(_FILES[name], headers=_KEPT_FOR)


@router.get("/redoc/logo-mini.svg")
def redoc_logo() -> FileResponse:
    """The mark at the foot of ReDoc, which the script looks for below its page."""
    return FileResponse(_LOGO, headers=_KEPT_FOR)
