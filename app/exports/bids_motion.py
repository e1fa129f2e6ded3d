"""BIDS-Motion data of what the sensors measured: a recording's samples, their channels and settings, and its events.

As the Brain Imaging Data Structure has it for motion: one table without heads for each tracking system, which is all
sensors of one time base, with the latencies from the start of the recording in its first column. Samples and times are
those of the recording to their last digit; what is missing is n/a. Three columns of ours say what BIDS has no word for:
the sensor's number, what its rates are, and which sensors share a clock. Two settings state what is simulated, and that
the latencies of several tracking systems have one zero: `gaitwright import` gives back the same recording. Events have
the same zero.
"""

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from app.exports.figures import SIMULATED, software
from app.storage.pseudonyms import AGE, age_in_words
from app.summary.events import events_of
from app.wording.translation import PURPOSE, tr
from core.body import Side, Site
from core.prosthesis import prosthesis_table
from core.results import Analysis
from core.samples import FloatArray, ImuBlock, SensorInfo
from core.session import Patient, Recording, RecordingKind, Session

FOLDER = "bids"
BIDS_VERSION = "1.10.0"
TASKS = {
    RecordingKind.STANDING: "standing",
    RecordingKind.FREE_MOTION: "freeMotion",
    RecordingKind.WALKING: "walking",
}
SEXES = {"female": "F", "male": "M", "other": "O"}
OLDEST_YEARS = 89  # BIDS has one age for all from here on
MISSING = "n/a"
DERIVED = "derived"
# of our own, as BIDS has no words for them: an import keeps what nobody was measured for apart, and systems together
IS_SIMULATED, IS_COMMON_START = "Simulated", "LatenciesFromOneStart"
AXES, QUATERNION = ("x", "y", "z"), ("quat_w", "quat_x", "quat_y", "quat_z")
COLUMNS = (
    "name",
    "component",
    "type",
    "tracked_point",
    "units",
    "reference_frame",
    "sensor",
    "rate_kind",
    "shared_clock",
)
ABOUT_COLUMNS = {
    "reference_frame": {
        "Levels": {
            "sensor": {"Description": "The axes of the sensor itself, as its maker has them; right-hand."},
            "earth": {
                "Description": "From sensor to earth, as the sensor gives it: z is up, the heading is any.",
                "SpatialAxes": "__S",
                "RotationRule": "right-hand",
            },
        }
    },
    "sensor": {"Description": "Number or name of the sensor."},
    "rate_kind": {
        "Description": "What one sample of the gyroscope represents.",
        "Levels": {
            "instantaneous": "The instant of its latency.",
            "averaged": "The mean over the interval before its latency.",
            DERIVED: "Computed from the sensor's own orientation: no rates were measured.",
        },
    },
    "shared_clock": {"Description": "Sensors with the same value were timed by one clock."},
}
ABOUT_EVENTS = {
    "onset": {"Description": "On the clock of the latencies, from the start of the recording.", "Units": "s"},
    "duration": {"Description": "Events are instants.", "Units": "s"},
    "trial_type": {
        "Description": "The event of a foot, found from its sensor.",
        "Levels": {
            "initial_contact": "The foot comes to the floor.",
            "full_contact": "The whole foot comes to the floor.",
            "heel_rise": "The heel leaves the floor.",
            "toe_off": "The foot leaves the floor.",
        },
    },
    "side": {"Description": "Of which foot.", "Levels": {side: f"The {side} foot." for side in Side}},
}


@dataclass(frozen=True, slots=True)
class BidsChannel:
    """A column of the table of samples and its row in the table of channels."""

    row: Mapping[str, str]
    values: FloatArray


