"""Sensors of a trial assigned to sites, and imported samples joined to a session."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from core.body import Site
from core.findings import Finding, Severity
from core.samples import ImuBlock, SensorInfo
from core.session import Recording, RecordingKind, Session
from core.signal.clock_jumps import jump_of, spans_of
from devices.files.refusal import FileRefusedError, quoted
from devices.files.site_files import sensor_changes
from devices.files.site_names import site_of_name
from devices.files.trial import ImportedSensor, ImportedTrial, plain_id

MAP = "--map"
SPLIT_AT = "Split the recording there (--split-at {at}), or export it again"
RECEIVER = "one receiver"  # the clock's id, where somebody states that the sensors shared one
AS_IN = "Write the assignment as left_thigh=FILE_OR_SENSOR_ID,left_shank=FILE_OR_SENSOR_ID"


@dataclass(frozen=True, slots=True)
class ImportedFiles:
    """What one import brings: the samples of one recording, what the files say of the sensors, what was noticed."""

    imu: Mapping[Site, ImuBlock]
    sensors: Mapping[Site, SensorInfo]
    findings: tuple[Finding, ...]
    is_simulated: bool = False


def parse_map(text: str) -> dict[Site, str]:
    """Parse `left_thigh=A,left_shank=B`, names may hold commas; raises FileRefusedError where it is not so."""
    placement: dict[Site, str] = {}
    for part in re.split(r",(?=\s*\w+\s*=)", text):
        site, equals, value = (piece.strip() for piece in part.partition("="))
        if not equals or not value:
            raise FileRefusedError(MAP, "{part} does not assign a file to a sensor position", AS_IN, part=quoted(part))
        if site not in list(Site):
            sites = ", ".join(Site)
            raise FileRefusedError(
                MAP, "{site} is not a sensor position", "Sensor positions are {sites}", site=quoted(site), sites=sites
            )
        if site in placement:
            raise FileRefusedError(MAP, "{site} is given twice", "Name each sensor position once", site=site)
        placement[Site(site)] = value
    return placement


def mapped_sites(trial: ImportedTrial) -> dict[Site, str]:
    """Place the sensors that a mapping file names as parts of legs or pelvis; raises FileRefusedError for none."""
    placement: dict[Site, str] = {}
    for name in trial.mapped:
        site = site_of_name(name)
        if site is None:
            continue
        if site in placement:
            raise FileRefusedError(MAP, "{site} is given twice", "Name each sensor position once", site=site)
        placement[site] = name
    if not placement:
        raise FileRefusedError(
            MAP,
            "the mapping file names no part of a leg: {names}",
            AS_IN,
            names=", ".join(trial.mapped) or "-",
        )
    return placement


def place_trial(
    trial: ImportedTrial, placement: Mapping[Site, str], recording: str, *, is_one_receiver: bool = False
) -> ImportedFiles:
    """Place a trial's sensors by name, id or file, time from the first sample; raises FileRefusedError."""
    placed = [(site, _sensor_of(trial, site, value)) for site, value in placement.items()]
    return place_sensors(trial, placed, recording, is_one_receiver=is_one_receiver)


def place_sensors(
    trial: ImportedTrial,
    placed: Sequence[tuple[Site, ImportedSensor]],
    recording: str,
    *,
    is_one_receiver: bool = False,
) -> ImportedFiles:
    """As `place_trial`, by the sensors themselves. `is_one_receiver`: somebody states that all share its clock."""
    for number, (site, sensor) in enumerate(placed):
        if any(sensor is other for _, other in placed[:number]):
            raise FileRefusedError(
                f"{MAP} {site}", "{name} is assigned to two sensor positions", "Name each sensor once", name=sensor.name
            )
        if site in [other for other, _ in placed[:number]]:
            raise FileRefusedError(recording, "{site} is given twice", "Name each sensor position once", site=site)
    if is_one_receiver:
        placed = [(site, _on_one_receiver(sensor)) for site, sensor in placed]
    sensors = [sensor for _, sensor in placed]
    _refuse_restarts(sensors)
    _refuse_apart(sensors)
    _refuse_jumps(sensors)
    start_s = min((sensor.block.time_s[0] for sensor in sensors if len(sensor.block)), default=0.0)
    imu = {
        site: replace(sensor.block, time_s=sensor.block.time_s - start_s) if start_s else sensor.block
        for site, sensor in placed
    }
    used = {sensor.name for sensor in sensors}
    left_out = [sensor.name for sensor in trial.sensors if sensor.name not in used]
    left_out += [Path(unread.file).name for unread in trial.unread]
    findings = [Finding("file_left_out", Severity.INFO, recording, {"name": name}) for name in left_out]
    for site, sensor in placed:
        findings += [replace(finding, where=f"{recording}, {site}") for finding in sensor.findings]
    sensors_of = {site: sensor.info for site, sensor in placed}
    return ImportedFiles(imu, sensors_of, tuple(findings), trial.is_simulated)


