"""ParaView's PVD: which file shows a surface at which time."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from xml.sax.saxutils import quoteattr


def write_pvd(
    path: Path, parts: Sequence[tuple[float, str]], unit: str, facts: Mapping[str, str]
) -> None:
    """A collection of files beside it.

    parts: of each instant its time and the file's name. unit: of the times. facts: what else the
    file says of itself, in a comment; no value may hold two hyphens in a row.
    """
    said = " ".join(f"{key}={value}" for key, value in {**facts, "timestep_unit": unit}.items())
    lines = [
        '<?xml version="1.0"?>',
        f"<!-- neuralmri {said} -->",
        '<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">',
        "  <Collection>",
        *(
            f'    <DataSet timestep="{time:.9g}" group="" part="0" file={quoteattr(name)}/>'
            for time, name in parts
        ),
        "  </Collection>",
        "</VTKFile>",
    ]
    path.write_text("\n".join(lines) + "\n", encoding="ascii", newline="\n")
