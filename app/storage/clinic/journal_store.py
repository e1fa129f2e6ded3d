"""Where a clinic's journals are for all stations: a shared folder, or an S3 bucket, by fsspec.

A journal's name there is the SHA-256 of its bytes, so one that is there under its name is there for good: putting it
again changes nothing, two stations cannot put different ones, and what was fetched proves itself. It is encrypted under
its own key, as on a station's disk.
"""

import contextlib
import errno
import hashlib
import os
import re
import secrets
import shutil
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, BinaryIO

from app.storage.files import replacing
from app.storage.layout import SUFFIX
from app.storage.stored import LibraryError, LibraryFaultError
from app.wording.translation import tr

S3 = "s3://"
PIECE_BYTES = 1 << 20
NAME = re.compile(rf"[0-9a-f]{{64}}{re.escape(SUFFIX)}")
UNFINISHED = ".putting-"
UNFINISHED_S = 86_400.0  # after which nobody is still putting it, whatever the stations' clocks say
FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
TRIED_S = 10  # per attempt; a place that does not answer must not hold a station up for minutes


class PlaceMissingError(LibraryFaultError):
    """The shared place is not there under its name."""


class PlaceUnconfirmedError(PlaceMissingError):
    """The server names a place that nobody at this station has confirmed."""

    def __init__(self, place: str) -> None:
        what = tr("The server specifies this storage for the recordings: {place}").format(place=place)
        super().__init__(what, "Enter the storage as this computer reaches it, to confirm it")
        self.place = place


