"""A session as it would be made of the files of another program: what is proposed, for somebody to confirm or change.

What a sensor's name gives of its site is proposed; without names, the motion shows which sensors make up a leg and
which is its thigh, shank and foot, but never which leg is the left one.
"""

import datetime
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from app.importing.splitting import clock_view_of, split_trial
from core.body import Site
from core.placement.chains import USUAL_SITES, Chains, find_chains
from core.samples import ImuBlock, RateKind
from core.session import Recording, RecordingKind, Session
from core.signal.clock_events import ClockView
from core.signal.sensors import SensorTracks
from devices.files.imports import add_recording, folder_for, free_name, place_sensors
from devices.files.site_names import site_of_name
from devices.files.trial import ImportedSensor, ImportedTrial

QUIET_RAD_S = 0.15  # somebody who is standing sways less, nine of ten times
LONGEST_STANDING_S = 120.0
KINDS_IN_NAMES = {
    RecordingKind.STANDING: r"stand|static|still|npose|n-pose",
    RecordingKind.FREE_MOTION: r"free|calib|functional|swing",
    RecordingKind.WALKING: r"walk|gait|gang|treadmill",
}
MOVING_S = 60.0  # of a motion are enough to place its sensors


class Origin(StrEnum):
    """What a proposal is taken from."""

    NAME = "name"
    MOTION = "motion"
    NOTHING = "nothing"


@dataclass(frozen=True, slots=True)
class DraftSensor:
    """One sensor of all trials of a session, by its serial or else its name."""

    key: str
    name: str
    site: Site | None
    origin: Origin


@dataclass(frozen=True, slots=True)
class DraftRecording:
    """`title`: what its files are called together. `clocks`: what befell those of its sensors."""

    title: str
    trial: ImportedTrial
    kind: RecordingKind
    origin: Origin
    clocks: ClockView


@dataclass(frozen=True, slots=True)
class SessionDraft:
    """Recordings of one patient on one day, in order of time as far as the files give it, else of their names."""

    recordings: tuple[DraftRecording, ...]
    sensors: tuple[DraftSensor, ...]

    @property
    def is_clock_open(self) -> bool:
        """Whether there are several sensors, and nothing states which clock gave their times."""
        sensors = [sensor for one in self.recordings for sensor in one.trial.sensors]
        return len(self.sensors) > 1 and not any(sensor.info.clock for sensor in sensors)

    @property
    def started(self) -> str:
        """When the first of them began, as the files give it; empty where they do not."""
        return next(filter(None, (_when(one.trial) for one in self.recordings)), "")


def drafts_of(trials: Sequence[tuple[str, ImportedTrial]]) -> tuple[SessionDraft, ...]:
    """Put trials, each with a title, together to sessions: of one program and day, with sensors in common."""
    groups: list[list[tuple[str, ImportedTrial]]] = []
    for title, trial in trials:
        group = next((group for group in groups if any(_are_of_one_session(trial, other) for _, other in group)), None)
        if group is None:
            groups.append([(title, trial)])
        else:
            group.append((title, trial))
    return tuple(map(_draft, groups))


def key_of(sensor: ImportedSensor) -> str:
    """By what a sensor is known in all trials of a session."""
    return sensor.info.serial or sensor.name


def session_of(
    draft: SessionDraft,
    kinds: Sequence[RecordingKind | None],
    sites: Mapping[str, Site | None],
    day: str = "",
    *,
    is_one_receiver: bool = False,
) -> Session:
    """Give the confirmed session; `kinds` None: left out, `sites` None: not on a leg; `day`: ISO 8601.

    `is_one_receiver`: the sensors share its clock. Raises FileRefusedError for two sensors at one site or sensors of a
    recording without common time.
    """
    session = Session((), started="" if draft.started else day)
    for one, kind in zip(draft.recordings, kinds, strict=True):
        placed = [(site, sensor) for sensor in one.trial.sensors if (site := sites.get(key_of(sensor))) is not None]
        if kind is None or not placed:
            continue
        name = free_name(session, kind)
        imported = place_sensors(one.trial, placed, name, is_one_receiver=is_one_receiver)
        started = _when(one.trial)
        recording = Recording(name, kind, folder_for(name), imported.imu, started=started, note=one.title)
        session = add_recording(session, recording, imported.sensors, imported.findings, imported.is_simulated)
        session = replace(session, started=session.started or started)
    return session


def split_draft(draft: SessionDraft, number: int, at_s: float) -> SessionDraft:
    """Give the draft with one of its recordings as two, split at a time of its `clocks`; raises FileRefusedError."""
    one = draft.recordings[number]
    parts = [
        replace(one, title=f"{one.title} ({letter})", trial=part, clocks=clock_view_of(part))
        for letter, part in zip("ab", split_trial(one.trial, at_s), strict=True)
    ]
    return replace(draft, recordings=(*draft.recordings[:number], *parts, *draft.recordings[number + 1 :]))


