"""Submissions of label maps, spoilt: in header, voxels, compression, form, on the wire."""

import gzip
import json
import struct
import zlib
from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

from hypothesis import strategies as st

from benchmarks.fuzzing.seeds import LABEL_REQUEST, label_maps
from benchmarks.fuzzing.upload import Framing, Upload

PATH = "/v1/jobs/labels"

Draw = Callable[[st.SearchStrategy[Any]], Any]

_BOUNDARY = "fuzzed-0f3c"
_BOMB_BYTES = 300 << 20
"""Of zeros, inflated: more than one label map may hold."""


class Part(NamedTuple):
    """A part of a form, with what stands in its Content-Disposition and below."""

    disposition: str
    lines: tuple[str, ...]
    content: bytes


class Field(NamedTuple):
    """A field of a NIfTI-1 header: its name, where it is, and what to write there."""

    name: str
    layout: str
    offset: int
    values: tuple[Any, ...]


_INF, _NAN = float("inf"), float("nan")
_FLOATS = (0.0, -1.0, 1e-30, 0.001, 0.5, 1e3, 1e30, 3.4e38, _INF, -_INF, _NAN)
_FIELDS = (
    Field("sizeof_hdr", "<i", 0, (0, 347, 349, 540, -1, 2**31 - 1, 348 << 16)),
    *(Field(f"dim[{k}]", "<h", 40 + 2 * k, (0, -1, 1, 2, 3, 5, 7, 8, 64, 32767)) for k in range(8)),
    Field("datatype", "<h", 70, (0, 1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 768, 1024, 1792, 9999)),
    Field("bitpix", "<h", 72, (0, 1, 8, 16, 64, -8)),
    *(Field(f"pixdim[{k}]", "<f", 76 + 4 * k, _FLOATS) for k in range(8)),
    Field("vox_offset", "<f", 108, (0.0, 348.0, 351.0, 352.5, 353.0, 1e9, -352.0, _NAN, _INF)),
    Field("scl_slope", "<f", 112, _FLOATS),
    Field("scl_inter", "<f", 116, _FLOATS),
    Field("xyzt_units", "<B", 123, (0, 1, 2, 3, 8, 10, 16, 18, 255)),
    Field("qform_code", "<h", 252, (0, 1, 5, -1)),
    Field("sform_code", "<h", 254, (0, 1, 5, -1)),
    *(Field(f"quatern[{k}]", "<f", 256 + 4 * k, _FLOATS) for k in range(6)),
    *(Field(f"srow[{k}]", "<f", 280 + 4 * k, _FLOATS) for k in range(12)),
    Field("magic", "<4s", 344, (b"n+1\0", b"ni1\0", b"n+2\0", b"\0\0\0\0", b"n+1 ")),
)


def label_uploads() -> st.SearchStrategy[Upload]:
    """Any spoilt submission; one in some hundred is as good as it was."""
    label_maps()  # made here, for making them is no part of a draw
    return _uploads()


@st.composite
def _uploads(draw: Draw) -> Upload:
    faults: list[str] = []
    views = draw(st.sampled_from([("sax",), ("sax",), ("sax", "lax_4ch"), tuple(label_maps())]))
    parts = [_request(draw, faults)]
    for view in views:
        content = _packed(draw, _map(draw, label_maps()[view], faults), faults)
        parts.append(_file(view, f"{view}.nii.gz", content))
    if draw(st.integers(0, 3)) == 0:
        parts = _form_fault(draw, parts, faults)
    body = _form(parts)
    content_type = f"multipart/form-data; boundary={_BOUNDARY}"
    if draw(st.integers(0, 9)) == 0:
        body, content_type = _body_fault(draw, body, content_type, faults)
    framing = Framing.LENGTH
    if draw(st.integers(0, 9)) == 0:
        framing = draw(st.sampled_from(Framing))
        faults.append(framing.value)
    return Upload(PATH, body, {"Content-Type": content_type}, framing, tuple(faults))


def _map(draw: Draw, file: bytes, faults: list[str]) -> bytes:
    """The file inside the compression, with some fields and voxels changed."""
    found = bytearray(file)
    for _ in range(draw(st.integers(0, 2))):
        changed = draw(st.sampled_from(_FIELDS))
        value = draw(st.sampled_from(changed.values))
        struct.pack_into(changed.layout, found, changed.offset, value)
        faults.append(f"{changed.name} = {value!r}")
    fault = draw(st.sampled_from([""] * 9 + list(_VOXELS)))
    if fault:
        faults.append(fault)
        found = bytearray(_VOXELS[fault](draw, bytes(found)))
    return bytes(found)


