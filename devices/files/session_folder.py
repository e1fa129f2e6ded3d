"""Session folders, read and written: one visit each.

The folder is a public interface: `session.toml` and, per recording, a folder with one table per site. Reading checks
every file whole, so that nothing is refused later, in the middle of an analysis. Beyond `HELD_BYTES` of files the
samples are then let go and read again when asked for.
"""

import shutil
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Protocol

from core.body import Site
from core.findings import Finding, Severity
from core.samples import ImuBlock
from core.session import Recording, Session
from devices.files.refusal import FileRefusedError
from devices.files.session_toml import (
    FILE_NAME,
    Plan,
    default_sensor,
    parse_document,
    parse_toml,
    render,
    unknown_keys,
)
from devices.files.site_files import ReadSite, Shelf, SiteFile, SitesOnDemand, sensor_changes, write_site

# in memory our own text takes half of what it takes in files, the shortest numbers four times as much
HELD_BYTES = 500_000_000  # of files: two hours of six sensors at 100 Hz
MOST_HELD_BYTES = 2_000_000_000  # in memory, where the files are not larger than `HELD_BYTES`
SUFFIXES = (".csv", ".parquet")


class SessionReader(Protocol):
    """Who opens the files of a session folder: this process (`InThisProcess`), or a limited one."""

    def read_toml(self, path: Path) -> Mapping[str, object]: ...

    def read_site(self, file: SiteFile) -> ReadSite: ...


class InThisProcess:
    """For folders that we wrote ourselves, and for the limited process itself."""

    def read_toml(self, path: Path) -> Mapping[str, object]:
        try:
            return parse_toml(path.read_bytes().decode("utf-8-sig"))
        except UnicodeDecodeError as error:
            raise FileRefusedError(
                FILE_NAME, "the file is not UTF-8 text", "Save {file} as UTF-8", file=FILE_NAME
            ) from error

    def read_site(self, file: SiteFile) -> ReadSite:
        return file.read()


IN_THIS_PROCESS = InThisProcess()


def read_session(folder: Path, reader: SessionReader = IN_THIS_PROCESS) -> Session:
    """Read a session folder.

    Everything the folder contains and everything odd about it is in the result, its recordings in the file's order.
    `Recording.imu` of a large session reads a site when asked for; then asking can raise, if a file changed since.

    Parameters
    ----------
    folder
        Holds session.toml and one folder per recording.
    reader
        Who opens the files: this process, or a limited one for folders of unknown origin.

    Returns
    -------
    Session
        Samples in SI units and sensor axes, stamps in seconds on each recording's clock.

    Raises
    ------
    FileRefusedError
        The folder is not what it claims to be: see `session_toml.parse` and `site_files.read_site`; a recording's
        folder missing or outside of the session folder, a site there twice, no samples at all, more samples than their
        files can hold.

    Examples
    --------
    >>> session = read_session(folder)
    >>> [recording.name for recording in session.recordings]
    ['standing', 'free motion', 'walk 1']
    """
    try:
        return _read(folder, reader)
    except OSError as error:
        raise FileRefusedError(
            str(error.filename or folder),
            "the file or folder cannot be read ({why})",
            "Check the folder and its permissions",
            why=error.strerror,
        ) from error


def write_session(session: Session, folder: Path, reader: SessionReader = IN_THIS_PROCESS) -> None:
    """Write `session` into `folder`, whole or not at all: beside it first, then renamed.

    Samples are written as CSV and read back bit for bit. A session folder that is there is replaced; what it holds
    beside its session (a reference, a note) is taken along. `reader` finds what belongs to the session that is there.

    Raises
    ------
    FileRefusedError
        `folder` holds something that is not a session, or `session` could not be read back.
    OSError
        The disk is full or cannot be written to.
    """
    render(session, [Plan(recording, {}, frozenset()) for recording in session.recordings])  # refuses what it must
    folder = folder.resolve()
    strays = _strays(folder, reader)
    folder.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=f".{folder.name}-", dir=folder.parent) as beside:
        new, old = Path(beside) / "new", Path(beside) / "old"
        new.mkdir()
        plans = [_write_recording(recording, session, new) for recording in session.recordings]
        (new / FILE_NAME).write_bytes(render(session, plans).encode())
        for stray in strays:
            target = new / stray.relative_to(folder)
            if not target.exists():
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(stray, target, follow_symlinks=False)
        if folder.exists():
            folder.rename(old)
        try:
            new.rename(folder)
        except OSError:
            if old.exists():
                old.rename(folder)
            raise


def _read(folder: Path, reader: SessionReader) -> Session:
    session, plans = parse_document(_read_toml(folder, reader))
    files = {plan.recording.name: _site_files(folder, plan, session) for plan in plans}
    if not any(files.values()):
        raise FileRefusedError(
            FILE_NAME,
            "no recording has a file named after a sensor position",
            "Name the files left_thigh.csv, left_shank.csv and so on",
        )
    shelf = Shelf(reader.read_site) if _size(files) > HELD_BYTES else None
    recordings, findings, held_bytes = [], [], 0
    for plan in plans:
        imu, noticed = _read_recording(files[plan.recording.name], reader, shelf)
        if shelf is None:
            held_bytes += sum(_bytes_of(block) for block in imu.values())
            if held_bytes > MOST_HELD_BYTES:  # a kilobyte of Parquet can hold one number a billion times
                raise FileRefusedError(
                    plan.recording.name,
                    "the recording's files contain more samples than their size allows",
                    "Export the recordings again",
                )
        recordings.append(replace(plan.recording, imu=imu))
        findings += [*_folder_findings(folder, plan), *noticed]
    session = replace(session, recordings=tuple(recordings))
    changes = sensor_changes([(name, {site: f.sensor for site, f in sites.items()}) for name, sites in files.items()])
    again = [one for one in (*unknown_keys(session), *findings, *changes) if one not in session.findings]
    return replace(session, findings=(*session.findings, *again))


