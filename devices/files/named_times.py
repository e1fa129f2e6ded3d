"""The times of the samples of a table of no particular program: by its stamps, by a counter or by a rate alone.

A unit that no name contains is found by the rates that sensors have, where these leave one answer only.
"""

from dataclasses import dataclass

import numpy as np

from core.findings import Finding, Severity
from core.samples import BoolArray, FloatArray
from devices.files.clock_repair import FileClock, RepairedClock, repaired
from devices.files.column_names import SECONDS, Quantity, SensorColumns, meaning_of, unit_of
from devices.files.named_table import NamedTable
from devices.files.refusal import FileRefusedError, plain, quoted
from devices.files.straight_times import LATE_S, straight_times
from devices.files.table_choices import COUNT

LIKELY_HZ = (20.0, 2000.0)  # rates by which a unit of time is found: no two of these leave the same steps
OF_CLOCKS = ("s", "ms", "us", "ns", "d")
POSSIBLE_HZ = (1.0, 20_000.0)
WRAPS = tuple(float(1 << bits) for bits in (8, 16, 24, 32))
MOST_DOUBLED = 0.2  # of the samples: beyond, samples come in batches that share a stamp
MOST_COARSE_S = 0.1  # by which stamps of batches may be off
BATCH_LATE_S = 0.2  # of a recording: packets are not later than that, in a short one
USUAL_COUNT = 1.2  # counts between samples; a counter of other packets too has 1.5 and more
LOST_TOGETHER = 0.02  # of the steps: where a fifth is lost by chance, 4 % of the steps are of three and more


@dataclass(frozen=True, slots=True)
class Stamps:
    """Seconds of the samples that are new; which of all samples those are; what the times were found by."""

    time_s: FloatArray
    is_new: BoolArray
    rate_hz: float | None
    reported: str


def stamps_of(
    table: NamedTable, named: SensorColumns, asked_hz: float | None, is_there: BoolArray, findings: list[Finding]
) -> Stamps:
    """Give the times of rows that `is_there` (n,), noting guesses; raises FileRefusedError without any."""
    reported_hz = _one_rate(table, asked_hz)
    rows = np.flatnonzero(is_there)
    if table.time_s is not None:
        values, scale, reported = _unwrapped(table, table.time_s[rows], rows, table.time), 1.0, f"{table.time} [s]"
    elif named.time and len(table.columns[named.time]) == len(is_there):
        values = _unwrapped(table, table.columns[named.time][rows], rows, named.time)
        meaning = meaning_of(named.time, table.units.get(named.time, ""))
        of_name = meaning.unit if meaning and meaning.unit in SECONDS else ""  # another quantity's may be stated
        stated = unit_of(Quantity.TIME, table.units.get(named.time, "")) or of_name
        stated = COUNT if table.units.get(named.time) == COUNT else stated
        unit = _time_unit(table, named.time, stated, values, reported_hz, findings)
        if unit == COUNT:
            scale, reported = 1.0 / _required(table, reported_hz), named.time
        else:
            scale, reported = SECONDS[unit], f"{named.time} [{unit}]"
    elif named.counter and reported_hz is not None and len(table.columns[named.counter]) == len(is_there):
        values, scale, reported = (
            _unwrapped(table, table.columns[named.counter][rows], rows, named.counter),
            1.0 / reported_hz,
            f"{named.counter} / {reported_hz:g} Hz",
        )
        _refuse_other_packets(table, values, named.counter)
    else:
        scale = 1.0 / _required(table, reported_hz)
        values, reported = rows.astype(float), f"{1.0 / scale:g} Hz"
        findings.append(Finding("time_from_rate", Severity.WARNING, "", {"rate_hz": 1.0 / scale}))
    name = quoted(named.time or named.counter) if table.time_s is None else quoted(table.time)
    clock = repaired(values, FileClock(table.where, lambda row: table.place(int(rows[row])), name, scale))
    if clock.doubled > MOST_DOUBLED * len(values):
        return _spread(table, clock, scale, reported_hz, reported, findings)
    findings += clock.findings
    time_s = clock.stamps[clock.is_new] * scale
    return Stamps(time_s, clock.is_new, _checked_rate(table, time_s, reported_hz), reported)


def _spread(
    table: NamedTable,
    clock: RepairedClock,
    scale: float,
    reported_hz: float | None,
    reported: str,
    findings: list[Finding],
) -> Stamps:
    """Even times of samples that share their stamps in batches; raises FileRefusedError where stamps are too coarse."""
    is_there: BoolArray = np.isfinite(clock.stamps)
    stamp_s = clock.stamps[is_there] * scale
    length_s = float(stamp_s[-1] - stamp_s[0])
    straight = None
    if length_s > 0.0:
        straight = straight_times(stamp_s, len(stamp_s) / length_s, min(LATE_S, BATCH_LATE_S * length_s))
    if straight is None or straight.away_s > MOST_COARSE_S:
        raise FileRefusedError(
            table.where,
            "{doubled} of {count} samples have the same time as the sample before",
            "Export the times with more digits",
            count=len(clock.stamps),
            doubled=clock.doubled,
        )
    numbers = {
        "count": round(len(stamp_s) / len(np.unique(stamp_s)), 1),
        "away_ms": round(1e3 * straight.away_s, 1),
        "loss_ms": round(1e3 * straight.least_loss_s, 1),
    }
    findings.append(Finding("stamps_spread", Severity.WARNING, "", numbers))
    findings += [one for one in clock.findings if one.key != "doubled_stamps"]
    rate_hz = _checked_rate(table, straight.time_s, reported_hz)
    return Stamps(straight.time_s, is_there, rate_hz, reported)


