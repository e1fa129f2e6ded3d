"""The variables of a MATLAB file of version 5 to 7.3 as plain values, without those that only MATLAB can open.

Versions 5 to 7 are read by SciPy, version 7.3 is HDF5 with MATLAB's own attributes.
"""

import io
import struct
import warnings
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import loadmat
from scipy.io.matlab import MatlabFunction, MatlabOpaque, MatReadError

from core.samples import FloatArray
from devices.files.hdf5 import SIGNATURE, Hdf5File
from devices.files.matlab_elements import check_elements
from devices.files.refusal import FileRefusedError

VERSION_PLACE = slice(124, 128)
VERSIONS_5, VERSIONS_7_3 = (b"\x00\x01IM", b"\x01\x00MI"), (b"\x00\x02IM", b"\x02\x00MI")  # of both orders of bytes
HDF5_AT = 512
MOST_DEPTH = 12  # of structures in structures, and of references that lead in a circle
MOST_VALUES = 100_000
CLASS, EMPTY, OBJECT = "MATLAB_class", "MATLAB_empty", "MATLAB_object_decode"
OWN = "#"  # names that MATLAB keeps to itself in HDF5
SAVE_AGAIN = "Save the file again in MATLAB, with save and the option -v7"
DAMAGES = (
    ValueError,
    TypeError,
    LookupError,
    OSError,
    EOFError,
    ArithmeticError,
    AttributeError,
    AssertionError,
    RuntimeError,
    NameError,  # SciPy's, of a value that it did not come to set
    struct.error,
    zlib.error,
)


@dataclass(frozen=True, slots=True)
class ClosedObject:
    """A variable of a class, such as a table, whose content only MATLAB can open."""

    class_name: str


# numbers of two axes, a text, a cell or an array of structures, a structure; None: of no use here (complex, sparse)
Variable = FloatArray | str | list[Any] | dict[str, Any] | ClosedObject | None


def is_matlab(_path: Path, head: bytes) -> bool:
    """Whether a file that begins so is a MATLAB file of version 5 or later."""
    version = head[VERSION_PLACE]
    return version in VERSIONS_5 or (version in VERSIONS_7_3 and head[HDF5_AT:].startswith(SIGNATURE))


def read_matlab(path: Path) -> dict[str, Variable]:
    """Read all variables by name; FileRefusedError if damaged, of other version, or without 7.3 library."""
    with path.open("rb") as file:
        head = file.read(HDF5_AT + len(SIGNATURE))
    if not is_matlab(path, head):
        raise FileRefusedError(path.name, "the file is not a MATLAB file of version 5 or later", SAVE_AGAIN)
    if head[VERSION_PLACE] in VERSIONS_5:
        return _Version5(path).variables()
    with Hdf5File(path, path.name) as opened:
        return _Version73(opened).variables()


class _MatlabFile:
    """One file being read, with a limit to what its structures may hold."""

    def __init__(self, where: str) -> None:
        self._where = where
        self._values = 0

    def _count(self, depth: int) -> None:
        self._values += 1
        if depth > MOST_DEPTH or self._values > MOST_VALUES:
            raise FileRefusedError(
                self._where,
                "the data in the file are nested too deeply or are too large for a recording",
                "Save only the sensor variables",
            )


class _Version5(_MatlabFile):
    def __init__(self, path: Path) -> None:
        super().__init__(path.name)
        self._path = path

    def variables(self) -> dict[str, Variable]:
        try:
            content = self._path.read_bytes()
            check_elements(content)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # of names that are there twice, and of times before 1980
                read = loadmat(io.BytesIO(content))  # type: ignore[arg-type]  # its stubs know paths only
            variables = {}
            for name, value in read.items():
                if not name.startswith("__"):
                    # what SciPy calls objects of classes in some versions
                    called = (_field(value, 0) or "?") if name == "None" else name
                    variables[called] = self._plain(value, 0)
            return variables
        except (*DAMAGES, MatReadError) as error:
            raise FileRefusedError(
                self._where, "the file cannot be read as a MATLAB file and may be damaged", SAVE_AGAIN
            ) from error

    def _plain(self, value: Any, depth: int) -> Variable:
        self._count(depth)
        if isinstance(value, MatlabOpaque):
            return ClosedObject(_field(value, 2))
        if isinstance(value, MatlabFunction) or not isinstance(value, np.ndarray):
            return None
        if value.dtype.names:
            structures = [
                {name: self._plain(one[name], depth + 1) for name in value.dtype.names} for one in value.ravel("F")
            ]
            return structures[0] if len(structures) == 1 else structures
        if value.dtype.kind == "O":
            return [self._plain(one, depth + 1) for one in value.ravel("F")]
        if value.dtype.kind in "US":
            texts = [str(one).strip() for one in value.ravel()]
            return texts[0] if len(texts) == 1 else texts or ""
        return _numbers(value)


class _Version73(_MatlabFile):
    def __init__(self, file: Hdf5File) -> None:
        super().__init__(file.where)
        self._file = file

    def variables(self) -> dict[str, Variable]:
        return {name: self._at(f"/{name}", 0) for name in self._file.names() if not name.startswith(OWN)}

    def _at(self, place: str, depth: int) -> Variable:
        self._count(depth)
        class_name = next(iter(self._file.texts(place, CLASS)), "")
        if self._file.attribute(place, OBJECT) is not None and class_name not in ("char", "logical"):
            return ClosedObject(class_name)
        if self._file.is_group(place):
            return self._structure(place, depth)
        values = self._file.values(place)
        if values is None:
            return None
        if self._file.attribute(place, EMPTY) is not None:
            return "" if class_name == "char" else []
        if values.dtype.kind == "O":  # references, of a cell
            return self._targets(values, depth)
        if class_name == "char":
            rows = np.atleast_2d(values.T)
            texts = ["".join(chr(code) for code in row if 0 < code < 0xD800).strip() for row in rows.astype(int)]
            return texts[0] if len(texts) == 1 else [*texts]
        return _numbers(values.T)

    def _structure(self, place: str, depth: int) -> Variable:
        """A structure; where its fields are references and no cells, an array of structures."""
        names = self._file.names(place)
        fields: dict[str, Variable] = {}
        of_array: dict[str, list[Any]] = {}
        for name in names:
            inner = f"{place}/{name}"
            if self._file.is_group(inner) or self._file.attribute(inner, CLASS) is not None:
                fields[name] = self._at(inner, depth + 1)
                continue
            values = self._file.values(inner)
            if values is not None and values.dtype.kind == "O":
                of_array[name] = self._targets(values, depth)
            else:
                fields[name] = self._at(inner, depth + 1)
        if not of_array:
            return fields
        many = min(map(len, of_array.values()))
        return [{name: values[k] for name, values in of_array.items()} for k in range(many)]

    def _targets(self, references: Any, depth: int) -> list[Any]:
        found = []
        for reference in np.asarray(references).ravel():
            self._count(depth)
            found.append(self._at(self._file.target(reference), depth + 1))
        return found


def _numbers(values: Any) -> FloatArray | None:
    """Real numbers of at most two axes, as (n, m)."""
    if not isinstance(values, np.ndarray) or values.dtype.kind not in "fiub" or values.ndim > 2:
        return None
    return np.atleast_2d(values).astype(np.float64)


def _field(value: Any, number: int) -> str:
    """A text of SciPy's record of an object: its name, the system of its type, its class."""
    names = value.dtype.names or ()
    one = value.ravel()[0][names[number]] if len(names) > number and value.size else b""
    return one.decode("utf-8", "replace") if isinstance(one, bytes) else str(one)
