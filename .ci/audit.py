"""Are there known vulnerabilities in what constraints.txt pins? `make audit` runs this.

Exit code 0: none, or nobody could be asked, which is said; 1: some, or an exception in
pyproject.toml that has run out; 2: pip-audit failed for another reason. With
NEURALMRI_REQUIRE_AUDIT=1 not to have asked is a failure, too: 3.

"Nothing found" is said of packages that the service answered for, and of no others: pip-audit ends
with success as well where it was told of none.
"""

import json
import os
import subprocess
import sys
import tempfile
import tomllib
from datetime import UTC, date, datetime
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]

CLEAN, FOUND, BROKEN, NOT_ASKED = 0, 1, 2, 3

_UNREACHED = (
    *("Could not connect", "ConnectionError", "ConnectTimeout", "ReadTimeout", "ProxyError"),
    *("SSLError", "NameResolutionError", "Max retries exceeded", "No module named pip_audit"),
)
"""What pip-audit's last words hold where it found nobody to ask, or is not there itself."""


def verdict(
    report: dict[str, Any] | None, last_words: str, exceptions: list[dict[str, Any]], today: date
) -> tuple[int, list[str]]:
    """The exit code, and what to say.

    report: pip-audit's, None where it wrote none. exceptions: of pyproject.toml: id, reason, until.
    """
    over = [one for one in exceptions if one["until"] < today]
    if over:
        return FOUND, [f"the exception for {one['id']} has run out: mend it" for one in over]
    if report is None:
        if any(sign in last_words for sign in _UNREACHED):
            return NOT_ASKED, ["NOT AUDITED: no vulnerability service was reached"]
        return BROKEN, ["pip-audit failed", last_words]
    packages = report["dependencies"]
    unknown = [one["name"] for one in packages if "skip_reason" in one]
    excused = {one["id"] for one in exceptions}
    said = [
        f"{one['name']} {one['version']}: {flaw['id']}, mended in "
        f"{', '.join(flaw['fix_versions']) or 'no version'}"
        for one in packages
        for flaw in one.get("vulns", [])
        if not excused & {flaw["id"], *flaw.get("aliases", [])}
    ]
    if said:
        return FOUND, said
    if len(unknown) == len(packages):
        return NOT_ASKED, ["NOT AUDITED: the vulnerability service answered for no package"]
    said = [f"no known vulnerability in {len(packages) - len(unknown)} packages"]
    if unknown:
        said.append(f"NOT AUDITED, unknown to the service: {', '.join(unknown)}")
    return CLEAN, said


def asked() -> tuple[dict[str, Any] | None, str]:
    """pip-audit's report on constraints.txt, and what it wrote on standard error."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "report.json"
        ended = subprocess.run(  # noqa: S603 - our own arguments
            [
                *(sys.executable, "-m", "pip_audit", "--no-deps", "--disable-pip"),
                *("--requirement", str(ROOT / "constraints.txt"), "--format", "json"),
                *("--output", str(path), "--progress-spinner", "off", "--timeout", "15"),
            ],
            capture_output=True,
            text=True,
            check=False,
        )
        return (json.loads(path.read_text()) if path.exists() else None), ended.stderr


def main() -> int:
    """Say the verdict of today."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    exceptions = project["tool"]["neuralmri"]["audit"]["exceptions"]
    code, lines = verdict(*asked(), exceptions, datetime.now(UTC).date())
    for line in lines:
        print(f"audit: {line}", file=sys.stderr)
    if code == NOT_ASKED and os.environ.get("NEURALMRI_REQUIRE_AUDIT") != "1":
        return CLEAN
    return code


if __name__ == "__main__":
    sys.exit(main())