def _noise(draw: Draw, file: bytes) -> bytes:
    """Voxels at random: labels that exist, in places where no heart has them."""
    seed = draw(st.binary(min_size=8, max_size=64))
    voxels = bytes(b & 3 for b in (seed * (len(file) // len(seed) + 1)))
    return file[:352] + voxels[: len(file) - 352]


def _flipped(draw: Draw, file: bytes) -> bytes:
    at = draw(st.integers(0, len(file) - 1))
    return file[:at] + bytes([draw(st.integers(0, 255))]) + file[at + 1 :]


def _shifted(draw: Draw, file: bytes) -> bytes:
    by = draw(st.integers(1, 2000))
    return file[:352] + bytes(by) + file[352:-by]


_VOXELS: dict[str, Callable[[Draw, bytes], bytes]] = {
    "truncated map": lambda draw, f: f[: draw(st.integers(0, len(f) - 1))],
    "longer map": lambda draw, f: f + bytes(draw(st.sampled_from([1, 1000, 1 << 20]))),
    "noise": _noise,
    "flipped voxel": _flipped,
    "shifted voxels": _shifted,
    "one label": lambda draw, f: f[:352] + bytes([draw(st.integers(0, 255))]) * (len(f) - 352),
    "swapped labels": lambda _, f: f[:352] + f[352:].translate(bytes([0, 3, 2, 1, *range(4, 256)])),
    "only the cavity": lambda _, f: f[:352] + f[352:].translate(bytes([0, 1] + [0] * 254)),
    "a plane": lambda _, f: f[:352] + f[352:][: len(f) // 2] + bytes(len(f) - 352 - len(f) // 2),
}


def _packed(draw: Draw, file: bytes, faults: list[str]) -> bytes:
    """Compressed, not compressed, or compressed as nobody should."""
    whole = gzip.compress(file, mtime=0)
    fault = draw(st.sampled_from(["", "", "", "", "", "", "", "", *_PACKINGS]))
    if not fault:
        return whole if draw(st.booleans()) else file
    faults.append(fault)
    return _PACKINGS[fault](draw, file, whole)


_PACKINGS: dict[str, Callable[[Draw, bytes, bytes], bytes]] = {
    "truncated gzip": lambda draw, _, z: z[: draw(st.integers(0, len(z) - 1))],
    "flipped gzip": lambda draw, _, z: _flipped(draw, z),
    "two members": lambda draw, f, _: gzip.compress(f[:1000]) + gzip.compress(f[1000:]),
    "twice the file": lambda draw, _, z: z + z,
    "garbage behind": lambda draw, _, z: z + draw(st.binary(min_size=1, max_size=64)),
    "zeros behind": lambda draw, _, z: z + bytes(512),
    "gzip of gzip": lambda draw, _, z: gzip.compress(z),
    "empty members": lambda draw, _, z: gzip.compress(b"") * 70_000 + z,
    "empty file": lambda draw, f, z: b"",
    "bomb": lambda draw, f, _: bomb(f),
    "endless name": lambda draw, _, z: (
        z[:3] + b"\x08" + z[4:10] + b"x" * (2 << 20) + b"\0" + z[10:]
    ),
    "zlib": lambda draw, f, _: zlib.compress(f),
    "no map at all": lambda draw, f, z: draw(st.binary(max_size=600)),
}


def bomb(head: bytes) -> bytes:
    """A gzip file of some 300 kB that holds `head` and then 300 MiB of zeros."""
    return gzip.compress(head, mtime=0) + _zeros()


@cache
def _zeros() -> bytes:
    packer = zlib.compressobj(9, zlib.DEFLATED, 31)
    piece = bytes(1 << 20)
    return b"".join([*(packer.compress(piece) for _ in range(_BOMB_BYTES >> 20)), packer.flush()])


def _request(draw: Draw, faults: list[str]) -> Part:
    request: dict[str, Any] = json.loads(json.dumps(LABEL_REQUEST))
    for _ in range(draw(st.sampled_from([0, 0, 0, 1, 2]))):
        name, value = draw(st.sampled_from(_REQUESTS))
        request[name] = value
        faults.append(f"{name}={str(value)[:40]}")
    return Part('name="request"', ("Content-Type: application/json",), json.dumps(request).encode())


_REQUESTS: tuple[tuple[str, Any], ...] = (
    ("label_scheme", "acdc"),
    ("label_scheme", "mmwhs"),
    ("label_scheme", {"lv_cavity": [1], "lv_wall": [2], "rv_cavity": [3]}),
    ("label_scheme", {"lv_cavity": [1, 1], "lv_wall": [1]}),
    ("label_scheme", {"lv_cavity": [2**70]}),
    ("spacing", "pixdim"),
    ("spacing", "affine"),
    ("spacing", "x"),
    ("frame_labels", ["ED"]),
    ("frame_labels", ["ED", "ED"]),
    ("frame_labels", []),
    ("frame_labels", ["../x"]),
    ("beyond_range", True),
    ("subject_id", ""),
    ("subject_id", "../../x"),
    ("options", {"levels": -1}),
    ("options", None),
    ("unknown", 1),
)


def _file(name: str, filename: str, content: bytes) -> Part:
    return Part(
        f'name="{name}"; filename="{filename}"',
        ("Content-Type: application/octet-stream",),
        content,
    )


def _form_fault(draw: Draw, parts: list[Part], faults: list[str]) -> list[Part]:
    fault = draw(st.sampled_from(list(_FORMS)))
    faults.append(fault)
    return _FORMS[fault](draw, parts)


_NAMES = (
    *("../../etc/passwd", "/etc/passwd", "..\\..\\x", "a\x00b", "%2e%2e%2f", "x" * 10_000, ""),
    *('"; name="sax', "é.nii", "sax.nii.gz\r\nX: y", "con", "."),
)
_FORMS: dict[str, Callable[[Draw, list[Part]], list[Part]]] = {
    "twice the same part": lambda draw, p: [*p, p[-1]],
    "request twice": lambda draw, p: [p[0], *p],
    "no request": lambda draw, p: p[1:],
    "request alone": lambda draw, p: p[:1],
    "files first": lambda draw, p: p[::-1],
    "unknown part": lambda draw, p: [*p, _file(draw(st.sampled_from(_NAMES)), "x", b"x")],
    "hundreds of parts": lambda draw, p: [*p, *[_file("reference_ED_lv_endo", "x", b"x")] * 400],
    "a reference": lambda draw, p: [*p, _file("reference_t00_lv_endo", "x", draw(st.binary()))],
    "odd file name": lambda draw, p: [
        *p[:-1],
        _file("sax", draw(st.sampled_from(_NAMES)), p[-1][2]),
    ],
    "file as text": lambda draw, p: [p[0], Part('name="sax"', (), p[-1].content)],
    "empty parts": lambda draw, p: [part._replace(content=b"") for part in p],
    "huge part header": lambda draw, p: [*p, Part('name="x"', ("X: " + "y" * 100_000,), b"")],
    "many part headers": lambda draw, p: [*p, Part('name="x"', ("X: y",) * 5_000, b"")],
    "no disposition": lambda draw, p: [*p, Part("", (), b"x")],
    "request not JSON": lambda draw, p: [p[0]._replace(content=draw(st.binary())), *p[1:]],
    "charset": lambda draw, p: [
        p[0]._replace(lines=("Content-Type: text/plain; charset=x",)),
        *p[1:],
    ],
    "_charset_": lambda draw, p: [Part('name="_charset_"', (), b"utf-7"), *p],
    "transfer encoding": lambda draw, p: [
        p[0]._replace(lines=("Content-Transfer-Encoding: base64",)),
        *p[1:],
    ],
}


def _form(parts: list[Part]) -> bytes:
    pieces = []
    for part in parts:
        lines = [
            f"--{_BOUNDARY}",
            f"Content-Disposition: form-data; {part.disposition}",
            *part.lines,
        ]
        pieces += ["\r\n".join(lines).encode("utf-8") + b"\r\n\r\n", part.content, b"\r\n"]
    return b"".join([*pieces, f"--{_BOUNDARY}--\r\n".encode()])


def _body_fault(draw: Draw, body: bytes, content_type: str, faults: list[str]) -> tuple[bytes, str]:
    fault = draw(
        st.sampled_from(["no boundary", "other boundary", "truncated", "no end", "flipped"])
    )
    faults.append(f"form {fault}")
    match fault:
        case "no boundary":
            return body, "multipart/form-data"
        case "other boundary":
            odd = draw(st.sampled_from(["x", "", "y" * 300, '"a b"', "--", _BOUNDARY[:-1]]))
            return body, f"multipart/form-data; boundary={odd}"
        case "truncated":
            return body[: draw(st.integers(0, len(body)))], content_type
        case "no end":
            return body[: -len(_BOUNDARY) - 8], content_type
    return _flipped(draw, body), content_type
