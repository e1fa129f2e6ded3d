"""Quality of the samples: every recording is looked at before anything is computed from it."""

from dataclasses import dataclass

import numpy as np

from core.body import LEG_JOINTS, Site
from core.calibration.rest import rest_of
from core.clock_jumps import jump_of, spans_of
from core.findings import Finding, Severity
from core.handedness import Turn, reversed_sites, turn_about_vertical
from core.pair import moving_mean
from core.samples import BoolArray, FloatArray, ImuBlock, IntArray, Recording, RecordingKind, Session
from core.tracks import (
    MAX_REPORTED_GAP_S,
    MIN_STRETCH_S,
    MIN_STRETCH_SAMPLES,
    in_every_column,
    is_heard,
    is_possible,
    is_stuck,
    nominal_step_s,
)

MIN_LOSS_PERCENT = 0.5  # told from here on
GRAVE_LOSS_PERCENT = 20.0
GRAVITY_RANGE_G = (0.7, 1.4)  # median specific force of a sensor that reports g
PLAUSIBLE_M_S2 = (5.0, 20.0)
PLAUSIBLE_RAD_S = 35.0  # 2000 deg/s, the range of the sensors; a walking shank reaches 8
LARGE = 1e6
LOOKED_AT_ROWS = 6000  # units show in so many rows as in all
STEPS_TOGETHER, STEPS_BESIDE = 30, 5
SHORT_STEP, MIN_SHORT_STEPS = 0.7, 0.005  # of the usual step; of all steps, where stamps jitter
MIN_RATE_HZ = 25.0  # below, a swing is a handful of samples
COMPARED_ROWS = 2000
ROW_FACTORS = 1_000_003 ** np.arange(1, 7)  # two rows hardly ever make one number
MIN_DISTINCT = 0.8  # share of rows that are unlike all others: a finer sensor than that never repeats itself by chance
MOVING_RAD_S = 0.5
CLIPPED_RUN = 3  # equal extreme values in a row
MIN_CLIPPED = 6  # samples: what happens once is chance
CLIPPED_STEPS = 5  # of the sensor's least steps: noise goes on by one or two
CLIPPED_BEYOND_M_S2, CLIPPED_BEYOND_RAD_S = 14.7, 1.5  # 1.5 g; the narrowest ranges are 2 g and 125 deg/s
MIN_CLIPPED_PERCENT = 0.05
CLOCK_OFFSET_S = 5.0
CLOCK_AGREEMENT_S = 1.0
CLOCK_GRID_S = 0.1
MIN_LIKENESS = 0.3  # correlation of how much two sites move, as stamped
MIN_STEP_NOT_S, MIN_STEP_US = 0.4, 400.0  # steps of what cannot be seconds: milliseconds, from here on microseconds


@dataclass(frozen=True, slots=True)
class Quality:
    """Findings, and which sites of which recordings cannot be used at all."""

    findings: tuple[Finding, ...]
    unusable: frozenset[tuple[str, Site]]


def look_at(session: Session) -> Quality:
    """Look at every kept recording."""
    findings: list[Finding] = []
    unusable: set[tuple[str, Site]] = set()
    worn: dict[tuple[str, Site], str] = {}
    reversed_sensors: set[tuple[Site, str]] = set()
    for recording in session.recordings:
        if not recording.is_kept:
            findings.append(Finding("recording_discarded", Severity.INFO, recording.name))
            continue
        turns: dict[Site, Turn] = {}
        for site, block in recording.imu.items():
            worn[recording.name, site] = block.sensor
            where = f"{recording.name}, {site}"
            about = [
                Finding(key, severity, where, numbers) for key, severity, numbers in _about_block(block, recording.kind)
            ]
            findings += about
            if any(found.severity is Severity.GRAVE for found in about):
                unusable.add((recording.name, site))
            elif recording.kind is not RecordingKind.STANDING:
                turns[site] = turn_about_vertical(block)
        for sites, found in [*_same_data(recording), *_clock_offsets(recording), *_clock_jumps(recording)]:
            findings.append(found)
            unusable.update((recording.name, site) for site in sites)
        for sites in reversed_sites(turns):
            if not any((recording.name, site) in unusable for site in sites):
                where = ", ".join((recording.name, *sites))
                findings.append(Finding("acc_reversed", Severity.GRAVE, where))
                reversed_sensors.update((site, worn[recording.name, site]) for site in sites)
    # a sensor that is so once was so all the time, whether it turned far enough to show it or not
    unusable.update(key for key, sensor in worn.items() if (key[1], sensor) in reversed_sensors)
    findings.extend(_missing_sites(session))
    return Quality(tuple(findings), frozenset(unusable))


