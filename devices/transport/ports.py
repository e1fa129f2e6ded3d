"""Serial ports: which there are, and why one does not open. The only file that knows the serial library."""

import errno
import os
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from serial import Serial
from serial.tools import list_ports as listing

from devices.live import SourceLostError, SourceRefusedError
from devices.transport.channels import MOST_BYTES, READ_S

if sys.platform != "win32":
    import grp

MORE_PORTS = "GAITWRIGHT_PORTS"  # further ports, such as emulators', by their paths
# names of Bluetooth ports that are worth the seconds they take: bound by hand on Linux, made by pairing on macOS
SENSORS_RADIO = ("rfcomm", "Shimmer3")
LOOK_S = 0.5  # a port that is gone is missed so soon, whatever its driver reports


@dataclass(frozen=True, slots=True)
class PortInfo:
    """A port and what is plugged in there. `usb` vendor and product; None: it is no USB device."""

    device: str
    description: str = ""
    serial: str = ""
    usb: tuple[int, int] | None = None
    is_named: bool = False
    """Somebody named it, so that it is looked at whatever it is."""

    @property
    def key(self) -> str:
        """What is plugged in, whichever port it is at; the port where that is not known."""
        return f"{self.usb[0]:04x}:{self.usb[1]:04x} {self.serial}" if self.serial and self.usb else self.device

    @property
    def is_likely(self) -> bool:
        """Whether a sensor may be there: most other ports of a machine are empty, or another's and slow to open."""
        return bool(self.usb or self.is_named or any(name in self.device for name in SENSORS_RADIO))

    def is_same(self, other: "PortInfo") -> bool:
        """Whether the same thing is plugged in, at whichever port it is now."""
        if self.serial and self.usb:
            return (self.serial, self.usb) == (other.serial, other.usb)
        return self.device == other.device


def list_ports() -> tuple[PortInfo, ...]:
    """Every serial port of this machine, those with something plugged in first."""
    found = [
        PortInfo(
            device=port.device,
            description=port.description if port.description not in (None, "n/a") else "",
            serial=port.serial_number or "",
            usb=(port.vid, port.pid) if port.vid is not None and port.pid is not None else None,
        )
        for port in listing.comports()
    ]
    named = [path for path in os.environ.get(MORE_PORTS, "").split(os.pathsep) if path]
    there = [path for path in named if os.name == "nt" or Path(path).exists()]  # COM7 is no file
    found += [PortInfo(path, "named by " + MORE_PORTS, is_named=True) for path in there]
    return tuple(sorted(found, key=lambda port: (port.usb is None and not port.is_named, port.device)))


class SerialPort:
    """A serial port; found again by what is plugged in, if its name has changed."""

    def __init__(
        self, port: PortInfo, baud: int = 115200, list_all: Callable[[], Sequence[PortInfo]] = list_ports
    ) -> None:
        self._port, self.baud, self._list_all = port, baud, list_all
        self._opened: Serial | None = None
        self._looked_s = 0.0

    @property
    def place(self) -> str:
        return self._port.device

    @property
    def serial(self) -> str:
        return self._port.serial

    def open(self) -> None:
        self._find()
        exclusive = True if os.name == "posix" else None  # elsewhere a port always is
        try:
            self._opened = Serial(self._port.device, self.baud, timeout=READ_S, write_timeout=0.5, exclusive=exclusive)
        except (OSError, ValueError) as problem:  # the library's own error is an OSError
            raise _refusal(self._port.device, problem) from problem

    def read(self) -> bytes:
        port = self._held()
        try:
            data: bytes = port.read(MOST_BYTES)
        except (OSError, TypeError) as problem:  # TypeError: it was closed meanwhile
            raise SourceLostError(f"{self.place} was lost") from problem
        if not data and time.monotonic() - self._looked_s > LOOK_S:
            self._looked_s = time.monotonic()
            if os.name == "posix" and not Path(self._port.device).exists():
                raise SourceLostError(f"{self.place} was pulled out")
        return data

    def write(self, data: bytes) -> None:
        try:
            self._held().write(data)
        except (OSError, TypeError) as problem:
            raise SourceLostError(f"{self.place} was lost") from problem

    def close(self) -> None:
        opened, self._opened = self._opened, None
        if opened is not None:
            with suppress(OSError):
                opened.close()

    def _held(self) -> Serial:
        if self._opened is None:
            raise SourceLostError(f"{self.place} is closed")
        return self._opened

    def _find(self) -> None:
        if self._port.serial and self._port.usb:
            self._port = next((port for port in self._list_all() if self._port.is_same(port)), self._port)


def _refusal(device: str, problem: Exception) -> SourceRefusedError:
    """Say why a port does not open, and what to do."""
    number = problem.errno if isinstance(problem, OSError) else None
    text = str(problem)
    if number == errno.ENOENT or "FileNotFoundError" in text or "No such file" in text:
        return SourceRefusedError("{place} was not found", "Plug in the sensor and switch it on", place=device)
    if number == errno.EACCES and sys.platform.startswith("linux"):
        return SourceRefusedError(
            "Only members of the group {group} may use {place}",
            "Ask the administrator to run: sudo usermod -aG {group} $USER; then log in again",
            place=device,
            group=_group(device),
        )
    if number in (errno.EBUSY, errno.EAGAIN, errno.EACCES) or "lock" in text or "PermissionError" in text:
        return SourceRefusedError(
            "{place} is in use by another program", "Close that program, then search again", place=device
        )
    return SourceRefusedError(
        "{place} could not be opened", "Plug in the sensor again, then search again", place=device
    )


def _group(device: str) -> str:
    if sys.platform == "win32":
        return ""
    try:
        return grp.getgrgid(Path(device).stat().st_gid).gr_name
    except (OSError, KeyError):
        return "dialout"
