"""XDF files of LabRecorder: streams of Lab Streaming Layer with acceleration and angular rates, see `named_columns`.

A stream is a sensor, or several side by side, by the labels and units of its channels. Its stamps are put to the clock
of the recording computer. Senders stamp when a packet comes, so stamps jump where packets were late; they are then put
on one straight line through the stamps, and samples that are missing for good remain a gap in it.

Not held against a recording of LabRecorder: against files that are laid out here as the format's description states.
"""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from core.findings import Finding, Severity
from core.samples import FloatArray
from devices.drivers.lsl import sensors_of
from devices.files.clock_repair import FileClock, continued, repaired
from devices.files.column_names import XYZ, listed, sensor_columns
from devices.files.named_columns import trial_of_tables
from devices.files.named_table import NamedTable
from devices.files.own_clocks import from_zero
from devices.files.refusal import FileRefusedError, plain
from devices.files.straight_times import LATE_S, StraightTimes, lasting_step_back, straight_times
from devices.files.trial import ImportedSensor, ImportedTrial
from devices.files.xdf_streams import SIGNATURE, XdfStream, read_xdf
from devices.live import SourceRefusedError

NOT_MEASURED = "clock_not_measured"
LABEL_THEM = (
    "In the sending program, label the channels acc_x to acc_z and gyr_x to gyr_z with units, all in one stream"
)
MOST_OFF_RATE = 0.02  # of what the sender reports; clocks of sensors are off by a thousandth of that
SEND_RATE = "Set the sender to give its sample rate, or to send the sensor's own times"


def is_xdf(_path: Path, head: bytes) -> bool:
    """Whether a file that begins so is XDF."""
    return head.startswith(SIGNATURE)


def xdf_trial(files: Sequence[Path], rate_hz: float | None = None) -> ImportedTrial:
    """Read one trial's sensors, stamps held to the rate; raises FileRefusedError if the only file is refused."""
    started: list[str] = []
    trial = trial_of_tables("xdf", lambda path: _tables(path, started), files, rate_hz)
    sensors = tuple(_on_own_clocks(trial.sensors))
    return replace(trial, sensors=sensors, started=min(filter(None, started), default=""))


def _on_own_clocks(sensors: Sequence[ImportedSensor]) -> Iterator[ImportedSensor]:
    """Sensors of computers whose clocks were not measured begin with the others, each computer's on its own clock."""
    host = {
        one.name: str(finding.numbers["host"])
        for one in sensors
        for finding in one.findings
        if finding.key == NOT_MEASURED
    }
    zeroed = {
        one.name: one
        for clock in {host.get(one.name) for one in sensors}
        for one in from_zero([one for one in sensors if host.get(one.name) == clock])
    }
    for one in sensors:
        info = replace(one.info, clock=host.get(one.name, one.info.clock))
        yield replace(zeroed[one.name], info=info)


def _tables(path: Path, started: list[str]) -> Sequence[NamedTable]:
    recording = read_xdf(path)
    started.append(recording.started)
    found = [one for one in recording.streams if len(one.stamp_s) and sensor_columns(list(_columns(one)[0]))]
    others = [one.name for one in recording.streams if one not in found] + list(recording.others)
    if not found:
        raise FileRefusedError(
            path.name,
            "no stream has acceleration and angular rates on three axes each. Available streams: {names}",
            LABEL_THEM,
            names=listed(others) or "-",
        )
    start_s = min(float(np.min(one.stamp_s)) for one in found)
    is_of_several = len({one.host for one in found}) > 1
    called = _called(found)
    return [
        _table(
            path,
            one,
            name,
            others,
            start_s,
            is_of_several and not one.has_clock,
        )
        for one, name in zip(found, called, strict=True)
    ]


