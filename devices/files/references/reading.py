"""The kinds of reference files, each recognised by what is in it, never by its name."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from devices.files.references.c3d_angles import is_c3d, read_c3d
from devices.files.references.opensim_angles import is_opensim, read_opensim
from devices.files.references.plain_csv import is_csv, read_plain_csv
from devices.files.references.trial import ReferenceFile
from devices.files.references.visual3d import is_visual3d, read_visual3d
from devices.files.refusal import FileRefusedError
from devices.files.text_files import as_utf8

HEAD_BYTES = 65_536


@dataclass(frozen=True, slots=True)
class ReferenceFormat:
    """`is_it`: whether a file, whose first bytes are given, is of this format. `read`: what it holds."""

    is_it: Callable[[Path, bytes], bool]
    read: Callable[[Path], ReferenceFile]


READERS: Mapping[str, ReferenceFormat] = {
    "c3d": ReferenceFormat(is_c3d, read_c3d),
    "opensim": ReferenceFormat(is_opensim, read_opensim),
    "csv": ReferenceFormat(is_csv, read_plain_csv),
    "visual3d": ReferenceFormat(is_visual3d, read_visual3d),
}
MARKERS = "markers"
SOURCES = ("angles", MARKERS, "events", "strides")


def read_reference(path: Path) -> ReferenceFile:
    """Read one reference file of any format; raises FileRefusedError for none, OSError where unreadable."""
    if path.is_dir():
        raise FileRefusedError(path.name, "this is a folder", "Give the reference file")
    if not path.exists():
        raise FileRefusedError(str(path), "this file does not exist", "Check the file's name")
    with path.open("rb") as file:
        head = as_utf8(file.read(HEAD_BYTES))
    for one in READERS.values():
        if one.is_it(path, head):
            return one.read(path)
    raise FileRefusedError(
        path.name,
        "the file is not a recognised reference file",
        "Give a CSV file with time_s and left_knee, left_ankle, right_knee or right_ankle in degrees, "
        "an OpenSim .mot, a C3D, or a Visual3D text export",
    )