def _read_toml(folder: Path, reader: SessionReader) -> Mapping[str, object]:
    path = folder / FILE_NAME
    if not path.is_file():
        raise FileRefusedError(
            str(folder),
            "this folder is not a session folder; it contains no {file}",
            "Choose the folder with {file}, or import the recordings first",
            file=FILE_NAME,
        )
    _check_inside(path, folder, FILE_NAME)
    return reader.read_toml(path)


def _site_files(folder: Path, plan: Plan, session: Session) -> dict[Site, SiteFile]:
    recording = plan.recording
    files = {}
    _check_inside(folder / recording.folder, folder, recording.folder)
    if not (folder / recording.folder).is_dir():
        raise FileRefusedError(
            recording.name,
            "the folder of this recording is missing ({folder})",
            "Put the folder back, or remove the recording from {file}",
            folder=recording.folder,
            file=FILE_NAME,
        )
    for site in Site:
        names = [site + suffix for suffix in SUFFIXES if (folder / recording.folder / (site + suffix)).exists()]
        if len(names) > 1:
            raise FileRefusedError(
                recording.folder,
                "{site} exists twice: {first} and {second}",
                "Keep one of the two files",
                site=site,
                first=names[0],
                second=names[1],
            )
        for name in names:
            path, where = folder / recording.folder / name, f"{recording.folder}/{name}"
            _check_inside(path, folder, where)
            if not path.is_file():
                raise FileRefusedError(where, "the path does not lead to a file", "Put the sensor's file there")
            sensor = plan.sensors.get(site) or default_sensor(session, site)
            place = f"{recording.name}, {site}"
            files[site] = SiteFile(path, where, place, sensor, site in plan.rates_derived)
    return files


def _check_inside(path: Path, folder: Path, where: str) -> None:
    """Links may lead anywhere within the session folder, not out of it."""
    try:
        is_inside = path.resolve().is_relative_to(folder.resolve())
    except (OSError, RuntimeError):
        is_inside = False  # a link that leads to itself
    if not is_inside:
        raise FileRefusedError(
            where, "the path leads out of the session folder", "Copy the files into the session folder"
        )


def _size(files: Mapping[str, Mapping[Site, SiteFile]]) -> int:
    return sum(file.path.stat().st_size for sites in files.values() for file in sites.values())


def _bytes_of(block: ImuBlock) -> int:
    samples = (block.time_s, block.gyr_rad_s, block.acc_m_s2, block.q_earth_from_sensor, block.mag)
    return sum(0 if array is None else array.nbytes for array in (*samples, *block.unknown.values()))


def _read_recording(
    files: Mapping[Site, SiteFile], reader: SessionReader, shelf: Shelf | None
) -> tuple[Mapping[Site, ImuBlock], list[Finding]]:
    held: dict[Site, ImuBlock] = {}
    findings: list[Finding] = []
    for site, file in files.items():
        block, noticed = shelf.fetch(file) if shelf else reader.read_site(file)
        findings += noticed
        if shelf is None:
            held[site] = block
        del block  # at most two large blocks at a time
    return held if shelf is None else SitesOnDemand(files, shelf), findings


def _folder_findings(folder: Path, plan: Plan) -> Iterator[Finding]:
    name = plan.recording.name
    expected = {site + suffix for site in Site for suffix in SUFFIXES}
    present = {path.name for path in (folder / plan.recording.folder).iterdir() if path.is_file()}
    if not expected & present:
        yield Finding("no_sites", Severity.WARNING, name)
    for other in sorted(present - expected):
        if not other.startswith(".") and other != FILE_NAME:
            yield Finding("file_left_out", Severity.INFO, name, {"name": other})


def _strays(folder: Path, reader: SessionReader) -> Sequence[Path]:
    """Files of the session folder to be replaced that are not part of its session."""
    if not folder.exists() or (folder.is_dir() and not any(folder.iterdir())):
        return []
    if not (folder / FILE_NAME).is_file():
        raise FileRefusedError(
            str(folder), "the target already exists and is not a session folder", "Choose another folder"
        )
    session, plans = parse_document(_read_toml(folder, reader))
    sites = {file.path for plan in plans for file in _site_files(folder, plan, session).values()}
    return [
        path for path in sorted(folder.rglob("*")) if not path.is_dir() and path not in {*sites, folder / FILE_NAME}
    ]


def _write_recording(recording: Recording, session: Session, folder: Path) -> Plan:
    """Write the samples; what `session.toml` must say beyond the recording itself comes back."""
    sensors, rates_derived = {}, set()
    (folder / recording.folder).mkdir(parents=True, exist_ok=True)
    for site in recording.imu:
        block = recording.imu[site]
        write_site(block, folder / recording.folder / f"{site}.csv")
        if block.sensor != default_sensor(session, site):
            sensors[site] = block.sensor
        if block.is_rate_derived:
            rates_derived.add(site)
        del block  # at most two large blocks at a time
    return Plan(recording, sensors, frozenset(rates_derived))