About = tuple[str, Severity, dict[str, float | int | str]]


def _about_block(block: ImuBlock, kind: RecordingKind) -> list[About]:
    is_there = in_every_column(np.isfinite(block.gyr_rad_s)) & in_every_column(np.isfinite(block.acc_m_s2))
    there = int(np.count_nonzero(is_there))
    if there < MIN_STRETCH_SAMPLES or np.ptp(block.time_s[is_there]) < MIN_STRETCH_S:
        return [("too_few_samples", Severity.GRAVE, {"samples": there})]
    step_s = nominal_step_s(block.time_s[is_there])
    if step_s >= MIN_STEP_NOT_S:
        unit = "ms" if step_s < MIN_STEP_US else "µs"
        return [("time_in_ms", Severity.GRAVE, {"unit": unit, "step": round(step_s, 1)})]
    wrong = _about_units(block, is_there, kind)
    if wrong:
        return wrong
    possible = is_possible(block.gyr_rad_s, block.acc_m_s2)
    is_held = is_stuck(block.time_s, block.gyr_rad_s, block.acc_m_s2)
    heard = possible & ~is_held
    heard[1:] &= np.diff(block.time_s) > 0
    about: list[About] = []
    impossible = int(np.count_nonzero(is_there & ~possible))
    if impossible:
        about.append(("impossible_values", Severity.WARNING, {"count": impossible}))
    stuck = 100 * float(np.mean(is_held))
    if np.count_nonzero(heard) < MIN_STRETCH_SAMPLES or np.ptp(block.time_s[heard]) < MIN_STRETCH_S:
        return [*about, ("stuck_throughout", Severity.GRAVE, {})]
    if stuck > 0.0:
        about.append(("stuck", Severity.WARNING, {"percent": round(stuck, 1)}))
    step_s = nominal_step_s(block.time_s[heard])
    about += _about_gaps(block, block.time_s[heard], step_s)
    rate_hz = 1 / step_s
    if rate_hz < MIN_RATE_HZ:
        about.append(("low_rate", Severity.WARNING, {"rate_hz": round(rate_hz, 1)}))
    clipped = max(
        _clipped_percent(block.acc_m_s2[heard], CLIPPED_BEYOND_M_S2),
        _clipped_percent(block.gyr_rad_s[heard], CLIPPED_BEYOND_RAD_S),
    )
    if clipped > MIN_CLIPPED_PERCENT and kind is not RecordingKind.STANDING:
        about.append(("clipped", Severity.WARNING, {"percent": round(clipped, 2)}))
    if kind is RecordingKind.STANDING and rest_of(block) is None:
        about.append(("moved_while_standing", Severity.WARNING, {}))
    return about