def write_bids(session: Session, analysis: Analysis, folder: Path) -> str:
    """Write the kept recordings as a BIDS dataset of one participant; give why nothing was written, else ""."""
    held = [one for one in session.recordings if one.is_kept and any(len(block) for block in one.imu.values())]
    if not held:
        return tr("No included recording contains sensor data.")
    participant = f"sub-{_label(session.patient.code) or 'unknown'}"
    motion = folder / participant / "motion"
    motion.mkdir(parents=True)
    scans = ["filename\tacq_time"]
    runs: dict[RecordingKind, int] = {}
    events = {one.name: events_of(one) for one in analysis.recordings}
    for recording in held:
        run = runs[recording.kind] = runs.get(recording.kind, 0) + 1
        task = f"{participant}_task-{TASKS[recording.kind]}"
        if found := events.get(recording.name):
            _write_events(found, motion / f"{task}_run-{run}_events.tsv")
        for system, sites in _systems(recording).items():
            base = f"{task}_tracksys-{system}_run-{run}"
            _write_system(session, recording, sites, motion / base, system)
            scans.append(f"motion/{base}_motion.tsv\t{_acquired(recording.started)}")
    (folder / participant / f"{participant}_scans.tsv").write_text("\n".join([*scans, ""]), encoding="utf-8")
    _write_participant(session, participant, folder)
    _write_json(
        folder / "dataset_description.json",
        {
            "Name": f"{SIMULATED if session.is_simulated else 'A session with inertial sensors'} ({participant})",
            "BIDSVersion": BIDS_VERSION,
            "DatasetType": "raw",
            "Authors": [session.operator or MISSING],
            "GeneratedBy": [{"Name": software()}],
        },
    )
    stated = [SIMULATED] if session.is_simulated else []
    stated += [
        f"What inertial sensors on thighs, shanks and feet measured in one session. Made by {software()}. {PURPOSE}",
        "Accelerations hold gravity. Axes are those of the sensors, whose alignment to the body is not known.",
    ]
    (folder / "README").write_text("\n".join([*stated, ""]), encoding="utf-8")
    return ""


def _write_events(events: Sequence[tuple[float, Side, str]], path: Path) -> None:
    lines = [f"{time_s:.5f}\t0\t{event}\t{side}" for time_s, side, event in events]
    path.write_text("\n".join(["\t".join(ABOUT_EVENTS), *lines, ""]), encoding="utf-8")
    _write_json(path.with_suffix(".json"), ABOUT_EVENTS)


def _systems(recording: Recording) -> dict[str, list[Site]]:
    """The sites of each time base, under the name of its tracking system."""
    groups: list[list[Site]] = []
    for site, block in recording.imu.items():
        if not len(block):
            continue
        for group in groups:
            if np.array_equal(recording.imu[group[0]].time_s, block.time_s):
                group.append(site)
                break
        else:
            groups.append([site])
    if len(groups) == 1:
        return {"imu": groups[0]}
    return {f"imu{number}": group for number, group in enumerate(groups, 1)}


def _write_system(session: Session, recording: Recording, sites: Sequence[Site], base: Path, system: str) -> None:
    time_s = recording.imu[sites[0]].time_s
    latency = {"name": "latency", "component": MISSING, "type": "LATENCY", "tracked_point": MISSING, "units": "s"}
    channels = [BidsChannel(latency, time_s)]
    clocks = list(dict.fromkeys(info.clock for info in session.sensors.values() if info.clock))
    for site in sites:
        info = session.sensors.get(site, SensorInfo())
        clock = f"clock{clocks.index(info.clock) + 1}" if info.clock else ""  # its name may be a computer's
        channels += _channels(_point(site), recording.imu[site], info, clock)
    table = ["\t".join(COLUMNS)]
    table += ["\t".join(one.row.get(name) or MISSING for name in COLUMNS) for one in channels]
    base.with_name(f"{base.name}_channels.tsv").write_text("\n".join([*table, ""]), encoding="utf-8")
    _write_json(base.with_name(f"{base.name}_channels.json"), ABOUT_COLUMNS)
    columns = [one.values for one in channels]
    with base.with_name(f"{base.name}_motion.tsv").open("w", encoding="ascii", newline="\n") as file:
        for k in range(len(time_s)):
            cells = (repr(float(column[k])) if np.isfinite(column[k]) else MISSING for column in columns)
            file.write("\t".join(cells) + "\n")
    _write_json(base.with_name(f"{base.name}_motion.json"), _settings(session, recording, sites, channels, system))


def _channels(point: str, block: ImuBlock, info: SensorInfo, clock: str) -> list[BidsChannel]:
    rate_kind = DERIVED if block.is_rate_derived else (info.rate_kind or "")
    quantities = [
        ("ACCEL", AXES, "m/s^2", "sensor", block.acc_m_s2),
        ("GYRO", AXES, "rad/s", "sensor", block.gyr_rad_s),
        ("MAGN", AXES, MISSING, "sensor", block.mag),
        ("ORNT", QUATERNION, MISSING, "earth", block.q_earth_from_sensor),
    ]
    found = []
    for kind, components, units, frame, values in quantities:
        for k, component in enumerate(components) if values is not None else ():
            assert values is not None  # none of its components is reached
            row = {
                "name": f"{point}_{kind}_{component}",
                "component": component,
                "type": kind,
                "tracked_point": point,
                "units": units,
                "reference_frame": frame,
                "sensor": _cell(block.sensor),
                "rate_kind": rate_kind if kind == "GYRO" else "",
                "shared_clock": clock,
            }
            found.append(BidsChannel(row, values[:, k]))
    return found


