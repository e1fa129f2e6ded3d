"""A disk that fails when it is given to: a folder seen through FUSE, which then refuses what is written.

`with failing_disk(folder) as disk:` and `disk.fail(EIO, after=3)`: the fourth write or sync, and all that follow, are
refused with EIO; with EROFS whatever would change the disk is, as after it was remounted read-only. Reading goes on.
The file system runs as a process of its own: `python -m tests.safety.failing_disk BELOW SEEN TOLD`.
"""

import ctypes
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from ctypes import CFUNCTYPE, c_char_p, c_int, c_int64, c_size_t, c_uint, c_uint64, c_void_p
from errno import EIO, EROFS
from pathlib import Path
from typing import Any

PATIENCE_S = 10.0
LIBRARY = "libfuse3.so.3"
FD_AT = 16  # bytes into `fuse_file_info`, in all of libfuse 3
ACCESS = os.O_WRONLY | os.O_RDWR

# in the order of `fuse_operations`; those that are left out are not there
PATH, BUFFER, INFO = c_char_p, c_void_p, c_void_p
OPERATIONS: tuple[tuple[str, tuple[Any, ...]], ...] = (
    ("getattr", (PATH, BUFFER, INFO)),
    ("readlink", ()),
    ("mknod", ()),
    ("mkdir", (PATH, c_uint)),
    ("unlink", (PATH,)),
    ("rmdir", (PATH,)),
    ("symlink", ()),
    ("rename", (PATH, PATH, c_uint)),
    ("link", ()),
    ("chmod", (PATH, c_uint, INFO)),
    ("chown", ()),
    ("truncate", (PATH, c_int64, INFO)),
    ("open", (PATH, INFO)),
    ("read", (PATH, BUFFER, c_size_t, c_int64, INFO)),
    ("write", (PATH, BUFFER, c_size_t, c_int64, INFO)),
    ("statfs", (PATH, BUFFER)),
    ("flush", ()),
    ("release", (PATH, INFO)),
    ("fsync", (PATH, c_int, INFO)),
    ("setxattr", ()),
    ("getxattr", ()),
    ("listxattr", ()),
    ("removexattr", ()),
    ("opendir", ()),
    ("readdir", (PATH, BUFFER, c_void_p, c_int64, INFO, c_uint)),
    ("releasedir", ()),
    ("fsyncdir", (PATH, c_int, INFO)),
    ("init", ()),
    ("destroy", ()),
    ("access", ()),
    ("create", (PATH, c_uint, INFO)),
    ("lock", ()),
    ("utimens", (PATH, BUFFER, INFO)),
)
FILLER = CFUNCTYPE(c_int, c_void_p, c_char_p, c_void_p, c_int64, c_uint)


class _Below:
    """Passes each operation on to the folder below, unless it is given to refuse it."""

    def __init__(self, folder: Path, reported: Path) -> None:
        self._folder, self._reported = folder, reported
        self._received, self._writes = "", 0  # what was reported, and the writes since
        self._libc = ctypes.CDLL(None, use_errno=True)
        for name in ("pread", "pwrite"):
            getattr(self._libc, name).argtypes = [c_int, c_void_p, c_size_t, c_int64]
            getattr(self._libc, name).restype = ctypes.c_ssize_t

    def _path(self, path: bytes) -> Path:
        return self._folder / os.fsdecode(path).lstrip("/")

    def _named(self, path: bytes) -> c_char_p:
        return c_char_p(os.fsencode(self._path(path)))

    def _refuse(self, *, is_content: bool) -> None:
        """Raise what was reported, once so many writes were let through."""
        try:
            reported = self._reported.read_text()
        except FileNotFoundError:
            return
        if reported != self._received:
            self._received, self._writes = reported, 0
        number, after, _ = map(int, reported.split())
        if is_content or number == EROFS:
            self._writes += 1
            if self._writes > after:
                raise OSError(number, os.strerror(number))

    def _done(self, result: int) -> int:
        return result if result >= 0 else -ctypes.get_errno()

    def getattr(self, path: bytes, found: int, _info: int) -> int:
        return self._done(self._libc.lstat(self._named(path), c_void_p(found)))

    def statfs(self, path: bytes, found: int) -> int:
        return self._done(self._libc.statvfs(self._named(path), c_void_p(found)))

    def utimens(self, path: bytes, times: int, _info: int) -> int:
        self._refuse(is_content=False)
        at_cwd = -100
        return self._done(self._libc.utimensat(at_cwd, self._named(path), c_void_p(times), 0))

    def mkdir(self, path: bytes, mode: int) -> None:
        self._refuse(is_content=False)
        self._path(path).mkdir(mode)

    def unlink(self, path: bytes) -> None:
        self._refuse(is_content=False)
        self._path(path).unlink()

    def rmdir(self, path: bytes) -> None:
        self._refuse(is_content=False)
        self._path(path).rmdir()

    def rename(self, old: bytes, new: bytes, _flags: int) -> None:
        self._refuse(is_content=False)
        self._path(old).rename(self._path(new))

    def chmod(self, path: bytes, mode: int, _info: int) -> None:
        self._refuse(is_content=False)
        self._path(path).chmod(mode)

    def truncate(self, path: bytes, size: int, _info: int) -> None:
        self._refuse(is_content=True)
        os.truncate(self._path(path), size)

    def open(self, path: bytes, info: int) -> None:
        flags = c_int.from_address(info).value
        if flags & ACCESS:
            self._refuse_for_reading_only()
        self._keep(info, os.open(self._path(path), flags & ~os.O_APPEND))

    def create(self, path: bytes, mode: int, info: int) -> None:
        self._refuse(is_content=True)
        flags = c_int.from_address(info).value & ~os.O_APPEND
        self._keep(info, os.open(self._path(path), flags | os.O_CREAT, mode))

    def read(self, _path: bytes, into: int, size: int, offset: int, info: int) -> int:
        return self._done(self._libc.pread(self._kept(info), into, size, offset))

    def write(self, _path: bytes, data: int, size: int, offset: int, info: int) -> int:
        self._refuse(is_content=True)
        return self._done(self._libc.pwrite(self._kept(info), data, size, offset))

    def release(self, _path: bytes, info: int) -> None:
        os.close(self._kept(info))

    def fsync(self, _path: bytes, _only_data: int, info: int) -> None:
        self._refuse(is_content=True)
        os.fsync(self._kept(info))

    def fsyncdir(self, _path: bytes, _only_data: int, _info: int) -> None:
        self._refuse(is_content=True)

    def readdir(self, path: bytes, into: int, filler: int, _offset: int, _info: int, _flags: int) -> None:
        fill = FILLER(filler)
        for name in (".", "..", *(one.name for one in self._path(path).iterdir())):
            fill(into, os.fsencode(name), None, 0, 0)

    def _refuse_for_reading_only(self) -> None:
        """Opening changes nothing, so it does not count; a disk that can only be read refuses it all the same."""
        before = self._writes
        self._refuse(is_content=False)
        self._writes = before

    def _keep(self, info: int, descriptor: int) -> None:
        c_uint64.from_address(info + FD_AT).value = descriptor

    def _kept(self, info: int) -> int:
        return c_uint64.from_address(info + FD_AT).value