def _about_units(block: ImuBlock, is_there: BoolArray, kind: RecordingKind) -> list[About]:
    """What makes a sensor unusable as a whole: no signal, or units that its magnitudes betray."""
    about: list[About] = []
    # no figure that a sensor could mean is cut off here, and none is so large that its square overflows
    gyr, acc = block.gyr_rad_s[is_there], block.acc_m_s2[is_there]
    some = slice(None, None, max(1, len(gyr) // LOOKED_AT_ROWS))
    force, rate = (_lengths(np.clip(v[some], -LARGE, LARGE)) for v in (acc, gyr))
    median_force, high_rate = float(np.median(force)), float(np.quantile(rate, 0.99))
    is_gyro_dead = bool(np.all(gyr == gyr[0])) and kind is not RecordingKind.STANDING
    if not np.any(acc) or (is_gyro_dead and not np.any(gyr)):
        about.append(("all_zero", Severity.GRAVE, {}))
    elif is_gyro_dead:
        about.append(("stuck_throughout", Severity.GRAVE, {}))
    elif GRAVITY_RANGE_G[0] < median_force < GRAVITY_RANGE_G[1]:
        about.append(("acc_in_g", Severity.GRAVE, {"median_m_s2": round(median_force, 2)}))
    elif not PLAUSIBLE_M_S2[0] < median_force < PLAUSIBLE_M_S2[1]:
        about.append(("acc_implausible", Severity.GRAVE, {"median_m_s2": round(median_force, 2)}))
    if high_rate > PLAUSIBLE_RAD_S:
        about.append(("rate_in_deg_s", Severity.GRAVE, {"p99_rad_s": round(high_rate, 1)}))
    return about


def _lengths(vectors: FloatArray) -> FloatArray:
    """Of vectors (n, 3), in double precision; NumPy's own is several times slower along so short an axis."""
    return np.sqrt(np.einsum("ni,ni->n", vectors, vectors, dtype=np.float64))


def lost_percent(block: ImuBlock) -> float:
    """How many of a sensor's samples are missing, to its own rate; 100 where next to none was heard.

    Returns
    -------
    float
        Percent.
    """
    heard_s = block.time_s[is_heard(block.time_s, block.gyr_rad_s, block.acc_m_s2)]
    return _missing_percent(block, heard_s, nominal_step_s(heard_s)) if len(heard_s) >= MIN_STRETCH_SAMPLES else 100.0


def _missing_percent(block: ImuBlock, heard_s: FloatArray, step_s: float) -> float:
    missing = float(np.sum(_missing_rows(heard_s, step_s)))
    missing += float(np.count_nonzero(block.time_s < heard_s[0]) + np.count_nonzero(block.time_s > heard_s[-1]))
    return 100 * missing / (missing + len(heard_s))


def _missing_rows(heard_s: FloatArray, step_s: float) -> FloatArray:
    """How many samples lack after each but the last (n - 1,).

    Where stamps jitter, which shows in short steps, a long step between short ones lacks nothing: as many samples must
    be missing around it, by a step that many steps tell.
    """
    steps = np.diff(heard_s)
    if len(steps) <= STEPS_TOGETHER or np.mean(steps < SHORT_STEP * step_s) < MIN_SHORT_STEPS:
        return np.asarray(np.maximum(np.round(steps / step_s) - 1, 0))
    together_s = (heard_s[STEPS_TOGETHER:] - heard_s[:-STEPS_TOGETHER]) / STEPS_TOGETHER
    step_s = float(np.quantile(together_s, 0.1))
    index = np.arange(len(steps))
    first, last = np.maximum(index - STEPS_BESIDE, 0), np.minimum(index + STEPS_BESIDE + 1, len(steps))
    around = np.floor((heard_s[last] - heard_s[first]) / step_s - (last - first) + 0.3)
    return np.asarray(np.clip(np.round(steps / step_s) - 1, 0, np.maximum(around, 0)))


def _about_gaps(block: ImuBlock, heard_s: FloatArray, step_s: float) -> list[About]:
    steps = np.diff(heard_s)
    percent = _missing_percent(block, heard_s, step_s)
    longest_s = float(np.max(steps))
    count = int(np.count_nonzero(steps > max(MAX_REPORTED_GAP_S, 1.5 * step_s)))
    if percent < MIN_LOSS_PERCENT and count == 0:
        return []
    is_grave = percent >= GRAVE_LOSS_PERCENT
    if count == 0 and not is_grave:
        return [("bridged", Severity.INFO, {"missing_percent": round(percent, 1)})]
    numbers: dict[str, float | int | str] = {
        "count": count,
        "missing_percent": round(percent, 1),
        "longest_s": round(longest_s, 3),
    }
    # told as a warning in either case: what was heard is still used
    return [("many_gaps" if is_grave else "gaps", Severity.WARNING, numbers)]


def _clipped_percent(values: FloatArray, beyond: float) -> float:
    """How much of the worst column of (n, 3) lies at the end of the sensor's range.

    There a signal stays for some samples, farther from zero than any rest (`beyond`), and would have gone on by the
    slope with which it came or left. A coarse sensor repeats its extremes as well: where the signal turns.
    """
    worst = 0.0
    for v in (side for column in values.T for side in (column, -column)):
        limit = float(v.max())
        if limit <= beyond or np.count_nonzero(v == limit) < CLIPPED_RUN:
            continue
        steps = np.abs(np.diff(v))
        edges = np.flatnonzero(np.diff(np.concatenate([[0], (v == limit).astype(np.int8), [0]])))
        runs = [(int(i), int(j)) for i, j in zip(edges[::2], edges[1::2], strict=True) if j - i >= CLIPPED_RUN]
        least = CLIPPED_STEPS * float(np.min(steps[steps > 0.0], initial=np.inf))
        clipped = sum(j - i for i, j in runs if _would_go_on(v, i, j, limit, least))
        if clipped >= MIN_CLIPPED:
            worst = max(worst, 100 * clipped / len(v))
    return worst


def _would_go_on(v: FloatArray, first: int, end: int, limit: float, least: float) -> bool:
    """Whether a signal comes and leaves by more than `least`, and one of both leads beyond more than flatness does."""
    sides = [(v[i], v[i] - v[k]) for i, k in ((first - 1, first - 2), (end, end + 1)) if 0 <= k < len(v)]
    farthest = max((limit - near for near, _ in sides), default=0.0)
    beyond = max((near + slope - limit for near, slope in sides), default=0.0)
    return beyond > max(least, 0.5 * farthest) and all(slope > least for _, slope in sides)


def _same_data(recording: Recording) -> list[tuple[tuple[Site, ...], Finding]]:
    """Two sensors never agree to the last digit, row for row, unless one is a copy of the other.

    At rest coarse ones do: of these, only rows in motion count.
    """
    found: list[tuple[tuple[Site, ...], Finding]] = []
    rows: dict[Site, IntArray] = {}
    for site, block in recording.imu.items():
        mine = rows[site] = _distinct_rows(block)
        for other, theirs in rows.items():
            shared = 0 if other is site else len(np.intersect1d(mine, theirs, assume_unique=True))
            if shared > 0.5 * max(min(len(mine), len(theirs)), MIN_STRETCH_SAMPLES):
                where = f"{recording.name}, {other}, {site}"
                found.append(((other, site), Finding("same_data", Severity.GRAVE, where)))
    return found


def _distinct_rows(block: ImuBlock) -> IntArray:
    """The first rows of a sensor's samples by which it can be told from another, each as one number."""
    first = slice(0, COMPARED_ROWS)
    signals = np.concatenate([block.gyr_rad_s[first], block.acc_m_s2[first]], axis=1).astype(np.float64)
    signals = signals[np.isfinite(signals).all(axis=1) & np.any(signals, axis=1)]
    rows = np.sum(signals.view(np.int64) * ROW_FACTORS, axis=1)  # wraps around, as it may
    distinct = np.unique(rows)
    if len(distinct) >= MIN_DISTINCT * len(signals):
        return distinct
    return np.unique(rows[np.linalg.norm(signals[:, :3], axis=1) > MOVING_RAD_S])


def _clock_offsets(recording: Recording) -> list[tuple[tuple[Site, ...], Finding]]:
    """A site whose start and end both lie equally far from the others' has a clock of its own."""
    spans = {s: (float(b.time_s[0]), float(b.time_s[-1])) for s, b in recording.imu.items() if len(b)}
    if len(spans) < 2:
        return []
    start, end = (float(np.median([span[k] for span in spans.values()])) for k in (0, 1))
    if len(spans) == 2:  # two clocks that disagree: the proximal one is taken as right
        start, end = next(iter(spans.values()))
    found: list[tuple[tuple[Site, ...], Finding]] = []
    for site, (first, last) in spans.items():
        offset_s = 0.5 * (first - start + last - end)
        is_shifted = abs(offset_s) > CLOCK_OFFSET_S and abs((last - end) - (first - start)) < CLOCK_AGREEMENT_S
        if is_shifted and not _moves_with_others(recording, site, offset_s):
            numbers = {"offset_s": round(offset_s, 1)}
            where = f"{recording.name}, {site}"
            found.append(((site,), Finding("clock_offset", Severity.GRAVE, where, numbers)))
    return found


def _clock_jumps(recording: Recording) -> list[tuple[tuple[Site, ...], Finding]]:
    spans = {site: spans_of(recording.imu[site].time_s) for site in recording.imu}
    found: list[tuple[tuple[Site, ...], Finding]] = []
    for site, own in spans.items():
        jump = jump_of(own, [other for at, other in spans.items() if at is not site and other])
        if jump is not None:
            numbers = {"jump_s": round(jump.by_s, 2), "after_s": round(jump.after_s, 2)}
            found.append(((site,), Finding("clock_jumps", Severity.GRAVE, f"{recording.name}, {site}", numbers)))
    return found


def _moves_with_others(recording: Recording, site: Site, offset_s: float) -> bool:
    """Whether a site moves when its neighbour does as both are stamped, more than it would without the offset.

    Sensors that were switched on and off one after the other are such.
    """
    for joint in LEG_JOINTS:
        if site in (joint.proximal, joint.distal) and recording.holds(joint.proximal, joint.distal):
            other = joint.distal if site is joint.proximal else joint.proximal
            as_stamped, shifted = (_likeness(recording.imu[site], recording.imu[other], by) for by in (0.0, offset_s))
            if as_stamped > max(shifted, MIN_LIKENESS):
                return True
    return False


def _likeness(one: ImuBlock, other: ImuBlock, late_s: float) -> float:
    """Correlation of how fast two sensors turn, `late_s` taken off the stamps of the first."""
    start_s = max(one.time_s[0] - late_s, other.time_s[0])
    grid_s = np.arange(start_s, min(one.time_s[-1] - late_s, other.time_s[-1]), CLOCK_GRID_S)
    if len(grid_s) < MIN_STRETCH_SAMPLES:
        return 0.0
    speeds = []
    for block, by_s in ((one, late_s), (other, 0.0)):
        speed = np.nan_to_num(np.linalg.norm(np.clip(block.gyr_rad_s, -LARGE, LARGE), axis=1))
        width = max(1, round(CLOCK_GRID_S / nominal_step_s(block.time_s)))
        speeds.append(np.interp(grid_s + by_s, block.time_s, moving_mean(speed, width)))
    if min(np.std(speed) for speed in speeds) == 0.0:
        return 0.0
    one_off, other_off = (speed - np.mean(speed) for speed in speeds)
    return float(np.mean(one_off * other_off) / (np.std(one_off) * np.std(other_off)))


def _missing_sites(session: Session) -> list[Finding]:
    """A neighbour without which a worn sensor gives no joint."""
    worn = {site for recording in session.recordings if recording.is_kept for site in recording.imu}
    findings = []
    for joint in LEG_JOINTS:
        missing = {joint.proximal, joint.distal} - worn
        if len(missing) == 1:
            findings.append(Finding("missing_site", Severity.INFO, str(missing.pop()), {"joint": str(joint)}))
    return findings
