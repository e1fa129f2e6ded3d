"""Recordings of other programs, split where a clock restarts or jumps, where all sensors pause, or at any time."""

import datetime
from dataclasses import replace

import numpy as np

from core.findings import Finding, Severity
from core.samples import FloatArray
from core.signal.clock_events import (
    TOGETHER_S,
    ClockBreak,
    ClockEventKind,
    ClockView,
    clock_view,
    closed_jumps,
    middle_s,
)
from core.signal.reception import pauses_among
from devices.files.refusal import FileRefusedError
from devices.files.trial import ImportedSensor, ImportedTrial

SAME_SHIFT_S = 0.001  # clocks that all went by the same time are as far apart as before

Parts = tuple[ImportedTrial, ImportedTrial]


def clock_view_of(trial: ImportedTrial) -> ClockView:
    """What befell the clocks of a trial's sensors."""
    return clock_view(
        [sensor.block for sensor in trial.sensors],
        list(map(_breaks, trial.sensors)),
        [sensor.info.rate_hz for sensor in trial.sensors],
    )


def split_trial(trial: ImportedTrial, at_s: float) -> Parts:
    """Split at a time of `clock_view_of`; a restart, jump or pause near it is where it is split, sensor by sensor.

    Where clocks went on differently, no one knows how they relate any more: each then has its own in both parts.

    Raises
    ------
    FileRefusedError
        No sample is on one side.
    """
    filled = [sensor for sensor in trial.sensors if len(sensor.block)]
    closed = closed_jumps([sensor.block.time_s for sensor in filled])
    zero_s = min((float(time_s[0]) for time_s, _ in closed), default=0.0)
    cut_s = _in_pause([time_s - zero_s for time_s, _ in closed], at_s)
    parts: tuple[list[ImportedSensor], list[ImportedSensor]] = ([], [])
    shifts_s = []
    for sensor, (time_s, jumps) in zip(filled, closed, strict=True):
        near = {abs(middle_s(time_s, one.at) - zero_s - cut_s): one for one in (*jumps, *_breaks(sensor))}
        own = near[min(near)] if near and min(near) <= TOGETHER_S else None
        at = own.at if own is not None else int(np.searchsorted(time_s, cut_s + zero_s))
        first, second = _split(sensor, at, own)
        parts[0].extend(filter(None, [first]))
        if second is not None:
            parts[1].append(second)
            shifts_s.append(own.shift_s if own is not None else 0.0)
    if not all(parts):
        raise FileRefusedError(
            ", ".join(dict.fromkeys(sensor.name for sensor in filled)),
            "there are no samples on one side of {at} s",
            "Split the recording at a time within it",
            at=f"{at_s:.0f}",
        )
    is_broken = max(shifts_s) - min(shifts_s) > SAME_SHIFT_S
    is_known = not any(shifts_s)
    own_clocks = [[_on_own_clock(one) if is_broken else one for one in part] for part in parts]
    if is_broken:
        reported = Finding("split_clocks", Severity.WARNING, "")
        own_clocks[1] = [replace(one, findings=(*one.findings, reported)) for one in own_clocks[1]]
    started = _later(trial.started, cut_s) if is_known else ""
    return (
        replace(trial, sensors=tuple(own_clocks[0])),
        replace(trial, sensors=tuple(own_clocks[1]), unread=(), started=started),
    )


def split_all(trial: ImportedTrial, at_s: list[float]) -> list[ImportedTrial]:
    """Split at several times of `clock_view_of`, ascending; raises FileRefusedError as `split_trial`."""
    parts = [trial]
    for one_s in sorted(set(at_s), reverse=True):  # the last first: times before it stay what they are
        parts[:1] = split_trial(parts[0], one_s)
    return parts


def _split(
    sensor: ImportedSensor, at: int, own: ClockBreak | None
) -> tuple[ImportedSensor | None, ImportedSensor | None]:
    """A sensor before and after a number of its samples, without the break that is there."""
    time_s, restarts = sensor.block.time_s, sensor.restarts
    if own is not None and own.kind is ClockEventKind.JUMP:
        time_s = np.concatenate([time_s[:at], time_s[at:] + own.shift_s])
    block = replace(sensor.block, time_s=time_s)
    before = tuple(one for one in restarts if one.at < at)
    later = tuple(replace(one, at=one.at - at) for one in restarts if one.at > at)
    first = replace(sensor, block=block.select(slice(0, at)), restarts=before) if at else None
    second = replace(sensor, block=block.select(slice(at, None)), restarts=later) if at < len(time_s) else None
    return first, second


def _breaks(sensor: ImportedSensor) -> list[ClockBreak]:
    return [ClockBreak(ClockEventKind.RESTART, one.at, one.shift_s, -one.shift_s) for one in sensor.restarts]


def _in_pause(times_s: list[FloatArray], at_s: float) -> float:
    """The middle of the pause that the time is in or at an end of; else the time."""
    for begin_s, end_s in pauses_among(times_s):
        if begin_s - TOGETHER_S <= at_s <= end_s + TOGETHER_S:
            return (begin_s + end_s) / 2.0
    return at_s


def _on_own_clock(sensor: ImportedSensor) -> ImportedSensor:
    return replace(sensor, info=replace(sensor.info, clock=sensor.name))


def _later(started: str, by_s: float) -> str:
    try:
        return (datetime.datetime.fromisoformat(started) + datetime.timedelta(seconds=by_s)).isoformat()
    except (ValueError, OverflowError):
        return ""
