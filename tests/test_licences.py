"""What the images install may be passed on: permissive licences, and by name what is not quite."""

import re
import tomllib
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]

PERMISSIVE = {
    *("MIT", "MIT-0", "MIT-CMU", "BSD-2-Clause", "BSD-3-Clause", "0BSD", "ISC", "Zlib", "CC0-1.0"),
    *("Apache-2.0", "Apache-2.0 WITH LLVM-exception", "BSL-1.0", "PSF-2.0", "Unlicense"),
    # As the older metadata spells them.
    *("BSD", "New BSD", "MIT License", "BSD License", "Apache Software License"),
    *("Python Software Foundation License",),
}

NAMED = {
    "certifi": "MPL-2.0: Mozilla's list of certificate authorities, unmodified",
    "libigl": "MPL-2.0: unmodified, and without the folders that `TAKEN_OUT` names",
}
"""Licences with conditions on changes to the files themselves, which we do not make."""

TAKEN_OUT = ("igl/copyleft", "igl/triangle")
"""Of libigl's wheel: CGAL (GPL), tetgen (AGPL), triangle (not for trade). Nothing loads them."""

GNU_TEXTS = {
    "libigl": "for `igl/copyleft`, which is taken out of the image",
    "numpy": "libgfortran and libquadmath in its wheel: GPL with the runtime exception, LGPL",
    "pillow": "a list of what xz's sources hold; of them the wheel has liblzma alone, 0BSD",
    "scipy": "the same libraries as numpy",
    "setuptools": "autocommand, LGPL-3.0, unmodified in a folder of its own; nothing here loads it",
    "shapely": "GEOS in its wheel: LGPL-2.1, a shared library of its own that can be exchanged",
    "torch": "the tests of a library that a profiler's sources hold; a text, no program",
    "typing-extensions": "Python's own licence, which tells that it fits the GPL",
}
"""Why a GNU licence is among the texts that a wheel comes with: what is said of each in metadata is
of its own code, not of the libraries that it bundles.
"""

_GNU = re.compile(r"GNU (?:LESSER |LIBRARY |AFFERO )?GENERAL PUBLIC LICENSE", re.IGNORECASE)


def installed_by(extra: str) -> dict[str, Distribution]:
    """Every distribution that an extra of ours installs, through others too."""
    found: dict[tuple[str, frozenset[str]], Distribution | None] = {}

    def walk(line: str) -> None:
        requirement = Requirement(line)
        name, extras = canonicalize_name(requirement.name), requirement.extras or {""}
        if requirement.marker is not None and not requirement.marker.evaluate({"extra": ""}):
            return
        if name == PROJECT["name"]:
            lines = [one for inner in extras for one in PROJECT["optional-dependencies"][inner]]
            for one in [*PROJECT["dependencies"], *lines]:
                walk(one)
            return
        key = (name, frozenset(extras))
        if key in found:
            return
        try:
            found[key] = distribution(name)
        except PackageNotFoundError:
            pytest.fail(f"{name}, which {extra} needs, is not installed here")
        for inner in distribution(name).requires or []:
            asked = Requirement(inner)
            if asked.marker is None or any(asked.marker.evaluate({"extra": e}) for e in extras):
                asked.marker = None
                walk(str(asked))

    walk(f"{PROJECT['name']}[{extra}]")
    return {name: one for (name, _), one in sorted(found.items()) if one is not None}


def stated(found: Distribution) -> str:
    """What a distribution says its licence is: an SPDX expression where it has one."""
    expression = found.metadata.get("License-Expression")
    if expression:
        return str(expression)
    classifiers = [
        str(line).rpartition(" :: ")[2]
        for line in found.metadata.get_all("Classifier") or []
        if str(line).startswith("License :: ")
    ]
    return " OR ".join(classifiers) or str(found.metadata.get("License", "")).strip()


def is_permissive(expression: str) -> bool:
    """Whether one may choose permissive terms: of an OR one, of an AND all. No parentheses."""
    return any(
        all(part.strip() in PERMISSIVE for part in choice.split(" AND "))
        for choice in expression.split(" OR ")
    )


def has_gnu_text(found: Distribution) -> bool:
    """Whether it comes with the text of a GNU licence, or with a text that speaks of one."""
    texts = [
        Path(str(file.locate()))
        for file in found.files or []
        if re.search(r"licen[cs]e|copying|notice", file.name, re.IGNORECASE)
        and file.suffix not in (".py", ".pyc")
    ]
    return any(_GNU.search(path.read_text(errors="replace")) for path in texts if path.is_file())


@pytest.mark.parametrize("extra", ["service", "worker"])
def test_images_hold_permissive_licences_and_those_named(extra: str) -> None:
    said = {name: stated(one) for name, one in installed_by(extra).items()}
    assert len(said) > 20
    others = {name: text for name, text in said.items() if not is_permissive(text)}
    assert others.keys() - NAMED.keys() == set(), others
    for name in others:
        assert not re.search(r"\bA?GPL|GNU (?:Affero )?General", others[name]), name


def test_gnu_licences_among_the_texts_are_explained_by_name() -> None:
    every = installed_by("service") | installed_by("worker")
    assert {name for name, one in every.items() if has_gnu_text(one)} == GNU_TEXTS.keys()


def test_the_image_leaves_out_what_may_not_be_passed_on() -> None:
    """In the layers that the image takes over, and before it is tried whether all loads."""
    lines = (ROOT / "docker" / "worker.Dockerfile").read_text()
    for folder in TAKEN_OUT:
        removed = lines.index(f"/opt/neuralmri/lib/python3*/site-packages/{folder}")
        assert removed < lines.index('-c "import fast_simplification, igl')
    binaries = [str(file) for file in distribution("libigl").files or [] if file.suffix == ".so"]
    rest = [one for one in binaries if not one.startswith(TAKEN_OUT)]
    assert {Path(one).parent.name for one in rest} == {
        *("igl", "cycodebase", "embree", "predicates", "spectra"),
    }, "a part that nobody has judged"


def test_no_name_is_listed_for_nothing() -> None:
    every = installed_by("service") | installed_by("worker")
    assert {name for name, one in every.items() if not is_permissive(stated(one))} == NAMED.keys()


@pytest.mark.parametrize(
    ("expression", "verdict"),
    [
        ("MIT", True),
        ("GPL-3.0-only OR MIT", True),
        ("MIT AND GPL-3.0-only", False),
        ("AGPL-3.0-or-later", False),
        ("LGPL-2.1-or-later", False),
        ("", False),
        ("Apache-2.0 AND Apache-2.0 WITH LLVM-exception", True),
    ],
)
def test_what_is_permissive(expression: str, verdict: bool) -> None:
    assert is_permissive(expression) is verdict