def _required(table: NamedTable, rate_hz: float | None) -> float:
    """The rate, without which the samples have no times."""
    if rate_hz is None:
        raise FileRefusedError(
            table.where,
            "the samples in the file have no times",
            "Add a column time_s, time_ms or time_us, or give the sampling rate (--rate)",
        )
    return rate_hz


def _refuse_other_packets(table: NamedTable, counts: FloatArray, name: str) -> None:
    """Refuse a counter that rises by more than the samples: what is lost and what is another packet look alike."""
    steps = np.diff(counts)
    rises = float(steps.mean()) if len(steps) else 1.0
    if rises > USUAL_COUNT and float(np.mean(steps > 2.0)) < LOST_TOGETHER:
        raise FileRefusedError(
            table.where,
            "{name} rises by {rises} for each sample: it counts other packets too, or samples are lost",
            "Export the times of the samples; if no sample was lost, use no times (--time none) and a rate (--rate)",
            name=quoted(name),
            rises=f"{rises:.2f}",
        )


def _one_rate(table: NamedTable, asked_hz: float | None) -> float | None:
    reported_hz = table.rate_hz
    if asked_hz is not None and reported_hz is not None and abs(asked_hz - reported_hz) > 0.02 * asked_hz:
        raise FileRefusedError(
            table.where,
            "the file gives {reported} samples per second, but --rate {asked}",
            "Give the recording rate, or leave out --rate",
            reported=f"{reported_hz:g}",
            asked=f"{asked_hz:g}",
        )
    return asked_hz or reported_hz


def _checked_rate(table: NamedTable, time_s: FloatArray, reported_hz: float | None) -> float | None:
    """Samples per second by the stamps, which have to be near the rate that is given."""
    if len(time_s) < 2:
        return reported_hz
    step_s = np.diff(time_s)
    found_hz = 1.0 / float(np.mean(step_s[step_s < 1.5 * np.median(step_s)]))  # stamps may be rounded, and have gaps
    least, most = POSSIBLE_HZ
    if not least < found_hz < most or (reported_hz is not None and abs(found_hz - reported_hz) > 0.05 * reported_hz):
        raise FileRefusedError(
            table.where,
            "the times in the file give {found} samples per second, expected {reported}",
            "Name the time column with its unit, such as time_ms, or correct the rate",
            found=plain(found_hz, 4),
            reported=f"{least:g} to {most:g}" if reported_hz is None else f"{reported_hz:g}",
        )
    return round(found_hz, 1)


def _unwrapped(
    table: NamedTable, values: FloatArray, rows: np.ndarray[tuple[int], np.dtype[np.intp]], name: str
) -> FloatArray:
    """(n,) stamps or counts without their turns."""
    missing = np.flatnonzero(~np.isfinite(values))
    if len(missing):
        raise FileRefusedError(
            f"{table.where}, {table.place(int(rows[missing[0]]))}",
            "a sample has no time in column {name}",
            "Correct the file or export it again",
            name=quoted(name),
        )
    step = np.diff(values)
    back = step < 0
    if back.any():
        usual = float(np.median(step[~back])) if (~back).any() else 0.0
        for turn in WRAPS:
            turned = step + turn
            is_turn = (values[1:][back] < 0.1 * turn) & (values[:-1][back] > 0.9 * turn)
            if values.max() < turn and is_turn.all() and (turned[back] <= max(100.0 * usual, 1.0)).all():
                return np.concatenate([values[:1], values[0] + np.cumsum(np.where(back, turned, step))])
    return values


def _time_unit(
    table: NamedTable, name: str, reported: str, values: FloatArray, reported_hz: float | None, findings: list[Finding]
) -> str:
    """A unit of time, or COUNT where samples are counted."""
    step = np.diff(values)
    usual = float(np.median(step[step > 0])) if (step > 0).any() else np.nan
    if len(step) and float(np.mean(step == 0)) > MOST_DOUBLED:
        usual = max(float(values[-1] - values[0]), 0.0) / len(step) or np.nan  # samples of a batch share a stamp
    if reported or not np.isfinite(usual):
        return reported or "s"
    if reported_hz is not None:
        fits = [unit for unit, scale in SECONDS.items() if abs(usual * scale * reported_hz - 1.0) < 0.05]
        fits = fits or ([COUNT] if usual == 1.0 else [])
    else:
        least, most = LIKELY_HZ
        fits = [unit for unit in OF_CLOCKS if least <= 1.0 / (usual * SECONDS[unit]) <= most]
        fits = [] if usual == 1.0 else fits  # it may be a count, and it may be milliseconds
    if not fits:
        raise FileRefusedError(
            table.where,
            "the unit of {name} is unclear; its step between samples is {step}",
            "Name the column with its unit, such as time_s, time_ms or time_us, or give the sampling rate (--rate)",
            name=quoted(name),
            step=f"{usual:.6g}",
        )
    if fits[0] != COUNT:
        findings.append(Finding("unit_by_size", Severity.INFO, "", {"names": name, "unit": fits[0]}))
    return fits[0]
