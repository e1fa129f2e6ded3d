"""HDF5 files of other programs: their groups, numbers and texts, with every way of being damaged reported as a refusal.

A file may point into other files (external links, storage elsewhere, virtual data). None of that is followed: what is
read has to stand in the file that somebody chose.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np

from core.samples import FloatArray
from devices.files.refusal import FileRefusedError, quoted

SIGNATURE = b"\x89HDF\r\n\x1a\n"
LIBRARY = "h5py"
INSTALL_IT = "Install gaitwright[imports]"
COPY_AGAIN = "Copy the file again from where it was recorded"
MOST_LABEL = 200  # letters of one text
# what the library raises for bytes that make no sense; memory that runs out is another matter
DAMAGES = (OSError, RuntimeError, LookupError, ValueError, TypeError, ArithmeticError, AttributeError)


class Hdf5File:
    """One file, open while its block lasts.

    Parameters
    ----------
    where
        The file's name in refusals.

    Raises
    ------
    FileRefusedError
        The library is not installed, or the file is no HDF5. All methods: what they read is damaged or is in
        another file.
    """

    def __init__(self, path: Path, where: str) -> None:
        if find_spec(LIBRARY) is None:
            raise FileRefusedError(
                where, "reading the file needs {library}, which is not installed", INSTALL_IT, library=LIBRARY
            )
        import h5py  # an extra, and slow to import

        self.where = where
        self._h5py = h5py
        with self._damage(""):
            self._file = h5py.File(path, "r")

    def __enter__(self) -> "Hdf5File":
        return self

    def __exit__(
        self, _kind: type[BaseException] | None, _error: BaseException | None, _trace: TracebackType | None
    ) -> None:
        with self._damage(""):
            self._file.close()

    def names(self, place: str = "/") -> list[str]:
        """What is in a group; nothing where there is no such group."""
        with self._damage(place):
            group = self._at(place)
            return [str(name) for name in group] if isinstance(group, self._h5py.Group) else []

    def is_group(self, place: str) -> bool:
        """Return whether there is a group of this name."""
        with self._damage(place):
            return isinstance(self._at(place), self._h5py.Group)

    def numbers(self, place: str) -> FloatArray | None:
        """The values of a dataset of numbers, in its shape; None where there is none."""
        values = self.values(place)
        if values is None:
            return None
        if values.dtype.kind not in "fiu":
            raise FileRefusedError(self.where, "{name} contains no numbers", COPY_AGAIN, name=quoted(place))
        return np.asarray(values, dtype=np.float64)

    def values(self, place: str) -> Any:
        """The values of a dataset as an array of any kind; None where there is none."""
        with self._damage(place):
            dataset = self._at(place)
            if not isinstance(dataset, self._h5py.Dataset):
                return None
            if dataset.external or dataset.is_virtual:
                raise FileRefusedError(
                    self.where, "the values of {name} are stored in another file", COPY_AGAIN, name=quoted(place)
                )
            return np.asarray(dataset[()])

    def target(self, reference: Any) -> str:
        """The place that a reference points to."""
        with self._damage("a reference"):
            return str(self._file[reference].name)

    def attribute(self, place: str, name: str) -> Any:
        """An attribute as numbers or texts; None where there is none."""
        with self._damage(place):
            holder = self._at(place)
            return None if holder is None or name not in holder.attrs else holder.attrs[name]

    def texts(self, place: str, name: str) -> list[str]:
        """The texts of an attribute, of one or several, without what fills them up; none where there are none."""
        value = self.attribute(place, name)
        with self._damage(place):
            return [] if value is None else [_text(one) for one in np.atleast_1d(value).ravel()[:1000]]

    def _at(self, place: str) -> Any:
        """The group or dataset at a place; None where there is none."""
        found: Any = self._file
        for name in filter(None, place.split("/")):
            if not isinstance(found, self._h5py.Group):
                return None
            link = found.get(name, getlink=True)
            if link is None:
                return None
            if isinstance(link, self._h5py.ExternalLink):
                raise FileRefusedError(self.where, "{name} is stored in another file", COPY_AGAIN, name=quoted(place))
            found = found.get(name)
        return found

    @contextmanager
    def _damage(self, place: str) -> Iterator[None]:
        try:
            yield
        except DAMAGES as error:
            raise FileRefusedError(
                f"{self.where}, {place}" if place.strip("/") else self.where,
                "the file cannot be read as HDF5 and may be damaged",
                COPY_AGAIN,
            ) from error


def is_hdf5(head: bytes) -> bool:
    """Whether a file that begins so is HDF5."""
    return head.startswith(SIGNATURE)


def _text(value: Any) -> str:
    text = value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)
    return text.split("\0")[0].strip()[:MOST_LABEL]
