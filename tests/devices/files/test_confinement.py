"""Code that runs inside of the reading process, as a damaged file might make it: what is left to it."""

import os
import socket
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from devices import own_process
from devices.files.limited_reader import LimitedReader

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the limits of Linux")

INSIDE = """
import ctypes, mmap, os, signal, socket, subprocess, sys, threading
from pathlib import Path

def tries(place, port, unix):
    old, c = place / "old", ctypes.CDLL(None, use_errno=True)
    def call(number, *arguments):
        if c.syscall(number, *arguments) < 0:
            raise OSError(ctypes.get_errno(), "refused")
    def memory_of_parent():
        return Path(f"/proc/{os.getppid()}/mem").open("rb").read(1)
    yield "tcp", lambda: socket.create_connection(("127.0.0.1", port), 2)
    yield "udp", lambda: socket.socket(type=socket.SOCK_DGRAM).sendto(b"x", ("127.0.0.1", port))
    yield "unix", lambda: socket.socket(socket.AF_UNIX).connect(unix)
    yield "abstract", lambda: socket.socket(socket.AF_UNIX).connect("\\0" + "x11")
    yield "netlink", lambda: socket.socket(socket.AF_NETLINK, socket.SOCK_RAW)
    yield "pair", lambda: socket.socketpair()
    yield "listen", lambda: socket.create_server(("127.0.0.1", 0))
    yield "program", lambda: subprocess.run(["/bin/true"])
    yield "exec", lambda: os.execv("/bin/true", ["true"])
    yield "fork", os.fork
    yield "vfork", lambda: call(58)
    yield "clone3", lambda: call(435, 0, 0)
    yield "kill", lambda: os.kill(os.getppid(), 0)
    yield "kill all", lambda: os.kill(-1, 0)
    yield "ptrace", lambda: call(101, 16, os.getppid(), 0, 0)
    yield "memory of parent", memory_of_parent
    yield "chmod", lambda: old.chmod(0o777)
    yield "chown", lambda: os.chown(old, 0, 0)
    yield "times", lambda: os.utime(old, (1, 1))
    yield "attribute", lambda: os.setxattr(old, "user.x", b"x")
    yield "write", lambda: old.write_bytes(b"x")
    yield "truncate", lambda: os.truncate(old, 0)
    yield "create", lambda: (place / "new").touch()
    yield "delete", old.unlink
    yield "rename", lambda: old.rename(place / "new")
    yield "link", lambda: os.link(old, place / "new")
    yield "device", lambda: os.mknod(place / "new")
    yield "read beside", lambda: (place / "beside").read_bytes()
    yield "list", lambda: os.listdir(place)
    yield "home", lambda: os.listdir(os.path.expanduser("~"))  # of a Path: RuntimeError where it is not known
    yield "passwords", lambda: Path("/etc/passwd").read_bytes()
    yield "priority", lambda: os.setpriority(os.PRIO_PROCESS, os.getppid(), 19)
    yield "limits of parent", lambda: __import__("resource").prlimit(os.getppid(), 7, (9, 9))
    yield "memfd", lambda: os.memfd_create("x")
    yield "perf", lambda: call(298, 0, 0, -1, -1, 0)
    yield "io_uring", lambda: call(425, 1, 0)
    yield "namespace", lambda: call(272, 0x10000000)
    yield "shared memory", lambda: call(29, 0, 4096, 0o1600)
    yield "environment", lambda: os.environ["DATABASE_OF_THE_CLINIC"]

def answer(asked, arrays):
    place = Path(asked["path"]).parent
    came = {}
    for name, act in tries(place, asked["port"], asked["unix"]):
        try:
            act()
        except (OSError, KeyError) as problem:
            came[name] = type(problem).__name__
        else:
            came[name] = "done"
    began = threading.Thread(target=came.__setitem__, args=("thread", "done"))
    began.start()
    began.join()
    came["own file"] = Path(asked["path"]).read_text()
    return {"what": "read", "details": came}

from devices.files import child, child_tasks
child_tasks._answer = answer
child.main()
"""


@pytest.fixture
def unix(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    path = f"/tmp/gaitwright-{os.getpid()}"  # a socket's path has 107 letters at most
    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind(path)
        listening.listen()
        yield path
    Path(path).unlink()


def test_what_runs_in_the_reading_process_can_open_its_own_file_and_do_nothing_else(
    tmp_path: Path, unix: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("own", "beside", "old"):
        (tmp_path / name).write_text(name)
    before = {path.name: path.stat() for path in tmp_path.iterdir()}
    monkeypatch.setenv("DATABASE_OF_THE_CLINIC", "postgresql://gait:hunter2@clinic.example/gait")
    monkeypatch.setattr(own_process, "_this_program", lambda *_: [sys.executable, "-P", "-c", INSIDE])
    reader = LimitedReader()
    with socket.create_server(("127.0.0.1", 0)) as server:
        task = {"task": "toml", "path": str(tmp_path / "own"), "port": server.getsockname()[1], "unix": unix}
        came = reader.ask(task, [tmp_path / "own"], "own", lambda details, _: dict(details), lambda: None)
    reader.close()
    assert came.pop("own file") == "own"
    assert came.pop("thread") == "done"
    assert came.pop("environment") == "KeyError"
    assert {name: how for name, how in came.items() if how == "done"} == {}
    assert len(came) > 30
    after = {path.name: path.stat() for path in tmp_path.iterdir()}
    assert {name: (one.st_mode, one.st_size, one.st_mtime_ns) for name, one in after.items()} == {
        name: (one.st_mode, one.st_size, one.st_mtime_ns) for name, one in before.items()
    }
