"""What the files of another program hold of one trial, before anybody has stated which sensor was worn where."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from core.findings import Finding
from core.samples import ImuBlock, SensorInfo
from devices.files.refusal import FileRefusedError

T = TypeVar("T")

SESSION = "session"  # in place of a format: a session folder
CSV = "csv"  # of `PROGRAMS`: tables of no particular program
BESIDE_INERTIAL = "Quaternion.csv"  # of the x-IMU3's converter, with the orientation
OF_XIMU, REGISTERS = ("_CalInertialAndMag", "_CalInertialMagnetic"), "_Registers.csv"  # of the first x-IMU
SIMULATED_MARK = "SIMULATED.txt"  # beside tables that belong to no session folder, which would say it
PROGRAMS: Mapping[str, str] = {  # what writes each of `formats.FORMATS`, whose import takes longer than most files
    "xsens-mtmanager": "Xsens MT Manager",
    "movella-dot": "the Movella DOT app",
    "xsens-mti": "an Xsens MTi, as the bytes it sent",
    "ximu3": "x-IMU3, as bytes or converted to CSV",
    "ximu": "x-IMU, converted to CSV",
    "shimmer": "Shimmer, its card or Consensys",
    "mvnx": "Xsens MVN (MVNX)",
    "apdm": "APDM Moveo, Mobility Lab or Motion Studio",
    "opensim": "OpenSim (orientations)",
    "bids-motion": "BIDS-Motion",
    "xdf": "LabRecorder, as XDF",
    "matlab": "any program, as a MATLAB file with named variables",
    "parquet": "any program, as Parquet with named columns",
    "csv": "any program, as CSV with named columns",
}

PROOFS: Mapping[str, str] = {  # what the reader of each was held against
    "xsens-mtmanager": "Real exports of wired and wireless sensors, with every delimiter.",
    "movella-dot": "Excerpts of public files of the app, its export and the SDK. No Excel file and no delta quantities "
    "were at hand.",
    "xsens-mti": "Recorded streams in four number formats, to the last digit of another program's reading.",
    "ximu3": "The maker's own decoder, to the last digit; for the folder of CSV its heads in public programs. No real "
    "file was at hand.",
    "ximu": "Public files of the maker's own library: packet numbers, units and the register of the rate.",
    "shimmer": "One real recording of a card and Consensys's CSV of it, equal to the last digits; the clock of a "
    "synchronised one to 0.02 ms. No synchronised recording with motion was at hand.",
    "mvnx": "The MVN manual. No real file was at hand.",
    "apdm": "Real CSV exports of both dialects; for HDF5 the published layout. No real HDF5 file was at hand.",
    "opensim": "OpenSim's documentation. No real file was at hand.",
    "bids-motion": "Its specification, a public table of channels, and our own exports, in which its validator finds "
    "no error. No samples of another program's set were at hand.",
    "xdf": "Files laid out by the format's description, also of the simulated walker. No recording of LabRecorder was "
    "at hand.",
    "matlab": "Small files that MATLAB wrote, without sensors, and files laid out as these are. No recording was at "
    "hand.",
    "parquet": "Files with columns of many names and units, made for it.",
    "csv": "Files with columns of many names and units, and in the published layouts of sixteen programs, made for it.",
}


@dataclass(frozen=True, slots=True)
class ClockRestart:
    """A clock that began again: its times go on one step after it left off, and nobody knows how long it was.

    `at`: how many samples are before it. `shift_s`: what was added to the times after it. `refusal`: of a
    recording that is not split there.
    """

    at: int
    shift_s: float
    refusal: FileRefusedError


@dataclass(frozen=True, slots=True)
class ImportedSensor:
    """One sensor and its samples: SI units, sensor axes; seconds on the clock that all sensors of the trial share.

    `name`: as the program calls it, else its file. `ids`: by what else it may be called. `file`: the path it is from.
    `findings`: without a place, which is not known yet.
    """

    name: str
    ids: tuple[str, ...]
    file: str
    block: ImuBlock
    info: SensorInfo
    findings: tuple[Finding, ...] = ()
    restarts: tuple[ClockRestart, ...] = ()

    def __post_init__(self) -> None:
        if not all(0 < one.at < len(self.block) for one in self.restarts):
            raise ValueError(f"a clock restarts outside of the {len(self.block)} samples of {self.name}")


@dataclass(frozen=True, slots=True)
class UnreadFile:
    """A file beside the others that could not be read, the ids of what it may hold, and why."""

    file: str
    ids: tuple[str, ...]
    refusal: FileRefusedError


@dataclass(frozen=True, slots=True)
class ImportedTrial:
    """`format`: one of `formats.FORMATS`. `started`: as the file gives it, empty where it does not.

    `is_simulated`: the files, or the session that they are a part of, say that nobody was measured. `mapped`: the
    names that a mapping file gives to sensors.
    """

    format: str
    sensors: tuple[ImportedSensor, ...]
    unread: tuple[UnreadFile, ...] = ()
    started: str = ""
    is_simulated: bool = False
    mapped: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class FilesOfTrial:
    """`name`: what the files have in common, to call the trial by. `is_one_sensor`: each file holds one."""

    format: str
    name: str
    files: tuple[str, ...]
    is_one_sensor: bool = False


@dataclass(frozen=True, slots=True)
class Gathered:
    """`refused`: what is none of the formats, and why. `tables`: those of them that are tables all the same."""

    trials: tuple[FilesOfTrial, ...]
    refused: tuple[FileRefusedError, ...]
    tables: tuple[str, ...] = ()


def plain_id(sensor: str) -> str:
    """A sensor's id as it is compared: "_00B42268" is 00B42268."""
    return sensor.strip().lstrip("_").upper()


def registers_beside(path: Path) -> list[Path]:
    """Where the registers of an x-IMU are beside its samples; none for a file of another name."""
    return [path.with_name(path.stem.removesuffix(end) + REGISTERS) for end in OF_XIMU if path.stem.endswith(end)]


def read_each(
    files: Sequence[Path], read: Callable[[Path], T], ids: Callable[[Path], Sequence[str]] = lambda _path: ()
) -> tuple[list[T], list[UnreadFile]]:
    """Give what was read of each file, and the refused ones; raises FileRefusedError where all are refused."""
    found: list[T] = []
    unread: list[UnreadFile] = []
    for path in files:
        try:
            found.append(read(path))
        except FileRefusedError as refusal:
            unread.append(UnreadFile(str(path), tuple(ids(path)), refusal))
    if unread and not found:
        raise unread[0].refusal
    return found, unread