def _settings(
    session: Session, recording: Recording, sites: Sequence[Site], channels: Sequence[BidsChannel], system: str
) -> dict[str, object]:
    time_s = recording.imu[sites[0]].time_s
    length_s = float(time_s[-1] - time_s[0])
    effective_hz = (len(time_s) - 1) / length_s if length_s > 0 else 0.0
    reported = [session.sensors.get(site, SensorInfo()) for site in sites]
    rates_hz, models = {info.rate_hz for info in reported}, {info.model for info in reported}
    stated_hz = next(iter(rates_hz)) if len(rates_hz) == 1 else None
    kinds = [one.row["type"] for one in channels]
    settings: dict[str, object] = {
        "TaskName": TASKS[recording.kind],
        "TaskDescription": ", ".join(filter(None, [recording.name, recording.condition])),
        "TrackingSystemName": system,
        "SamplingFrequency": stated_hz or round(effective_hz, 3),
        "SamplingFrequencyEffective": effective_hz,
        "RecordingDuration": length_s,
        "MissingValues": MISSING,
        "TrackedPointsCount": len(sites),
        "MotionChannelCount": len(channels),
    }
    if session.is_simulated:
        settings[IS_SIMULATED] = True
    if len(_systems(recording)) > 1:
        settings[IS_COMMON_START] = True
    settings |= {f"{kind}ChannelCount": kinds.count(kind) for kind in dict.fromkeys(kinds)}
    if len(models) == 1 and (model := next(iter(models))):
        settings["ManufacturersModelName"] = model
    return settings


def _write_participant(session: Session, participant: str, folder: Path) -> None:
    patient = session.patient
    age = str(patient.unknown.get(AGE) or age_in_words(session))
    is_old = age.endswith("+") or (age.isdigit() and int(age) >= OLDEST_YEARS)
    row = {
        "participant_id": participant,
        "age": str(OLDEST_YEARS) if is_old else age,
        "sex": SEXES.get(patient.sex, ""),
        "height": "" if patient.height_m is None else f"{patient.height_m:g}",
        "weight": "" if patient.mass_kg is None else f"{patient.mass_kg:g}",
        "affected_side": patient.affected_side,
        "prosthetic_side": patient.prosthetic_side,
        **_prostheses(patient),
    }
    lines = ["\t".join(row), "\t".join(_cell(value) or MISSING for value in row.values())]
    (folder / "participants.tsv").write_text("\n".join([*lines, ""]), encoding="utf-8")
    _write_json(
        folder / "participants.json",
        {
            "age": {"Description": "Age in the year of the session.", "Units": "year"},
            "sex": {"Description": "Sex, as it was typed.", "Levels": {"F": "female", "M": "male", "O": "other"}},
            "height": {"Description": "Height of the body.", "Units": "m"},
            "weight": {"Description": "Mass of the body.", "Units": "kg"},
            "affected_side": {"Description": "The side or sides that are affected."},
            "prosthetic_side": {"Description": "The side or sides with a prosthesis."},
            **{name: {"Description": f"{name.replace('_', ' ').capitalize()}."} for name in _prostheses(patient)},
        },
    )


def _prostheses(patient: Patient) -> dict[str, str]:
    """What is stated of each prosthesis, a column a part; none where nothing is."""
    names = {"level": "amputation_level", "knee": "prosthetic_knee", "foot": "prosthetic_foot"}
    stated = {side: prosthesis_table(one) for side, one in patient.worn.items()}
    return {f"{side}_{names[part]}": word for side, table in stated.items() for part, word in table.items()}


def _acquired(started: str) -> str:
    """A start as BIDS writes it, without an offset from UTC; n/a where it is not known."""
    try:
        moment = datetime.fromisoformat(started)
    except ValueError:
        return MISSING
    if moment.tzinfo is None:
        return moment.isoformat()
    return moment.astimezone(UTC).replace(tzinfo=None).isoformat() + "Z"


def _point(site: Site) -> str:
    """LeftThigh for left_thigh."""
    return "".join(word.capitalize() for word in site.value.split("_"))


def _label(text: str) -> str:
    """Letters and digits, of which alone BIDS makes names of files."""
    return re.sub(r"[^A-Za-z0-9]", "", text)


def _cell(text: str) -> str:
    """Text that breaks no line and no column."""
    return " ".join(text.split())


def _write_json(path: Path, content: Mapping[str, object]) -> None:
    path.write_text(json.dumps(content, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