def _on_one_receiver(sensor: ImportedSensor) -> ImportedSensor:
    """The sensor on the clock of the receiver that somebody states; raises FileRefusedError where it has its own."""
    if sensor.info.clock:
        raise FileRefusedError(
            sensor.name,
            "its file gives it the clock {clock}, so the sensors did not share one receiver",
            "Leave out the statement that the sensors shared one receiver (--one-receiver)",
            clock=quoted(sensor.info.clock),
        )
    return replace(sensor, info=replace(sensor.info, clock=RECEIVER))


def _sensor_of(trial: ImportedTrial, site: Site, value: str) -> ImportedSensor:
    """The sensor that somebody calls `value`: a file first, then a name, then an id."""
    called = [sensor for sensor in trial.sensors if _is_file(value, sensor.file)]
    called = called or [sensor for sensor in trial.sensors if value.casefold() == sensor.name.casefold()]
    called = called or [s for s in trial.sensors if plain_id(value) in map(plain_id, s.ids)]
    if len(called) == 1:
        return called[0]
    if called:
        names = ", ".join(sensor.name for sensor in called)
        raise FileRefusedError(
            f"{MAP} {site}",
            "{value} is ambiguous: {names}",
            "Give one of these names",
            value=quoted(value),
            names=names,
        )
    for unread in trial.unread:
        if _is_file(value, unread.file) or plain_id(value) in map(plain_id, unread.ids):
            raise unread.refusal
    known = [f"{sensor.name} ({', '.join(sensor.ids)})" if sensor.ids else sensor.name for sensor in trial.sensors]
    raise FileRefusedError(
        f"{MAP} {site}",
        "{value} matches no file and no sensor",
        "Available sensors: {sensors}",
        value=quoted(value),
        sensors=", ".join(known),
    )


def _is_file(value: str, file: str) -> bool:
    path = Path(file)
    return value in (file, path.name, path.stem) or path.resolve() == Path(value).resolve()


def _refuse_apart(sensors: Sequence[ImportedSensor]) -> None:
    """Sensors of one trial are worn at the same time."""
    filled = [sensor for sensor in sensors if len(sensor.block.time_s)]
    if not filled:
        return
    last = max(filled, key=lambda sensor: float(sensor.block.time_s[0]))
    first = min(filled, key=lambda sensor: float(sensor.block.time_s[-1]))
    if last.block.time_s[0] > first.block.time_s[-1]:
        raise FileRefusedError(
            last.name,
            "one sensor's data start after the last sample of {other}, so both do not belong to one trial",
            "Import the files of one trial at a time",
            other=first.name,
        )


def _refuse_restarts(sensors: Sequence[ImportedSensor]) -> None:
    for sensor in sensors:
        for restart in sensor.restarts:
            of, time_s = restart.refusal, sensor.block.time_s
            at = _from_start(sensors, float(time_s[restart.at]))
            raise FileRefusedError.stated_elsewhere(of.where, of.what, SPLIT_AT, {**of.values, "at": at})


def _from_start(sensors: Sequence[ImportedSensor], time_s: float) -> str:
    """A time as `--split-at` takes it: from the first sample of all sensors."""
    return f"{time_s - min(float(one.block.time_s[0]) for one in sensors if len(one.block)):.1f}"


def _refuse_jumps(sensors: Sequence[ImportedSensor]) -> None:
    """How much time passed between two stamps, each sensor's clock alone shows; the others show where it is wrong."""
    spans = [spans_of(sensor.block.time_s) for sensor in sensors]
    for number, sensor in enumerate(sensors):
        jump = jump_of(spans[number], [*spans[:number], *spans[number + 1 :]])
        if jump is not None:
            raise FileRefusedError(
                sensor.name,
                "the sensor's clock jumps forward by {jump} s, {after} s after the start; no other sensor "
                "measured that long",
                SPLIT_AT,
                at=_from_start(sensors, float(sensor.block.time_s[0]) + jump.after_s),
                jump=f"{jump.by_s:.6g}",
                after=f"{jump.after_s:.6g}",
            )


def add_recording(
    session: Session,
    recording: Recording,
    sensors: Mapping[Site, SensorInfo] | None = None,
    findings: Sequence[Finding] = (),
    is_simulated: bool = False,
) -> Session:
    """Add the latest recording (simulated: whole session); first details stay, rates and clocks while all agree.
    Raises FileRefusedError: same name or folder, or somebody was measured in it and not in this one.
    """
    if is_simulated and session.recordings and not session.is_simulated:
        raise FileRefusedError(
            recording.name,
            "these files are simulated, and the session is not",
            "Import the simulated files into a separate session",
        )
    for other in session.recordings:
        if other.name == recording.name:
            raise FileRefusedError(
                recording.name,
                "the session already has a recording with this name",
                "Choose another name with --recording",
            )
        if Path(other.folder) == Path(recording.folder):
            raise FileRefusedError(
                recording.name,
                "the folder {folder} already contains the recording {other}",
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
        is_simulated=session.is_simulated or is_simulated,
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
        clock=first.clock if later.clock in ("", first.clock) else "",
    )
