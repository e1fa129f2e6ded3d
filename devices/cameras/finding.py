"""Find the cameras of this computer."""

import contextlib
import json
import os
import struct
import sys
import threading
from importlib.util import find_spec
from pathlib import Path

from devices.cameras import child
from devices.cameras.camera import AVFOUNDATION, DSHOW, V4L2, CameraInfo, CameraLostError
from devices.cameras.causes import missing_library
from devices.cameras.messages import CAMERAS, BrokenMessageError, details_of, receive
from devices.own_process import end_process, start_process

if sys.platform != "win32":
    import fcntl

SYSTEM, DEVICES = Path("/sys/class/video4linux"), Path("/dev")
# videodev2.h: VIDIOC_QUERYCAP, and in its answer what this device can; driver, card and bus stand before it
QUERY, ANSWER_BYTES, CAN_AT = 0x80685600, 104, 88
TAKES_PICTURES = 0x00000001 | 0x00001000
PLATFORM: str = sys.platform
LISTS = {"win32": DSHOW, "darwin": AVFOUNDATION}
LISTS_S = 10.0  # Windows asks the driver of each camera


def why_no_cameras() -> CameraLostError | None:
    """Why no camera can be found, with what to do; None where they can be looked for."""
    return None if find_spec("av") is not None else missing_library()


def find_cameras() -> tuple[CameraInfo, ...]:
    """The cameras that are connected now; none where the library that opens them is missing."""
    if why_no_cameras() is not None:
        return ()
    return cameras_in(SYSTEM, DEVICES) if PLATFORM == "linux" else _listed(LISTS.get(PLATFORM, AVFOUNDATION))


def cameras_in(system: Path, devices: Path) -> tuple[CameraInfo, ...]:
    """The cameras of Linux. Each has several devices, of which one takes pictures."""
    found = []
    for folder in sorted(system.glob("video*"), key=_number):
        device = devices / folder.name
        if device.exists() and _takes_pictures(device, folder):
            found.append(CameraInfo(_first_line(folder / "name") or folder.name, str(device), V4L2))
    return tuple(found)


def _number(folder: Path) -> int:
    digits = folder.name.removeprefix("video")
    return int(digits) if digits.isascii() and digits.isdecimal() else 0


def _takes_pictures(device: Path, folder: Path) -> bool:
    """Ask the device; of one that may not be opened, the first of its camera is taken for it."""
    try:
        opened = os.open(device, os.O_RDONLY | os.O_NONBLOCK)
    except OSError:
        return _first_line(folder / "index") in ("0", "")
    try:
        answer = fcntl.ioctl(opened, QUERY, bytes(ANSWER_BYTES))
    except OSError:
        return False
    finally:
        os.close(opened)
    (can,) = struct.unpack_from("<I", answer, CAN_AT)
    return bool(can & TAKES_PICTURES)


def _first_line(file: Path) -> str:
    with contextlib.suppress(OSError):
        return " ".join(file.read_text(encoding="utf-8", errors="replace").split())
    return ""


def _listed(format_name: str) -> tuple[CameraInfo, ...]:
    """The system's own list, asked by a process of its own: drivers of cameras answer it."""
    process = start_process(child.__name__, child.WORD, json.dumps({child.LIST: format_name}))
    late = threading.Timer(LISTS_S, process.kill)
    late.start()
    try:
        assert process.stdout is not None  # it was started with it
        kind, content = receive(process.stdout)
        return tuple(CameraInfo(**one) for one in details_of(content)) if kind == CAMERAS else ()
    except (EOFError, OSError, BrokenMessageError, TypeError):
        return ()
    finally:
        late.cancel()
        end_process(process)
