"""The program that wrote a file, told by what stands in it, never by its name."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from devices.files.apdm import is_apdm
from devices.files.refusal import FileRefusedError
from devices.files.xsens_mtmanager import is_mtmanager

HEAD_BYTES = 65_536  # heads of many sensors are long
KNOWN: Mapping[str, Callable[[bytes], bool]] = {
    "xsens-mtmanager": is_mtmanager,
    "apdm": is_apdm,
}


def recognised(files: Sequence[Path]) -> str:
    """The format of the files of one recording.

    Raises
    ------
    FileRefusedError
        A file that none of the formats is, or files of several.
    OSError
        A file cannot be read.
    """
    found: dict[str, Path] = {}
    for path in files:
        if not path.is_file():
            raise FileRefusedError(str(path), "there is no such file", "Check its name")
        with path.open("rb") as file:
            head = file.read(HEAD_BYTES)
        names = [name for name, is_it in KNOWN.items() if is_it(head)]
        if not names:
            raise FileRefusedError(
                path.name,
                "no format that can be imported is recognised in it",
                "Those there are: {formats}; say which with --as if it is one of them",
                formats=", ".join(KNOWN),
            )
        found.setdefault(names[0], path)
    if len(found) > 1:
        (one, first), (other, second), *_ = found.items()
        raise FileRefusedError(
            second.name,
            "it is of {other}, {first} of {one}",
            "Import the files of one program at a time",
            other=other,
            first=first.name,
            one=one,
        )
    return next(iter(found))
