"""One sensor's file read to a block of samples, and written from one."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from core.body import Site
from core.findings import Finding, Severity
from core.samples import BoolArray, FloatArray, ImuBlock
from devices.files.refusal import FileRefusedError, plain
from devices.files.table_header import CORRECT_IT
from devices.files.tables import Table, read_csv, read_parquet

TIME = "time_s"
ACC = ("acc_x_m_s2", "acc_y_m_s2", "acc_z_m_s2")
GYR = ("gyr_x_rad_s", "gyr_y_rad_s", "gyr_z_rad_s")
QUAT = ("quat_w", "quat_x", "quat_y", "quat_z")
MAG = ("mag_x", "mag_y", "mag_z")
REQUIRED = (TIME, *ACC, *GYR)
LINE_END = re.compile(r"[\r\n]+")  # would end the row in a CSV
NUMERIC = frozenset((*REQUIRED, *QUAT, *MAG))


def read_site(
    path: Path, where: str, place: str, sensor: str, is_rate_derived: bool
) -> tuple[ImuBlock, tuple[Finding, ...]]:
    """Read one site's samples, dropping repeated stamps with a finding; raises FileRefusedError."""
    try:
        table = (
            read_parquet(path, where, NUMERIC)
            if path.suffix == ".parquet"
            else read_csv(path, where, NUMERIC, is_ours=True)
        )
    except OSError as error:
        why = error.strerror
        raise FileRefusedError(where, "the file cannot be read ({why})", "Check the permissions", why=why) from error
    missing = [name for name in REQUIRED if name not in table.numbers]
    if missing:
        names = ", ".join(missing)
        raise FileRefusedError(f"{where}, line 1", "required columns are missing: {names}", CORRECT_IT, names=names)
    time_s = table.numbers[TIME]
    is_new = _check_clock(time_s, table, where)
    kept = slice(None) if is_new.all() else is_new  # ten hours are not copied for nothing
    findings = list(_table_findings(table, place, int(np.sum(~is_new)), is_rate_derived))

    has_quat, has_mag = (all(n in table.numbers for n in names) for names in (QUAT, MAG))
    halves = [n for names, is_whole in ((QUAT, has_quat), (MAG, has_mag)) if not is_whole for n in names]
    strays = {n: table.numbers[n] for n in halves if n in table.numbers}
    unknown: dict[str, NDArray[np.generic]] = {**table.texts, **strays}
    findings += [Finding("unknown_column", Severity.INFO, place, {"name": name}) for name in unknown]
    block = ImuBlock(
        sensor=sensor,
        time_s=time_s[kept],
        gyr_rad_s=table.matrix(GYR)[kept],
        acc_m_s2=table.matrix(ACC)[kept],
        q_earth_from_sensor=table.matrix(QUAT)[kept] if has_quat else None,
        mag=table.matrix(MAG)[kept] if has_mag else None,
        is_rate_derived=is_rate_derived,
        unknown={name: column[kept] for name, column in unknown.items()},
    )
    return block, tuple(findings)


def write_site(block: ImuBlock, path: Path) -> None:
    """Write a CSV that `read_site` reads back bit for bit; ValueError for a column named as a block's own."""
    import pyarrow.csv  # here, not above: the window starts without it

    columns = {
        TIME: block.time_s,
        **dict(zip(ACC, block.acc_m_s2.T, strict=True)),
        **dict(zip(GYR, block.gyr_rad_s.T, strict=True)),
    }
    if block.q_earth_from_sensor is not None:
        columns |= dict(zip(QUAT, block.q_earth_from_sensor.T, strict=True))
    if block.mag is not None:
        columns |= dict(zip(MAG, block.mag.T, strict=True))
    arrays = [pyarrow.array(np.ascontiguousarray(column, dtype=float), from_pandas=True) for column in columns.values()]
    for name, column in block.unknown.items():
        if name in columns:
            raise ValueError(f"the unknown column {name} is one of the block's own")
        is_number = np.issubdtype(column.dtype, np.floating)
        texts = ["" if is_number and np.isnan(v) else LINE_END.sub(" ", str(v)) for v in column]
        arrays.append(pyarrow.array(texts, pyarrow.string()))
        columns[name] = column
    header = ",".join(_header_cell(name) for name in columns)
    with path.open("wb") as file:
        file.write(f"{header}\n".encode())
        if len(block):
            table = pyarrow.Table.from_arrays(arrays, names=[str(i) for i in range(len(arrays))])
            pyarrow.csv.write_csv(table, file, write_options=pyarrow.csv.WriteOptions(include_header=False))


