"""The files of a BIDS-Motion recording: which belong together, and their tables as they are."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from core.findings import Finding
from core.samples import FloatArray
from devices.files.refusal import FileRefusedError, quoted
from devices.files.tables import CutEnd, number_in
from devices.files.text_files import open_text
from devices.files.trial import ImportedSensor

MOTION, CHANNELS, SETTINGS = "_motion.tsv", "_channels.tsv", "_motion.json"
ENDINGS = (MOTION, CHANNELS, SETTINGS, "_channels.json")
SCANS = "*_scans.tsv"
MOST_SCANS = 10
REQUIRED = ("name", "type", "tracked_point", "component", "units")  # columns of a table of channels
SENSOR, RATE_KIND, CLOCK = "sensor", "rate_kind", "shared_clock"  # columns of ours
IS_SIMULATED, IS_COMMON_START = "Simulated", "LatenciesFromOneStart"  # settings of ours
MISSING = frozenset(("n/a", "nan", ""))
LONGEST_LINE = 1_000_000  # bytes
MOST_SETTINGS = 4_000_000  # bytes
MOST_CHANNELS = 10_000
LEAST_RATE_HZ, MOST_RATE_HZ = 1.0, 10_000.0
EXPORT_AGAIN = "Correct the file or export it again"


@dataclass(frozen=True, slots=True)
class MotionChannel:
    """A row of a table of channels; a column that is not there is empty."""

    type: str
    component: str
    units: str
    frame: str
    sensor: str
    rate_kind: str
    clock: str


@dataclass(slots=True)
class MotionSystem:
    """One tracking system: samples (n, channels), NaN where one is missing, and the columns of each tracked point."""

    base: Path
    rows: FloatArray
    points: dict[str, dict[tuple[str, str], int]]
    channels: list[MotionChannel]
    rate_hz: float | None
    maker: str = ""
    started: str = ""
    is_simulated: bool = False
    of_rows: tuple[Finding, ...] = ()
    is_common_start: bool = False
    sensors: list[ImportedSensor] = field(default_factory=list)


def common_base(path: Path) -> Path:
    """The file without what it holds: `sub-1_task-walk_tracksys-imu`."""
    for ending in ENDINGS:
        if path.name.endswith(ending):
            return path.with_name(path.name.removesuffix(ending))
    return path.with_name(path.stem)


def tables_beside(path: Path) -> list[Path]:
    """What is read with a file of samples, if it is there."""
    base = common_base(path)
    scans = [file for folder in folders_of_scans(path) for file in sorted(folder.glob(SCANS))[:MOST_SCANS]]
    return [*(base.with_name(base.name + ending) for ending in ENDINGS), *scans]


def folders_of_scans(path: Path) -> list[Path]:
    """Where the table of scans may be; none for a file of another format."""
    return [path.parent, path.parent.parent] if path.name.endswith(ENDINGS) else []


def _beside(base: Path, ending: str) -> Path:
    return base.with_name(base.name + ending)


def has_channels(path: Path) -> bool:
    """Whether a table of channels is beside a file."""
    channels = _beside(common_base(path), CHANNELS)
    if not channels.is_file():
        return False
    with channels.open("rb") as file:
        return is_channels(file.read(4096))


def is_channels(head: bytes) -> bool:
    """Whether a file that begins so is a table of channels."""
    names = head.removeprefix(b"\xef\xbb\xbf").split(b"\n", 1)[0].decode("utf-8", "replace").strip().split("\t")
    return set(names) >= {"name", "type", "tracked_point", "units"}


def read_system(base: Path) -> MotionSystem:
    """Read the files of one tracking system; raises FileRefusedError where one is missing or invalid."""
    channels_path, motion_path = _beside(base, CHANNELS), _beside(base, MOTION)
    for path in (channels_path, motion_path):
        if not path.is_file():
            raise FileRefusedError(
                path.name,
                "a file of the recording is missing",
                "Put the missing file in the same folder as the other files",
            )
    points, channels = _read_channels(channels_path)
    settings = _read_settings(_beside(base, SETTINGS))
    try:
        rate_hz = float(str(settings.get("SamplingFrequency", "nan")))
    except ValueError:
        rate_hz = np.nan
    maker = " ".join(str(settings.get(name, "")) for name in ("Manufacturer", "ManufacturersModelName"))
    rows, of_rows = _read_rows(motion_path, len(channels))
    return MotionSystem(
        base=base,
        rows=rows,
        points=points,
        channels=channels,
        rate_hz=rate_hz if LEAST_RATE_HZ <= rate_hz <= MOST_RATE_HZ else None,
        maker=maker.replace("n/a", "").strip()[:100],
        started=_acquired(base),
        is_simulated=settings.get(IS_SIMULATED) is True,
        of_rows=of_rows,
        is_common_start=settings.get(IS_COMMON_START) is True,
    )


def _read_channels(path: Path) -> tuple[dict[str, dict[tuple[str, str], int]], list[MotionChannel]]:
    points: dict[str, dict[tuple[str, str], int]] = {}
    channels: list[MotionChannel] = []
    names: list[str] = []
    for number, text in _lines(path):
        cells = [cell.strip() for cell in text.split("\t")]
        here = f"{path.name}, line {number}"
        if not names:
            names = cells
            missing = [name for name in REQUIRED if name not in names]
            if missing:
                raise FileRefusedError(here, "column {name} is missing", EXPORT_AGAIN, name=missing[0])
            continue
        if not text.strip():
            continue
        if len(cells) != len(names):
            raise FileRefusedError(
                here,
                "the line has {count} cells, but the header has {width}",
                EXPORT_AGAIN,
                count=len(cells),
                width=len(names),
            )
        row = {name: "" if cell == "n/a" else cell for name, cell in zip(names, cells, strict=True)}
        one = MotionChannel(
            type=row["type"].upper(),
            component=row["component"].lower(),
            units=row["units"],
            frame=row.get("reference_frame", ""),
            sensor=row.get(SENSOR, ""),
            rate_kind=row.get(RATE_KIND, ""),
            clock=row.get(CLOCK, ""),
        )
        of_point = points.setdefault(row["tracked_point"], {})
        if (one.type, one.component) in of_point:
            raise FileRefusedError(
                here,
                "{point} has two {type} {component} channels",
                EXPORT_AGAIN,
                point=quoted(row["tracked_point"]),
                type=quoted(one.type),
                component=quoted(one.component),
            )
        of_point[one.type, one.component] = len(channels)
        channels.append(one)
        if len(channels) > MOST_CHANNELS:
            raise FileRefusedError(here, "there are more than {most} channels", EXPORT_AGAIN, most=MOST_CHANNELS)
    return points, channels


def _read_settings(path: Path) -> Mapping[str, object]:
    if not path.is_file():
        return {}
    with path.open("rb") as file:
        content = file.read(MOST_SETTINGS)
    try:
        settings = json.loads(content)
    except (ValueError, RecursionError) as error:
        raise FileRefusedError(path.name, "the file is not readable JSON", EXPORT_AGAIN) from error
    if not isinstance(settings, dict):
        raise FileRefusedError(path.name, "the file is not a table of settings", EXPORT_AGAIN)
    return settings


def _read_rows(path: Path, width: int) -> tuple[FloatArray, tuple[Finding, ...]]:
    """(n, width) samples, and what was left out."""
    rows: list[FloatArray] = []
    cut = CutEnd()
    for number, text in _lines(path):
        if not text.strip():
            continue
        cells = text.split("\t")
        here = f"{path.name}, line {number}"
        if len(cells) != width:
            refusal = FileRefusedError(
                here,
                "the line has {count} cells, but the channel table has {width} channels",
                EXPORT_AGAIN,
                count=len(cells),
                width=width,
            )
            if len(cells) > width or not rows:
                raise refusal
            cut.note_cut(refusal)
            continue
        cut.note_whole()
        try:
            rows.append(np.array([np.nan if cell.strip().lower() in MISSING else number_in(cell) for cell in cells]))
        except ValueError as error:
            if number == 1:
                raise FileRefusedError(
                    here,
                    "a value is not a number ({why})",
                    "Remove the header line: BIDS has none in this file",
                    why=quoted(error),
                ) from error
            raise FileRefusedError(here, "a value is not a number ({why})", EXPORT_AGAIN, why=quoted(error)) from error
    values = np.array(rows, dtype=np.float64).reshape(len(rows), width)
    values[~np.isfinite(values)] = np.nan
    return values, cut.findings(path)


def _lines(path: Path) -> Iterator[tuple[int, str]]:
    """Number and text of each line, without its end."""
    with open_text(path) as file:
        for number, raw in enumerate(iter(lambda: file.readline(LONGEST_LINE), b""), 1):
            try:
                yield number, raw.decode("utf-8-sig" if number == 1 else "utf-8").rstrip("\r\n")
            except UnicodeDecodeError as error:
                raise FileRefusedError(
                    f"{path.name}, line {number}", "the file is not UTF-8 text", EXPORT_AGAIN
                ) from error


def _acquired(base: Path) -> str:
    """When the recording started, as the table of scans states it; empty where none does."""
    for folder in (base.parent, base.parent.parent):
        for scans in sorted(folder.glob(SCANS))[:MOST_SCANS]:
            names: list[str] = []
            for _, text in _lines(scans):
                cells = text.split("\t")
                if not names:
                    names = cells
                elif {"filename", "acq_time"} <= set(names) and len(cells) == len(names):
                    row = dict(zip(names, cells, strict=True))
                    if Path(row["filename"]).name == f"{base.name}{MOTION}":
                        return "" if row["acq_time"] in MISSING else row["acq_time"]
    return ""
