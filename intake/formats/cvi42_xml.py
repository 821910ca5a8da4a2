"""The XML of a cvi42 workspace, read as it streams by: no tree, no entities, bounded counts.

An `item` with a `key` in cvi42's Hash namespace names what it holds; a contour lies at
`ImageStates` / SOP instance UID / `Contours` / name / `Points`, wherever in the file that is.
"""

import re
from dataclasses import dataclass, field
from xml.etree.ElementTree import ParseError

from defusedxml import DefusedXmlException
from defusedxml.ElementTree import DefusedXMLParser

from intake.formats.clinical_faults import too_large, unreadable
from intake.limits import Limits
from schemas.problem import InputError

MAX_ELEMENTS = 2_500_000
"""A point is three, and a workspace says much beside contours."""

MAX_DEPTH = 64

MAX_ATTRIBUTES = 1_000
"""Of one element: the parser has them all before anything here is asked."""

_KEY = "{http://www.circlecvi.com/cvi42/Workspace/Hash/}key"
_LONG_TAG = re.compile(rb"<[^<!?][^<]{32768,}+")
_CHUNK_BYTES = 1 << 16
_MAX_NUMBER = 40
_FARTHEST = 1e7
_IMAGES, _CONTOURS, _POINTS, _SUBPIXELS = "ImageStates", "Contours", "Points", "SubpixelResolution"


@dataclass(eq=False)
class WorkspaceContour:
    """One contour: x and y in parts of a pixel, `subpixels` parts a pixel where it says so."""

    image: str
    name: str
    x: list[float] = field(default_factory=list)
    y: list[float] = field(default_factory=list)
    subpixels: float | None = None


def read_workspace(data: bytes, file: str, limits: Limits) -> list[WorkspaceContour]:
    """Every contour of every image state, whatever its name, in the order of the file.

    Raises:
        InputError: at `file`: no XML, with a document type or entities, too deep or too long, or
            with a coordinate that is no number.
    """
    target = _Workspace(file, limits)
    if any(long.group().count(b"=") > MAX_ATTRIBUTES for long in _LONG_TAG.finditer(data)):
        raise too_large(
            file,
            f"The workspace has an element with more than {MAX_ATTRIBUTES} attributes",
            "export the workspace anew from cvi42",
        )
    parser = DefusedXMLParser(target=target, forbid_dtd=True)
    try:
        for start in range(0, len(data), _CHUNK_BYTES):
            parser.feed(data[start : start + _CHUNK_BYTES])
        parser.close()
    except DefusedXmlException as error:
        raise unreadable(
            file,
            "has a document type or entities, which a workspace has not and which are not read",
            "export the workspace anew from cvi42 as Cvi42 XML Workspace (*.cvi42wsx)",
        ) from error
    except ParseError as error:
        line, column = error.position
        raise unreadable(
            file,
            f"is not well-formed XML at line {line}, column {column}",
            "export the workspace as Cvi42 XML Workspace (*.cvi42wsx), and unpack it if it is "
            "an archive",
        ) from error
    except (LookupError, ValueError) as error:
        raise unreadable(
            file, "is in an encoding that is not read here", "write it as XML in UTF-8"
        ) from error
    if not target.has_images:
        raise unreadable(
            file,
            "is not a cvi42 workspace: it has no ImageStates",
            "export the workspace as Cvi42 XML Workspace (*.cvi42wsx)",
        )
    return [contour for contour in target.contours if contour.x]


class _Workspace:
    """What the parser tells of every element."""

    def __init__(self, file: str, limits: Limits) -> None:
        self.contours: list[WorkspaceContour] = []
        self.has_images = False
        self._file = file
        self._most_points = 4 * limits.max_points
        self._keys: list[str] = []
        self._elements = self._points = 0
        self._text: list[str] | None = None
        self._now: WorkspaceContour | None = None
        self._depth = 0

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        self._elements += 1
        if self._elements > MAX_ELEMENTS:
            raise self._too_much(f"more than {MAX_ELEMENTS} elements")
        keys = self._keys
        keys.append(attributes.get(_KEY, ""))
        if len(keys) > MAX_DEPTH:
            raise self._too_much(f"elements more than {MAX_DEPTH} deep")
        if keys[-1] == _IMAGES:
            self.has_images = True
        if len(keys) > 3 and keys[-2] == _CONTOURS and keys[-4] == _IMAGES:
            self._now = WorkspaceContour(image=keys[-3].strip(), name=keys[-1])
            self._depth = len(keys)
            self.contours.append(self._now)
        self._text = [] if self._is_number(tag) else None

    def data(self, text: str) -> None:
        if self._text is not None and len(self._text) < _MAX_NUMBER:
            self._text.append(text[:_MAX_NUMBER])

    def end(self, tag: str) -> None:
        if self._text is not None and self._now is not None:
            self._take(self._now, tag, "".join(self._text))
        self._text = None
        self._keys.pop()
        if self._now is not None and len(self._keys) < self._depth:
            self._check_pairs(self._now)
            self._now = None

    def close(self) -> None:
        """Nothing is left to be done at the end of the document."""

    def _is_number(self, tag: str) -> bool:
        keys, depth = self._keys, self._depth
        if self._now is None:
            return False
        if len(keys) == depth + 1:
            return keys[-1] == _SUBPIXELS
        return len(keys) == depth + 3 and keys[depth] == _POINTS and tag.endswith(("}x", "}y"))

    def _take(self, contour: WorkspaceContour, tag: str, text: str) -> None:
        value = _finite(text)
        if value is None or (self._keys[-1] == _SUBPIXELS and value <= 0.0):
            raise unreadable(
                self._file,
                "has a coordinate that is no finite number, or a SubpixelResolution that is not "
                "positive",
                "export the workspace anew from cvi42",
            )
        if self._keys[-1] == _SUBPIXELS:
            contour.subpixels = value
        elif tag.endswith("}x"):
            self._points += 1
            if self._points > self._most_points:
                raise self._too_much(f"more than {self._most_points} points")
            contour.x.append(value)
        else:
            contour.y.append(value)

    def _check_pairs(self, contour: WorkspaceContour) -> None:
        if len(contour.x) != len(contour.y):
            raise unreadable(
                self._file, "has a point without x or y", "export the workspace anew from cvi42"
            )

    def _too_much(self, what: str) -> InputError:
        return too_large(
            self._file, f"The workspace has {what}", "export the workspace of one study alone"
        )


def _finite(text: str) -> float | None:
    """A number within ten million, as every coordinate here; None for anything else."""
    try:
        value = float(text)
    except ValueError:
        return None
    return value if abs(value) <= _FARTHEST else None
