"""XDF files of LabRecorder: streams of Lab Streaming Layer with acceleration and angular rates, see `named_columns`.

A stream is a sensor, or several side by side, by the labels and units of its channels. Its stamps are put to the clock
of the recording computer. Senders stamp when a packet comes, so stamps jump where packets were late; they are then put
on one straight line through the stamps, and samples that are missing for good remain a gap in it.

Not held against a recording of LabRecorder: against files that are laid out here as the format's description says.
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from core.findings import Finding, Severity
from core.samples import FloatArray
from devices.files.column_names import XYZ, listed, sensor_columns
from devices.files.named_columns import trial_of_tables
from devices.files.named_table import NamedTable
from devices.files.refusal import FileRefusedError
from devices.files.trial import ImportedTrial
from devices.files.xdf_streams import SIGNATURE, XdfStream, read_xdf
from devices.live import SourceRefusedError
from devices.lsl import sensors_of

LABEL_THEM = (
    "Label the channels acc_x to acc_z and gyr_x to gyr_z with their units where they are sent, both in one stream"
)
EVEN = 0.25  # of a step: stamps nearer to whole steps were made by the sensor's own clock
MOST_UNEVEN = 0.02  # of the samples
LATE_S = 2.0  # so long a packet may be late; what is missing for longer was lost
LEAST_LOSS_S = 0.03  # packets are not more punctual


@dataclass(frozen=True, slots=True)
class StraightTimes:
    """Times on a straight line, and by how much nine tenths of the stamps were away from it at most."""

    time_s: FloatArray
    away_s: float
    least_loss_s: float


def is_xdf(_path: Path, head: bytes) -> bool:
    """Whether a file that begins so is XDF."""
    return head.startswith(SIGNATURE)


def xdf_trial(files: Sequence[Path], rate_hz: float | None = None) -> ImportedTrial:
    """The sensors of one trial, in one file or in several.

    Parameters
    ----------
    rate_hz
        Samples per second, which the stamps are held to.

    Raises
    ------
    FileRefusedError
        What `xdf_streams` and `named_columns` refuse of the only file, and one without a stream of a sensor.
    """
    started: list[str] = []
    trial = trial_of_tables("xdf", files, lambda path: _tables(path, started), rate_hz)
    return replace(trial, started=min(filter(None, started), default=""))


def _tables(path: Path, started: list[str]) -> Sequence[NamedTable]:
    recording = read_xdf(path)
    started.append(recording.started)
    found = [one for one in recording.streams if len(one.stamp_s) and sensor_columns(list(_columns(one)[0]))]
    others = [one.name for one in recording.streams if one not in found] + list(recording.others)
    if not found:
        raise FileRefusedError(
            path.name,
            "no stream in it has acceleration and angular rates about three axes each. Streams there are: {names}",
            LABEL_THEM,
            names=listed(others) or "-",
        )
    start_s = min(float(np.min(one.stamp_s)) for one in found)
    is_of_several = len({one.host for one in found}) > 1
    names = [one.name for one in found]
    return [
        _table(
            path,
            one,
            one.name if names.count(one.name) == 1 and one.name else f"{one.name} {one.source or number}".strip(),
            others,
            start_s,
            is_of_several and not one.has_clock,
        )
        for number, one in enumerate(found, start=1)
    ]


def _table(
    path: Path, stream: XdfStream, called: str, others: Sequence[str], start_s: float, is_clock_missing: bool
) -> NamedTable:
    columns, units, left_out = _columns(stream)
    time_s = stream.stamp_s - start_s
    findings = []
    if not stream.is_whole:
        findings.append(Finding("stream_not_ended", Severity.WARNING, ""))
    if is_clock_missing:
        findings.append(Finding("clock_not_measured", Severity.WARNING, "", {"host": stream.host or "?"}))
    straight = straight_times(time_s, stream.rate_hz) if stream.rate_hz is not None else None
    if straight is not None:
        time_s = straight.time_s
        numbers = {"away_ms": 1e3 * straight.away_s, "loss_ms": 1e3 * straight.least_loss_s}
        findings.append(Finding("times_straightened", Severity.WARNING, "", numbers))
    return NamedTable(
        columns=columns,
        where=path.name,
        file=str(path),
        called=called,
        place=lambda row: f"{called}, sample {row + 1}",
        units=units,
        time_s=time_s,
        left_out=[*left_out, *others],
        findings=findings,
    )


def _columns(stream: XdfStream) -> tuple[dict[str, FloatArray], dict[str, str], list[str]]:
    """Channels by their labels, their units, and the labels that are left out because several channels have them.

    Where labels alone name no sensor it is one by the rules by which a stream is heard live: of a Shimmer's two
    accelerometers the wide one. Its channels are called by their quantities then.
    """
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


def straight_times(stamp_s: FloatArray, rate_hz: float) -> StraightTimes | None:
    """Times on a straight line through stamps that came with packets, with gaps where samples were lost.

    A packet that comes late is followed by others in time; after a loss all are late. So a loss is where the least
    delay of the samples after it is above that of those before.

    Parameters
    ----------
    stamp_s : (n,)
        Finite, else they are left as they are.
    rate_hz
        As the sender tells it.

    Returns
    -------
    StraightTimes or None
        None: the stamps are even as they are, or too few to tell.
    """
    window = max(round(LATE_S * rate_hz), 4)
    if len(stamp_s) <= 2 * window or not np.isfinite(stamp_s).all():
        return None
    steps = np.diff(stamp_s) * rate_hz
    whole = np.maximum(np.round(steps), 1.0)
    if (steps > 0).all() and np.mean(np.abs(steps - whole) > EVEN) <= MOST_UNEVEN:
        return None
    step_s = float(np.median(stamp_s[window:] - stamp_s[:-window])) / window
    if not step_s > 0.0:
        return None
    count = np.arange(len(stamp_s), dtype=np.float64)
    least_loss_s = max(1.5 * step_s, LEAST_LOSS_S)
    delay_s = stamp_s - count * step_s
    for at in np.flatnonzero(np.diff(stamp_s) > least_loss_s) + 1:
        before, after = delay_s[max(at - window, 0) : at], delay_s[at : at + window]
        late_s = float(after.min() - before.min())
        if late_s > least_loss_s:
            lost = max(round(late_s / step_s), 1)
            count[at:] += lost
            delay_s[at:] -= lost * step_s
    slope_s, first_s = np.polynomial.polynomial.polyfit(count - count.mean(), stamp_s, 1)[::-1]
    if not slope_s > 0.0:
        return None
    time_s = first_s + slope_s * (count - count.mean())
    return StraightTimes(time_s, float(np.quantile(np.abs(stamp_s - time_s), 0.9)), least_loss_s)