def _called(streams: Sequence[XdfStream]) -> list[str]:
    """A name for each stream, of its own: with its source, or its number where that is another's, too."""
    names = [one.name for one in streams]
    is_known = [one.name != "" and names.count(one.name) == 1 for one in streams]
    called = [
        one.name if known else f"{one.name} {one.source}".strip() for one, known in zip(streams, is_known, strict=True)
    ]
    return [
        name if name and called.count(name) == 1 else f"{one.name} {number}".strip()
        for number, (one, name) in enumerate(zip(streams, called, strict=True), start=1)
    ]


def _table(
    path: Path, stream: XdfStream, called: str, others: Sequence[str], start_s: float, is_clock_missing: bool
) -> NamedTable:
    findings = []
    if not stream.is_whole:
        findings.append(Finding("stream_not_ended", Severity.WARNING, ""))
    if is_clock_missing:
        findings.append(Finding(NOT_MEASURED, Severity.WARNING, "", {"host": stream.host or "?"}))
    clock = FileClock(path.name, lambda row: f"{called}, sample {row + 1}", '"time"')
    time_s = stream.stamp_s - start_s
    if stream.rate_hz is not None:
        step_s = 1.0 / stream.rate_hz
        mended = repaired(time_s, clock, slack=LATE_S, step=step_s)
        is_there = np.isfinite(mended.stamps)
        time_s, stream = mended.stamps[is_there], replace(stream, samples=stream.samples[is_there])
        findings += mended.findings
        time_s, restarted = continued(time_s, clock, partial(lasting_step_back, rate_hz=1.0 / step_s), step_s)
        findings += restarted
        straight = _straightened(time_s, 1.0 / step_s, clock)
        if straight is not None:
            time_s = straight.time_s
            numbers = {"away_ms": 1e3 * straight.away_s, "loss_ms": 1e3 * straight.least_loss_s}
            findings.append(Finding("times_straightened", Severity.WARNING, "", numbers))
    columns, units, left_out = _columns(stream)
    return NamedTable(
        columns=columns,
        where=path.name,
        file=str(path),
        called=called,
        place=clock.place,
        units=units,
        time_s=time_s,
        left_out=[*left_out, *others],
        findings=findings,
    )


def _columns(stream: XdfStream) -> tuple[dict[str, FloatArray], dict[str, str], list[str]]:
    """Channels by their labels, their units, and labels left out because several channels have them."""
    # labels that name no sensor are read as of a live stream: of a Shimmer's two accelerometers the wide one, channels
    # called by their quantities
    labels = list(stream.labels)[: stream.samples.shape[1]]
    numbers = {label: number for number, label in enumerate(labels) if label and labels.count(label) == 1}
    if not sensor_columns(list(numbers)) and len(numbers) == len(labels):
        with suppress(SourceRefusedError):
            numbers = {
                f"{sensor.name}_{quantity}_{axis}": number
                for sensor in sensors_of(stream.name, labels, stream.units)
                for quantity, three in (("acc", sensor.force), ("gyr", sensor.rate))
                for axis, number in zip(XYZ, three, strict=True)
            }
    columns = {name: stream.samples[:, number] for name, number in numbers.items()}
    units = {name: stream.units[number] for name, number in numbers.items() if stream.units[number]}
    taken = set(numbers.values())
    left_out = [label for number, label in enumerate(labels) if label and number not in taken]
    return columns, units, list(dict.fromkeys(left_out))


def _straightened(stamp_s: FloatArray, rate_hz: float, clock: FileClock) -> StraightTimes | None:
    """Straight times, where the stamps need them and the line has the rate that the sender reports."""
    straight = straight_times(stamp_s, rate_hz)
    if straight is not None and abs(straight.rate_hz / rate_hz - 1.0) > MOST_OFF_RATE:
        raise FileRefusedError(
            f"{clock.where}, {clock.place(0).partition(',')[0]}",
            "the times in the file give {found} samples per second, expected {reported}",
            SEND_RATE,
            found=plain(straight.rate_hz, 4),
            reported=f"{rate_hz:g}",
        )
    return straight
