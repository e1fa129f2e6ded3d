"""Files assigned to sites, and imported samples joined to a session."""

import re
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from core.body import Site
from core.findings import Finding
from core.samples import ImuBlock, Recording, RecordingKind, SensorInfo, Session
from devices.files.refusal import FileRefusedError, quoted
from devices.files.site_files import sensor_changes

MAP = "--map"
AS_IN = "Write it as left_thigh=FILE_OR_SENSOR_ID,left_shank=FILE_OR_SENSOR_ID"


@dataclass(frozen=True, slots=True)
class ImportedFiles:
    """What one import brings: the samples of one recording, what the files say of the sensors, what was noticed."""

    imu: Mapping[Site, ImuBlock]
    sensors: Mapping[Site, SensorInfo]
    findings: tuple[Finding, ...]


def parse_map(text: str) -> dict[Site, str]:
    """The sites and their files or sensors in `left_thigh=A,left_shank=B`. A name may hold commas.

    Raises
    ------
    FileRefusedError
        Not of this shape, an unknown site, a site twice.
    """
    placement: dict[Site, str] = {}
    for part in re.split(r",(?=\s*\w+\s*=)", text):
        site, equals, value = (piece.strip() for piece in part.partition("="))
        if not equals or not value:
            raise FileRefusedError(MAP, "{part} does not say which file is at which site", AS_IN, part=quoted(part))
        if site not in list(Site):
            sites = ", ".join(Site)
            raise FileRefusedError(MAP, "{site} is not a site", "Sites are {sites}", site=quoted(site), sites=sites)
        if site in placement:
            raise FileRefusedError(MAP, "{site} is there twice", "Name each site once", site=site)
        placement[Site(site)] = value
    return placement


def place_files(
    files: Sequence[Path], placement: Mapping[Site, str], sensors_of: Callable[[Path], Collection[str]]
) -> tuple[dict[Site, Path], list[Path]]:
    """The file of each site, and the files that no site names.

    Parameters
    ----------
    placement
        Per site a path, a file's name with or without its suffix, or a sensor's id, with or without underscore.
    sensors_of
        The ids by which a file's sensor may be called.

    Raises
    ------
    FileRefusedError
        A file that is not there, a site whose file or sensor is none or several of the files, a file at two sites.
    """
    for path in files:
        if not path.is_file():
            raise FileRefusedError(str(path), "there is no such file", "Check its name")
    ids = {path: {_plain_id(sensor) for sensor in sensors_of(path)} for path in files}
    placed: dict[Site, Path] = {}
    for site, value in placement.items():
        named = [p for p in files if value in (str(p), p.name, p.stem) or p.resolve() == Path(value).resolve()]
        found = dict.fromkeys(path.resolve() for path in named or [p for p in files if _plain_id(value) in ids[p]])
        if not found:
            raise FileRefusedError(
                f"{MAP} {site}",
                "none of the files is or holds {value}",
                "The sensors there are {sensors}",
                value=quoted(value),
                sensors=", ".join(sorted(set().union(*ids.values()))),
            )
        if len(found) > 1:
            names = ", ".join(path.name for path in found)
            raise FileRefusedError(
                f"{MAP} {site}", "{value} may be {names}", "Give the file's name", value=quoted(value), names=names
            )
        path = next(iter(found))
        if path in placed.values():
            raise FileRefusedError(f"{MAP} {site}", "{name} is at two sites", "Name each file once", name=path.name)
        placed[site] = path
    left_out = [path for path in files if path.resolve() not in placed.values()]
    return placed, left_out


def add_recording(
    session: Session,
    recording: Recording,
    sensors: Mapping[Site, SensorInfo] | None = None,
    findings: Sequence[Finding] = (),
) -> Session:
    """`session` with one recording more, the latest.

    What is known of a sensor stays as it was said first; rates and their kind only while all recordings agree on them.

    Raises
    ------
    FileRefusedError
        The session has a recording of this name or in this folder.
    """
    for other in session.recordings:
        if other.name == recording.name:
            raise FileRefusedError(
                recording.name,
                "the session has a recording of this name already",
                "Choose another name with --recording",
            )
        if Path(other.folder) == Path(recording.folder):
            raise FileRefusedError(
                recording.name,
                "the folder {folder} holds the recording {other} already",
                "Choose another name with --recording",
                folder=quoted(recording.folder),
                other=quoted(other.name),
            )
    added = sensors or {}
    recordings = (*session.recordings, recording)
    worn = [(one.name, {site: one.imu[site].sensor for site in one.imu}) for one in recordings]
    changes = [change for change in sensor_changes(worn) if change.where.startswith(f"{recording.name}, ")]
    return replace(
        session,
        recordings=recordings,
        sensors={**added, **{site: _agreed(info, added.get(site, info)) for site, info in session.sensors.items()}},
        findings=(*session.findings, *findings, *changes),
    )


def free_name(session: Session, kind: RecordingKind) -> str:
    """A name for the next recording of this kind: "standing", "free motion 2", "walk 1"."""
    names = {recording.name for recording in session.recordings}
    number = 1
    while True:
        if kind is RecordingKind.WALKING:
            name = f"walk {number}"
        else:
            name = kind.replace("_", " ") + (f" {number}" if number > 1 else "")
        if name not in names:
            return name
        number += 1


def folder_for(name: str) -> str:
    """The folder of a recording of this name: "walk_1" for "walk 1"."""
    return re.sub(r"[^\w.-]+", "_", name).strip("._") or "recording"


def _agreed(first: SensorInfo, later: SensorInfo) -> SensorInfo:
    return replace(
        first,
        rate_hz=first.rate_hz if first.rate_hz == later.rate_hz else None,
        rate_kind=first.rate_kind if first.rate_kind == later.rate_kind else None,
    )


def _plain_id(sensor: str) -> str:
    return sensor.strip().lstrip("_").upper()