def _answering(operation: Callable[..., int | None]) -> Callable[..., int]:
    def answer(*arguments: Any) -> int:
        try:
            return operation(*arguments) or 0
        except OSError as error:
            return -(error.errno or EIO)

    return answer


def serve(below: Path, seen: Path, reported: Path) -> int:
    """Be the file system at `seen` until it is unmounted."""
    kinds: dict[str, Any] = {
        name: CFUNCTYPE(c_int, *arguments) if arguments else c_void_p for name, arguments in OPERATIONS
    }
    table = type("Operations", (ctypes.Structure,), {"_fields_": list(kinds.items())})()
    folder = _Below(below, reported)
    for name, arguments in OPERATIONS:
        if arguments:
            setattr(table, name, kinds[name](_answering(getattr(folder, name))))
    words = [b"failing_disk", os.fsencode(seen), b"-f", b"-s", b"-o", b"default_permissions"]
    fuse = ctypes.CDLL(LIBRARY)
    return int(
        fuse.fuse_main_real(
            len(words), (c_char_p * len(words))(*words), ctypes.byref(table), c_size_t(ctypes.sizeof(table)), None
        )
    )


class FailingDisk:
    """`folder`: what is on the disk, as whoever uses it sees it."""

    def __init__(self, folder: Path, reported: Path) -> None:
        self.folder, self._reported = folder, reported

    def fail(self, number: int, after: int = 0) -> None:
        """Refuse with this error, once so many writes were let through."""
        beside = self._reported.with_suffix(".new")
        beside.write_text(f"{number} {after} {time.monotonic_ns()}")
        beside.replace(self._reported)

    def mend(self) -> None:
        self._reported.unlink(missing_ok=True)


def missing() -> str:
    """Why there can be no such disk here; empty where there can."""
    if not os.access("/dev/fuse", os.R_OK | os.W_OK):
        return "there is no /dev/fuse that may be used"
    if shutil.which("fusermount3") is None:
        return "there is no fusermount3"
    try:
        ctypes.CDLL(LIBRARY)
    except OSError:
        return f"there is no {LIBRARY}"
    return ""


@contextmanager
def failing_disk(folder: Path) -> Iterator[FailingDisk]:
    """An empty disk in `folder`, which works until it is given to fail."""
    below, seen, reported = folder / "below", folder / "seen", folder / "told"
    below.mkdir()
    seen.mkdir()
    command = [sys.executable, "-m", "tests.safety.failing_disk", *map(str, (below, seen, reported))]
    with subprocess.Popen(command, cwd=Path(__file__).parents[2]) as serving:
        try:
            give_up_s = time.monotonic() + PATIENCE_S
            while not os.path.ismount(seen):
                if serving.poll() is not None or time.monotonic() > give_up_s:
                    raise OSError(EIO, "the disk was not mounted")
                time.sleep(0.01)
            yield FailingDisk(seen, reported)
        finally:
            reported.unlink(missing_ok=True)
            subprocess.run(["fusermount3", "-u", "-z", seen], check=False)
            try:
                serving.wait(PATIENCE_S)
            except subprocess.TimeoutExpired:
                serving.kill()


if __name__ == "__main__":
    raise SystemExit(serve(*map(Path, sys.argv[1:])))
