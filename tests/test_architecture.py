"""The house as a law: import contracts, what a process loads, where files may be."""

import ast
import fnmatch
import re
import subprocess
import sys
import sysconfig
import tomllib
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[1]
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
PACKAGES = sorted(path.parent.name for path in ROOT.glob("*/__init__.py"))

SCIENCE = ("torch", "scipy", "skimage", "trimesh", "nibabel", "igl", "vtk", "worker")


def files_of_the_tree() -> list[Path]:
    """Every file that is, or would be, committed."""
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard", "-z"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    paths = [ROOT / name for name in listed.stdout.split("\0") if name]
    return [path for path in paths if path.is_file()]


in_a_checkout = pytest.mark.skipif(not (ROOT / ".git").exists(), reason="not a git checkout")


def loaded_by(statement: str) -> set[str]:
    """Top-level modules that a fresh interpreter holds after a statement."""
    return {name.partition(".")[0] for name in modules_loaded_by(statement)}


def modules_loaded_by(statement: str) -> set[str]:
    """The same, with their full names."""
    code = f"{statement}\nimport sys\nprint(*sys.modules)"
    ended = subprocess.run(
        [sys.executable, "-c", code],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert ended.returncode == 0, ended.stderr
    return set(ended.stdout.split())


def house() -> tuple[set[str], set[str]]:
    """Top-level folders and their rooms, as docs/architecture.md lists them."""
    text = (ROOT / "docs" / "architecture.md").read_text()
    block = re.search(r"^## The house\n.*?^```\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    assert block, "docs/architecture.md has no fenced tree under '## The house'"
    floors: set[str] = set()
    rooms: set[str] = set()
    floor = ""
    for indent, name in re.findall(r"^( *)([\w.-]+)/(?:\s|$)", block[1], re.MULTILINE):
        if indent:
            rooms.add(f"{floor}/{name}")
        else:
            floor = name
            floors.add(name)
    return floors, rooms


def test_import_contracts_hold() -> None:
    lint_imports = Path(sysconfig.get_path("scripts")) / "lint-imports"
    ended = subprocess.run(
        [lint_imports, "--no-cache"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert ended.returncode == 0, ended.stdout + ended.stderr


def test_contracts_cover_every_package() -> None:
    contracts = PYPROJECT["tool"]["importlinter"]
    assert sorted(contracts["root_packages"]) == PACKAGES
    layers = next(c["layers"] for c in contracts["contracts"] if c["type"] == "layers")
    assert sorted(name for layer in layers for name in layer.split(" | ")) == PACKAGES


def test_fresh_interpreter_reports_what_it_loads() -> None:
    assert "wave" in loaded_by("import wave")
    assert "wave" not in loaded_by("pass")


@pytest.mark.parametrize("module", ["service.app", "jobs.settings", "schemas.study"])
def test_service_loads_nothing_of_the_science(module: str) -> None:
    assert not loaded_by(f"import {module}") & set(SCIENCE)


@pytest.mark.parametrize("module", ["service.app", "worker.task"])
def test_who_keeps_jobs_on_a_disk_needs_no_client_of_buckets(module: str) -> None:
    """jobs/open_store.py loads it where the settings name one, and after the worker's fork."""
    assert not loaded_by(f"import {module}") & {"s3fs", "aiobotocore", "botocore"}


def test_worker_loads_torch_in_no_process_that_forks() -> None:
    """Celery forks after importing the app; torch's threads do not survive a fork."""
    assert "torch" not in loaded_by("import worker.app")


def test_schemas_load_pydantic_and_the_standard_library_only() -> None:
    pydantic = {"pydantic", "pydantic_core", "annotated_types", "typing_extensions"}
    modules = sorted(path.stem for path in (ROOT / "schemas").glob("[!_]*.py"))
    loaded = loaded_by("\n".join(f"import schemas.{name}" for name in modules))
    assert "schemas" in loaded
    third_party = loaded - loaded_by("pass") - sys.stdlib_module_names - pydantic - {"schemas"}
    # pydantic's smallest companion, and what the interpreter generates for its own platform.
    third_party -= {"typing_inspection"} | {name for name in third_party if name.startswith("_")}
    assert not third_party


def declared(extra: str | None) -> set[str]:
    """Distributions that an extra names, itself or through another of our extras."""
    project = PYPROJECT["project"]
    wanted = project["dependencies"] if extra is None else project["optional-dependencies"][extra]
    names = set() if extra is None else declared(None)
    for line in wanted:
        requirement = Requirement(line)
        if requirement.name == project["name"]:
            for inner in requirement.extras:
                names |= declared(inner)
        else:
            names.add(canonicalize_name(requirement.name))
    return names


def third_party_imports(package: str) -> set[str]:
    """Top-level modules that the files of a package import from outside of this tree."""
    names = set()
    for path in (ROOT / package).rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                names |= {alias.name.partition(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                names.add(node.module.partition(".")[0])
    return names - sys.stdlib_module_names - set(PACKAGES)


@pytest.mark.parametrize(
    ("package", "extra"),
    [
        ("schemas", None),
        ("intake", "queue"),
        ("jobs", "s3"),
        ("service", "service"),
        ("worker", "worker"),
        ("cli", "cli"),
    ],
)
def test_what_a_package_imports_is_declared(package: str, extra: str | None) -> None:
    """An image installs one extra; what came along by chance may stay away next time."""
    distributions = packages_distributions()
    undeclared = {
        module
        for module in third_party_imports(package)
        if not {canonicalize_name(d) for d in distributions.get(module, [])}
        & (declared(extra) | (declared("otel") if package == "jobs" else set()))
    }
    assert not undeclared, f"name what provides {undeclared} in pyproject's extra {extra}"


def test_what_sends_spans_is_imported_in_one_file_only() -> None:
    """Most installations lack its extra; the file is loaded where spans are wanted."""
    importing = {
        str(path.relative_to(ROOT))
        for package in PACKAGES
        for path in (ROOT / package).rglob("*.py")
        if re.search(r"^\s*(from|import) opentelemetry\b", path.read_text(), re.MULTILINE)
    }
    assert importing == {"jobs/span_export.py"}
    assert "jobs.span_export" not in modules_loaded_by("import service.process, worker.app")


def test_every_package_is_installed() -> None:
    patterns = PYPROJECT["tool"]["setuptools"]["packages"]["find"]["include"]
    folders = {path.parent for name in PACKAGES for path in (ROOT / name).rglob("*.py")}
    for folder in folders:
        package = ".".join(folder.relative_to(ROOT).parts)
        assert (folder / "__init__.py").is_file(), f"{package} has no __init__.py"
        assert any(fnmatch.fnmatch(package, pattern) for pattern in patterns), package


@in_a_checkout
def test_every_top_level_folder_is_in_the_house() -> None:
    floors, rooms = house()
    tree = {path.relative_to(ROOT).parts for path in files_of_the_tree()}
    visible = {parts[0] for parts in tree if len(parts) > 1 and not parts[0].startswith(".")}
    assert visible <= floors, "list the new folder in docs/architecture.md, or do without it"
    for listed in floors | rooms:
        assert (ROOT / listed).is_dir(), f"docs/architecture.md lists {listed}/, which is not there"


def test_every_room_of_a_package_is_in_the_house() -> None:
    _, rooms = house()
    found = {
        "/".join(path.parent.relative_to(ROOT).parts)
        for name in PACKAGES
        for path in (ROOT / name).glob("*/__init__.py")
    }
    assert found <= rooms


@in_a_checkout
def test_no_file_speaks_of_one_machine() -> None:
    """A path that exists on one computer only is of no use to anybody else."""
    roots = "|".join(("work", "home", "root", "Users", "tmp/dev", "opt/pypi[a-z-]*", "mnt", "data"))
    machine_path = re.compile(rf"(?<![\w.)}}$/<-])/(?:{roots})/[\w.-]+")
    found = []
    for path in files_of_the_tree():
        try:
            text = path.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue  # an image or a label map
        for number, line in enumerate(text.splitlines(), start=1):
            found += [
                f"{path.relative_to(ROOT)}:{number}: {hit}" for hit in machine_path.findall(line)
            ]
    assert not found


@in_a_checkout
def test_no_drawer_for_odds_and_ends() -> None:
    refused = {"utils", "util", "helpers", "common", "core", "misc"}
    names = {
        part
        for path in files_of_the_tree()
        for part in path.relative_to(ROOT).with_suffix("").parts
    }
    assert not names & refused