class JournalStore:
    """The journals' shared place; any thread may use it. `place` is an absolute folder, or s3://bucket/folder.

    Raises
    ------
    LibraryError
        The address cannot be used here.
    """

    def __init__(self, place: str) -> None:
        self.place = place
        try:
            import fsspec  # an extra, of clinics
        except ImportError:
            raise LibraryError(
                "The component for the clinic's shared storage is not installed", "Run: pip install .[clinic]"
            ) from None
        if not (place.startswith(S3) or Path(place).is_absolute()):
            raise LibraryError("Recordings cannot be stored at this address", "Enter a folder, or s3://bucket/folder")
        self._is_local = not place.startswith(S3)
        options: dict[str, Any] = {}
        if not self._is_local:
            # a fresh look each time, since other stations write too; few tries, since the watch tries again
            options = {
                "use_listings_cache": False,
                "config_kwargs": {"connect_timeout": TRIED_S, "read_timeout": TRIED_S, "retries": {"max_attempts": 1}},
            }
            if address := os.environ.get("AWS_ENDPOINT_URL"):
                options["endpoint_url"] = address
        try:
            # not by its address, which may name any kind of place, or one inside of another
            self._files = fsspec.filesystem("file" if self._is_local else "s3", **options)
        except (ImportError, ValueError) as error:
            raise LibraryError(
                "Recordings cannot be stored at this address", "Enter a folder, or s3://bucket/folder"
            ) from error
        self._root = str(Path(place)) if self._is_local else place.removeprefix(S3).rstrip("/")

    def refuse_missing(self) -> None:
        """Raise PlaceMissingError where the folder is not there, LibraryFaultError where it does not answer."""
        try:
            with _reported():
                # of a bucket only that it is there: a folder in it comes with its first journal
                self._files.info(self._root if self._is_local else self._root.partition("/")[0])
        except LibraryFaultError as fault:
            if not isinstance(fault.__cause__, FileNotFoundError):
                raise
            raise PlaceMissingError(
                "The place of the clinic's recordings is not there", "Connect its disk or network, or make the folder"
            ) from None

    def put(self, path: Path) -> str:
        """Put a journal there, read it back, give its name there; raises LibraryFaultError or OSError."""
        self.refuse_missing()
        name = name_in_place(path)
        at, sha256 = self._at(name), name.removesuffix(SUFFIX)
        with path.open("rb") as here, _reported():
            if self._files.exists(at) and self._sha256_there(at) == sha256:
                return name
            if self._is_local:
                self._put_beside(here, at)
            else:
                with self._files.open(at, "wb") as there:  # an object appears whole, or not at all
                    shutil.copyfileobj(here, there, PIECE_BYTES)
            if self._sha256_there(at) == sha256:
                return name
            self._files.rm_file(at)
        raise LibraryFaultError(
            "A recording copied to the clinic's shared storage does not match the original",
            "Check the disk of the shared storage",
        )

    def fetch(self, name: str, target: Path) -> None:
        """Fetch a journal, verified against its name, whole or not at all; raises LibraryFaultError, OSError."""
        digest = hashlib.sha256()
        target.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        with replacing(target, target.with_name(f".fetching-{secrets.token_hex(8)}")) as here:
            for piece in self._pieces(name):
                digest.update(piece)
                here.write(piece)
            if digest.hexdigest() + SUFFIX != name:
                raise LibraryFaultError(
                    "A recording in the clinic's shared storage is damaged", "Restore the recording there from a backup"
                )

    def destroy(self, name: str) -> None:
        """Remove a journal, though not the place's versions or snapshots; raises LibraryFaultError."""
        with _reported(), contextlib.suppress(FileNotFoundError):
            self._files.rm_file(self._at(name))

    def tidy(self, now_s: Callable[[], float] = time.time) -> None:
        """Remove what stations killed while putting a journal left there; raises LibraryFaultError."""
        if not self._is_local:
            return  # an object that was not finished has no name
        with _reported():
            for path in Path(self._root).glob(f"{UNFINISHED}*"):
                with contextlib.suppress(FileNotFoundError):
                    if now_s() - path.stat().st_mtime > UNFINISHED_S:
                        path.unlink()

    def _pieces(self, name: str) -> Iterator[bytes]:
        with _reported(), self._files.open(self._at(name), "rb") as there:
            while piece := there.read(PIECE_BYTES):
                yield piece

    def _at(self, name: str) -> str:
        if not NAME.fullmatch(name):  # a row may say anything
            raise LibraryFaultError(
                "The library refers to an invalid recording file", "Restore the library from a backup"
            )
        return f"{self._root}/{name}"

    def _put_beside(self, here: BinaryIO, target: str) -> None:
        beside = Path(self._root) / f"{UNFINISHED}{secrets.token_hex(8)}"
        with replacing(Path(target), beside, 0o660) as there:  # for the stations' group
            shutil.copyfileobj(here, there, PIECE_BYTES)

    def _sha256_there(self, at: str) -> str:
        with self._files.open(at, "rb") as there:
            return hashlib.file_digest(there, "sha256").hexdigest()


def name_in_place(path: Path) -> str:
    """Give a journal's name in the shared place, from its present bytes; raises OSError."""
    with path.open("rb") as here:
        return hashlib.file_digest(here, "sha256").hexdigest() + SUFFIX


@contextlib.contextmanager
def _reported() -> Iterator[None]:
    """Turn what a shared place raises into sentences: each kind of place has errors of its own."""
    try:
        yield
    except (LibraryError, FileNotFoundError) as error:
        if isinstance(error, FileNotFoundError):
            raise LibraryFaultError(
                "A recording is missing from the clinic's shared storage", "Restore the recording there from a backup"
            ) from error
        raise
    except PermissionError as error:
        raise LibraryFaultError(
            "This workstation has no access to the clinic's shared storage",
            "Check the folder permissions or the access keys of the shared storage",
        ) from error
    except Exception as error:
        if isinstance(error, OSError) and error.errno in FULL:
            raise LibraryFaultError(
                "The clinic's shared storage is full", "Free up disk space there; Gaitwright then retries automatically"
            ) from error
        if isinstance(error, OSError) and error.errno == errno.EROFS:
            raise LibraryFaultError(
                "The clinic's shared storage is read-only", "Check the disk of the shared storage"
            ) from error
        raise LibraryFaultError(
            "The clinic's shared storage does not respond", "Gaitwright retries automatically"
        ) from error