def chains_of_motion(draft: SessionDraft, worn: Sequence[str]) -> Chains | None:
    """Give the legs found in the liveliest recording from the 2 to 7 `worn` sensor keys; None where none."""
    if len(worn) not in USUAL_SITES:
        return None
    sites = dict(zip(worn, Site, strict=False))  # any: they are only labels here
    recordings = []
    for number, one in enumerate(draft.recordings):
        imu = {sites[key_of(sensor)]: sensor.block for sensor in one.trial.sensors if key_of(sensor) in sites}
        recordings.append(Recording(str(number), one.kind, str(number), imu))
    moving = [one for one in recordings if one.kind is not RecordingKind.STANDING and len(one.imu) == len(sites)]
    if not moving:
        return None
    chosen = max(moving, key=lambda one: min(_liveliness(block) for block in one.imu.values()))
    short = replace(chosen, imu={site: _first(block, MOVING_S) for site, block in chosen.imu.items()})
    standing = next((one for one in recordings if one.kind is RecordingKind.STANDING), None)
    span = (*filter(None, [standing]), short)
    tracks = SensorTracks(Session(span), span, frozenset(), RateKind.INSTANTANEOUS)
    names = {site: key for key, site in sites.items()}
    start_s, end_s = tracks.span_of(short)
    oriented = {names[site]: tracks.oriented(short, site, tracks.blocks(short)[0]) for site in short.imu}
    rests = {names[site]: tracks.rest(standing, site) for site in standing.imu} if standing else {}
    if end_s <= start_s or not all(oriented.values()):
        return None
    return find_chains(oriented, {key: rest.acc_m_s2 for key, rest in rests.items() if rest is not None})


def _draft(trials: Sequence[tuple[str, ImportedTrial]]) -> SessionDraft:
    in_order = sorted(trials, key=lambda one: _when(one[1]))  # stable: those that give no time stay as they were
    recordings = tuple(
        DraftRecording(title, trial, *_kind(title, trial), clock_view_of(trial)) for title, trial in in_order
    )
    names: dict[str, list[str]] = {}
    for _, trial in in_order:
        for sensor in trial.sensors:
            names.setdefault(key_of(sensor), []).append(sensor.name)
    proposed = {key: _site(stated) for key, stated in names.items()}
    taken = [site for site in proposed.values() if site is not None]
    sensors = []
    for key, stated in names.items():
        site = proposed[key]
        is_free = site is not None and taken.count(site) == 1  # two of one name say nothing
        sensors.append(
            DraftSensor(key, stated[0], site if is_free else None, Origin.NAME if is_free else Origin.NOTHING)
        )
    return SessionDraft(recordings, tuple(sensors))


def _site(names: Sequence[str]) -> Site | None:
    """What all names of a sensor agree on."""
    stated = {site_of_name(name.rsplit(".", 1)[0]) for name in names}
    return next(iter(stated)) if len(stated) == 1 else None


def _kind(title: str, trial: ImportedTrial) -> tuple[RecordingKind, Origin]:
    for kind, words in KINDS_IN_NAMES.items():
        if re.search(words, title.casefold()):
            return kind, Origin.NAME
    blocks = [sensor.block for sensor in trial.sensors if len(sensor.block)]
    is_short = all(block.time_s[-1] - block.time_s[0] < LONGEST_STANDING_S for block in blocks)
    if blocks and is_short and all(_liveliness(block) < QUIET_RAD_S for block in blocks):
        return RecordingKind.STANDING, Origin.MOTION
    return RecordingKind.WALKING, Origin.NOTHING


def _liveliness(block: ImuBlock) -> float:
    """The rate that nine of ten samples stay under, rad/s, less the sensor's own bias; 0 without samples."""
    rates = block.gyr_rad_s[np.isfinite(block.gyr_rad_s).all(axis=1)]
    if not len(rates):
        return 0.0
    return float(np.quantile(np.linalg.norm(rates - np.median(rates, axis=0), axis=1), 0.9))


def _first(block: ImuBlock, seconds: float) -> ImuBlock:
    return block.select(block.time_s < block.time_s[0] + seconds) if len(block) else block


def _are_of_one_session(one: ImportedTrial, other: ImportedTrial) -> bool:
    keys, other_keys = (set(map(key_of, trial.sensors)) for trial in (one, other))
    days = {_when(trial)[:10] for trial in (one, other)} - {""}
    return one.format == other.format and len(days) < 2 and bool(keys & other_keys)


def _when(trial: ImportedTrial) -> str:
    """When it began, ISO 8601; empty where the files give nothing that is a time."""
    try:
        return datetime.datetime.fromisoformat(trial.started).isoformat()
    except ValueError:
        return ""