class SitesOnDemand(Mapping[Site, ImuBlock]):
    """The blocks of files too large to be held: each is read when asked for, the last two of a session are kept.

    Every file was read and checked once before, so asking raises `FileRefusedError` only when one has changed since.
    """

    def __init__(self, files: Mapping[Site, "SiteFile"], shelf: "Shelf") -> None:
        self._files = files
        self._shelf = shelf

    def __getitem__(self, site: Site) -> ImuBlock:
        return self._shelf.fetch(self._files[site])[0]

    def __contains__(self, site: object) -> bool:
        return site in self._files

    def __iter__(self) -> Iterator[Site]:
        return iter(self._files)

    def __len__(self) -> int:
        return len(self._files)


@dataclass(frozen=True, slots=True)
class SiteFile:
    """A file and what it takes to read it: the arguments of `read_site`."""

    path: Path
    where: str
    place: str
    sensor: str
    is_rate_derived: bool

    def read(self) -> "ReadSite":
        return read_site(self.path, self.where, self.place, self.sensor, self.is_rate_derived)


ReadSite = tuple[ImuBlock, tuple[Finding, ...]]


class Shelf:
    """Keeps the blocks that were read last: two, because a joint needs two."""

    PLACES = 2

    def __init__(self, read: Callable[[SiteFile], ReadSite]) -> None:
        self._read_file = read
        self._read: dict[SiteFile, ReadSite] = {}

    def fetch(self, file: SiteFile) -> ReadSite:
        read = self._read.pop(file, None)
        if read is None:
            while len(self._read) >= self.PLACES:
                del self._read[next(iter(self._read))]
            read = self._read_file(file)
        self._read[file] = read
        return read


def sensor_changes(worn: Sequence[tuple[str, Mapping[Site, str]]]) -> tuple[Finding, ...]:
    """Find where a recording's sensor differs from that of the last one with a sensor at the site."""
    last: dict[Site, str] = {}
    findings = []
    for recording, sensors in worn:
        for site, sensor in sensors.items():
            if last.get(site, sensor) != sensor:
                numbers = {"before": last[site], "after": sensor}
                findings.append(Finding("sensor_changed", Severity.WARNING, f"{recording}, {site}", numbers))
            last[site] = sensor
    return tuple(findings)


def _header_cell(name: str) -> str:
    name = LINE_END.sub(" ", name)
    return '"' + name.replace('"', '""') + '"' if set(name) & set(',"') else name


def _check_clock(time_s: FloatArray, table: Table, where: str) -> BoolArray:
    """(n,) which samples are later than the one before; refuses an empty stamp and one before its predecessor."""
    is_new = np.ones(len(time_s), dtype=bool)
    empty = np.flatnonzero(~np.isfinite(time_s))
    if len(empty):
        place = f"{where}, {table.place(int(empty[0]))}"
        if np.isnan(time_s[empty[0]]):
            raise FileRefusedError(place, "a sample has no time", CORRECT_IT)
        raise FileRefusedError(place, "a sample's time is infinite", CORRECT_IT)
    step_s = np.diff(time_s)
    back = np.flatnonzero(step_s < 0)
    if len(back):
        row = int(back[0]) + 1
        raise FileRefusedError(
            f"{where}, {table.place(row)}",
            "the clock goes back from {before} s to {after} s",
            "Split the recording there, or export it again",
            before=plain(float(time_s[row - 1])),
            after=plain(float(time_s[row])),
        )
    is_new[1:] = step_s > 0
    return is_new


def _table_findings(table: Table, place: str, doubled: int, is_rate_derived: bool) -> Iterator[Finding]:
    if doubled:
        yield Finding("doubled_stamps", Severity.WARNING, place, {"count": doubled})
    infinite = sum(int(np.isinf(column).sum()) for column in table.numbers.values())
    if is_rate_derived:
        yield Finding("rate_from_orientation", Severity.INFO, place)
    if infinite:
        yield Finding("infinite_values", Severity.WARNING, place, {"count": infinite})
    if table.is_open:
        yield Finding("last_line_open", Severity.INFO, place)
