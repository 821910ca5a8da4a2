"""Laws of the two Dockerfiles' text, and a linter that must find nothing."""

import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DOCKER = ROOT / "docker"
SERVICE = DOCKER / "service.Dockerfile"
WORKER = DOCKER / "worker.Dockerfile"

both = pytest.mark.parametrize("dockerfile", [SERVICE, WORKER], ids=lambda path: path.stem)


def instructions(dockerfile: Path) -> list[str]:
    """One string an instruction: comments dropped, continued lines joined."""
    lines = [line for line in dockerfile.read_text().splitlines() if not line.startswith("#")]
    joined = re.sub(r"\\\n\s*", "", "\n".join(lines))
    return [line for line in joined.splitlines() if line.strip()]


def final_stage(dockerfile: Path) -> list[str]:
    found = instructions(dockerfile)
    last_from = max(i for i, line in enumerate(found) if line.startswith("FROM "))
    return found[last_from:]


def copied_packages(dockerfile: Path) -> set[str]:
    packages = {path.parent.name for path in ROOT.glob("*/__init__.py")}
    words = {
        word
        for line in instructions(dockerfile)
        if line.startswith("COPY ")
        for word in line.split()
    }
    return packages & words


def lint(path: str, text: str | None = None) -> subprocess.CompletedProcess[str]:
    # Strict: every severity counts, none is ignored by a configuration file elsewhere.
    beside_python = str(Path(sys.executable).parent)
    hadolint = shutil.which("hadolint", path=os.pathsep.join([beside_python, os.environ["PATH"]]))
    assert hadolint, "hadolint is not installed; install the test extra"
    return subprocess.run(
        [hadolint, "--no-color", "--failure-threshold", "style", path],
        input=text,
        capture_output=True,
        text=True,
        cwd=DOCKER,
        timeout=60,
        check=False,
    )


@both
def test_linter_finds_nothing(dockerfile: Path) -> None:
    found = lint(str(dockerfile))
    assert (found.returncode, found.stdout) == (0, "")


def test_linter_finds_what_is_wrong() -> None:
    found = lint("-", "FROM python:latest\nRUN pip install torch\n")
    assert found.returncode == 1
    assert "DL3007" in found.stdout
    assert "DL3013" in found.stdout


@both
def test_base_is_pinned_to_a_patch_version_and_may_be_pinned_to_a_digest(dockerfile: Path) -> None:
    found = instructions(dockerfile)
    assert re.fullmatch(r"ARG PYTHON_IMAGE=python:3\.12\.\d+-slim-bookworm", found[0])
    bases = [line.split()[1] for line in found if line.startswith("FROM ")]
    assert bases == ["${PYTHON_IMAGE}"] * 2


def test_both_images_have_the_same_base_and_owner() -> None:
    def shared(path: Path) -> list[str]:
        return [
            line
            for line in instructions(path)
            if line.startswith(("ARG PYTHON", "RUN groupadd", "USER"))
        ]

    assert shared(SERVICE) == shared(WORKER)


@both
def test_extras_exist_and_versions_are_constrained(dockerfile: Path) -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    text = "\n".join(instructions(dockerfile))
    extras = re.findall(r'"\.\[(\w+)\]"', text)
    assert extras == [dockerfile.stem, "s3", "otel"]
    assert set(extras) <= set(project["optional-dependencies"])
    installs = [run for run in instructions(dockerfile) if re.match(r"RUN (pip|if .*\bpip) ", run)]
    assert len(installs) >= 3
    for run in installs:
        assert "--constraint constraints.txt" in run or "--no-deps" in run


def test_service_has_neither_torch_nor_the_science() -> None:
    assert "torch" not in "\n".join(instructions(SERVICE))
    assert copied_packages(SERVICE) == {"schemas", "intake", "jobs", "service"}


def test_worker_has_no_http_server_and_torch_for_cpus_only() -> None:
    assert copied_packages(WORKER) == {"schemas", "intake", "jobs", "worker"}
    text = "\n".join(instructions(WORKER))
    assert "ARG TORCH_INDEX_URL=" in text
    assert "assert torch.version.cuda is None" in text
    # torch comes from that index before anything could pull in another build of it.
    assert text.index("${TORCH_INDEX_URL}") < text.index(".[worker]")


@both
def test_packages_of_an_image_import_each_other_only(dockerfile: Path) -> None:
    packages = {path.parent.name for path in ROOT.glob("*/__init__.py")}
    missing = packages - copied_packages(dockerfile)
    pattern = re.compile(rf"^\s*(?:from|import) ({'|'.join(sorted(missing))})\b", re.MULTILINE)
    for package in copied_packages(dockerfile):
        for source in (ROOT / package).rglob("*.py"):
            assert not pattern.findall(source.read_text()), source


@both
def test_final_stage_has_no_compiler_no_installer_and_no_root(dockerfile: Path) -> None:
    stage = final_stage(dockerfile)
    text = "\n".join(stage)
    assert not re.search(r"apt-get|gcc|g\+\+|build-essential|pip install", text)
    assert "pip uninstall --yes pip" in text
    users = [line.split()[1] for line in stage if line.startswith("USER ")]
    assert users == ["10001:10001"]
    assert stage.index("USER 10001:10001") > max(
        i for i, s in enumerate(stage) if s.startswith("RUN")
    )


@both
def test_final_stage_suits_a_read_only_root(dockerfile: Path) -> None:
    env = next(line for line in final_stage(dockerfile) if line.startswith("ENV "))
    for setting in ("PYTHONDONTWRITEBYTECODE=1", "PYTHONUNBUFFERED=1", "HOME=/tmp"):
        assert setting in env.split()


@both
def test_final_stage_is_labelled_watched_and_stoppable(dockerfile: Path) -> None:
    text = "\n".join(final_stage(dockerfile))
    for name in ("title", "description", "licenses", "version", "revision"):
        assert f"org.opencontainers.image.{name}=" in text
    assert "HEALTHCHECK " in text
    assert "STOPSIGNAL SIGTERM" in text
    # Exec form: the process is signalled itself, not a shell around it.
    assert re.search(r'^CMD \["', text, re.MULTILINE)


def test_sigterm_reaches_the_worker_as_itself() -> None:
    """Celery says that it shuts down only after the soft shutdown when SIGTERM is remapped."""
    env = next(line for line in final_stage(WORKER) if line.startswith("ENV "))
    assert "REMAP_SIGTERM" not in env


def test_build_context_holds_what_is_copied_and_little_else() -> None:
    allowed = {
        line[1:]
        for line in (ROOT / ".dockerignore").read_text().splitlines()
        if line.startswith("!")
    }
    copied: set[str] = set()
    for dockerfile in (SERVICE, WORKER):
        for line in instructions(dockerfile):
            if line.startswith("COPY ") and "--from" not in line:
                copied.update(line.split()[1:-1])
    assert allowed == copied
    assert all((ROOT / name).exists() or name == "README.md" for name in allowed)
