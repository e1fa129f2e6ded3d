"""Quality of the samples: every recording is looked at before anything is computed from it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, islice

import numpy as np

from core.body import LEG_JOINTS, Site
from core.calibration.handedness import Turn, reversed_sites, turn_about_vertical
from core.calibration.rest import rest_of
from core.findings import Finding, Severity
from core.samples import BoolArray, FloatArray, ImuBlock, IntArray
from core.session import Recording, RecordingKind, Session
from core.signal.clipping import clipped_forces, clipped_rates
from core.signal.clock_jumps import Span, jump_of, spans_of
from core.signal.pair import moving_mean
from core.signal.reception import (
    KEPT_RATE_PERCENT,
    Pause,
    gaps_of,
    is_half,
    lost_percent,
    outside_of,
    pauses_of,
    rate_percent,
)
from core.signal.tracks import (
    MAX_REPORTED_GAP_S,
    MIN_STRETCH_S,
    MIN_STRETCH_SAMPLES,
    in_every_column,
    is_possible,
    is_stuck,
    nominal_step_s,
)

MIN_LOSS_PERCENT = 0.5  # reported from here on
GRAVE_LOSS_PERCENT = 20.0
GRAVITY_RANGE_G = (0.7, 1.4)  # median specific force of a sensor that reports g
PLAUSIBLE_M_S2 = (5.0, 20.0)
PLAUSIBLE_RAD_S = 35.0  # 2000 deg/s, the range of the sensors; a walking shank reaches 8
LARGE = 1e6
LOOKED_AT_ROWS = 6000  # units show in so many rows as in all
MIN_RATE_HZ = 25.0  # below, a swing is a handful of samples
COMPARED_ROWS = 2000
ROW_FACTORS = 1_000_003 ** np.arange(1, 7)  # two rows hardly ever make one number
MIN_DISTINCT = 0.8  # share of rows that are unlike all others: a finer sensor than that never repeats itself by chance
MOVING_RAD_S = 0.5
MIN_CLIPPED_PERCENT = 0.05
CLOCK_OFFSET_S = 5.0
CLOCK_AGREEMENT_S = 1.0
CLOCK_GRID_S = 0.1
MIN_LIKENESS = 0.3  # correlation of how much two sites move, as stamped
MIN_STEP_NOT_S, MIN_STEP_US = 0.4, 400.0  # steps of what cannot be seconds: milliseconds, from here on microseconds


@dataclass(frozen=True, slots=True)
class Quality:
    """Findings, which sites of which recordings cannot be used at all, and each recording's pauses by its name."""

    findings: tuple[Finding, ...]
    unusable: frozenset[tuple[str, Site]]
    pauses: Mapping[str, Sequence[Pause]]


@dataclass(frozen=True, slots=True)
class _Outline:
    """What a sensor is compared by with others, which may be too large to be held beside it.

    `rows` (n,) stand for its first samples; `spans_s` are those without a long gap.
    """

    rows: IntArray
    spans_s: list[Span]


def look_at(session: Session) -> Quality:
    """Look at every kept recording."""
    findings: list[Finding] = []
    unusable: set[tuple[str, Site]] = set()
    worn: dict[tuple[str, Site], str] = {}
    reversed_sensors: set[tuple[Site, str]] = set()
    pauses_by_name: dict[str, list[Pause]] = {}
    for recording in session.recordings:
        if not recording.is_kept:
            findings.append(Finding("recording_discarded", Severity.INFO, recording.name))
            continue
        turns: dict[Site, Turn] = {}
        outlines: dict[Site, _Outline] = {}
        pauses = pauses_by_name[recording.name] = pauses_of(recording)
        for first, last in pauses:
            numbers = {"from_s": round(first, 1), "length_s": round(last - first, 1)}
            findings.append(Finding("pause", Severity.WARNING, recording.name, numbers))
        for site, block in recording.imu.items():
            worn[recording.name, site] = block.sensor
            outlines[site] = _Outline(_distinct_rows(block), spans_of(block.time_s))
            where = f"{recording.name}, {site}"
            nominal_hz = session.sensors[site].rate_hz if site in session.sensors else None
            about = [
                Finding(key, severity, where, reported)
                for key, severity, reported in _about_block(block, recording.kind, nominal_hz, pauses)
            ]
            findings += about
            if any(found.severity is Severity.GRAVE for found in about):
                unusable.add((recording.name, site))
            elif recording.kind is not RecordingKind.STANDING:
                turns[site] = turn_about_vertical(block)
        of_several = (
            _same_data(recording.name, outlines),
            _clock_offsets(recording, outlines),
            _clock_jumps(recording.name, outlines),
        )
        for sites, found in chain.from_iterable(of_several):
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
    return Quality(tuple(findings), frozenset(unusable), pauses_by_name)


About = tuple[str, Severity, dict[str, float | int | str]]


def _about_block(
    block: ImuBlock, kind: RecordingKind, nominal_hz: float | None, pauses: Sequence[Pause]
) -> list[About]:
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
    received = possible & ~is_held
    received[1:] &= np.diff(block.time_s) > 0
    about: list[About] = []
    impossible = int(np.count_nonzero(is_there & ~possible))
    if impossible:
        about.append(("impossible_values", Severity.WARNING, {"count": impossible}))
    stuck = 100 * float(np.mean(is_held))
    if np.count_nonzero(received) < MIN_STRETCH_SAMPLES or np.ptp(block.time_s[received]) < MIN_STRETCH_S:
        return [*about, ("stuck_throughout", Severity.GRAVE, {})]
    if stuck > 0.0:
        about.append(("stuck", Severity.WARNING, {"percent": round(stuck, 1)}))
    received_s = block.time_s[received]
    step_s = nominal_step_s(received_s)
    about += _about_gaps(received_s, lost_percent(block.time_s, received_s, pauses=pauses), pauses)
    about += _about_rate(received_s, nominal_hz)
    rate_hz = 1 / step_s
    if rate_hz < MIN_RATE_HZ:
        about.append(("low_rate", Severity.WARNING, {"rate_hz": round(rate_hz, 1)}))
    clipped = _clipped_percent(block, received)
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


def _about_gaps(received_s: FloatArray, percent: float, pauses: Sequence[Pause]) -> list[About]:
    """What is missing outside of pauses; a gap that is bridged leaves what was measured as good as it was."""
    gaps_s = gaps_of(received_s)
    out_s = outside_of(pauses, gaps_s)
    is_gap = out_s > MAX_REPORTED_GAP_S
    if percent < MIN_LOSS_PERCENT and not is_gap.any():
        return []
    if not is_gap.any():
        return [("bridged", Severity.INFO, {"missing_percent": round(percent, 1)})]
    numbers: dict[str, float | int | str] = {
        "count": int(np.count_nonzero(is_gap)),
        "missing_percent": round(percent, 1),
        "longest_s": round(float(np.max(out_s)), 3),
    }
    span_s = float(received_s[-1] - received_s[0]) - sum(last - first for first, last in pauses)
    is_grave = 100.0 * float(np.sum(out_s[is_gap])) >= GRAVE_LOSS_PERCENT * span_s
    # reported as a warning in either case: what was received is still used
    return [("many_gaps" if is_grave else "gaps", Severity.WARNING, numbers)]


def _about_rate(received_s: FloatArray, nominal_hz: float | None) -> list[About]:
    """Where samples came at another rate than the sensor was set to."""
    percent = rate_percent(received_s, nominal_hz)
    if percent is None or nominal_hz is None or abs(percent - 100.0) <= KEPT_RATE_PERCENT:
        return []
    numbers: dict[str, float | int | str] = {
        "rate_hz": round(0.01 * percent * nominal_hz, 1),
        "nominal_hz": round(nominal_hz, 1),
        "lost_percent": round(100.0 - percent, 1),
    }
    return [("every_second_lost" if is_half(percent) else "rate_off", Severity.WARNING, numbers)]


def _clipped_percent(block: ImuBlock, received: BoolArray) -> float:
    """How much of the worst axis lies at one end of the sensor's range."""
    ends = (clipped_rates(block.gyr_rad_s[received]), clipped_forces(block.acc_m_s2[received]))
    return 100 * max(float(column.mean()) for end in ends for column in (*end.T, np.zeros(1)))


AboutSites = list[tuple[tuple[Site, ...], Finding]]


def _same_data(name: str, outlines: Mapping[Site, _Outline]) -> AboutSites:
    """Sensors whose rows in motion agree to the last digit: one is a copy of the other."""
    # at rest coarse ones agree, too
    found: AboutSites = []
    for k, (site, mine) in enumerate(outlines.items()):
        for other, theirs in islice(outlines.items(), k):
            shared = len(np.intersect1d(mine.rows, theirs.rows, assume_unique=True))
            if shared > 0.5 * max(min(len(mine.rows), len(theirs.rows)), MIN_STRETCH_SAMPLES):
                found.append(((other, site), Finding("same_data", Severity.GRAVE, f"{name}, {other}, {site}")))
    return found


def _distinct_rows(block: ImuBlock) -> IntArray:
    """The first rows of a sensor's samples by which it can be distinguished from another, each as one number."""
    first = slice(0, COMPARED_ROWS)
    signals = np.concatenate([block.gyr_rad_s[first], block.acc_m_s2[first]], axis=1).astype(np.float64)
    signals = signals[np.isfinite(signals).all(axis=1) & np.any(signals, axis=1)]
    rows = np.sum(signals.view(np.int64) * ROW_FACTORS, axis=1)  # wraps around, as it may
    distinct = np.unique(rows)
    if len(distinct) >= MIN_DISTINCT * len(signals):
        return distinct
    return np.unique(rows[np.linalg.norm(signals[:, :3], axis=1) > MOVING_RAD_S])


def _clock_offsets(recording: Recording, outlines: Mapping[Site, _Outline]) -> AboutSites:
    """A site whose start and end both lie equally far from the others' has a clock of its own."""
    spans = {site: (one.spans_s[0][0], one.spans_s[-1][1]) for site, one in outlines.items() if one.spans_s}
    if len(spans) < 2:
        return []
    start, end = (float(np.median([span[k] for span in spans.values()])) for k in (0, 1))
    if len(spans) == 2:  # two clocks that disagree: the proximal one is taken as right
        start, end = next(iter(spans.values()))
    found: AboutSites = []
    for site, (first, last) in spans.items():
        offset_s = 0.5 * (first - start + last - end)
        is_shifted = abs(offset_s) > CLOCK_OFFSET_S and abs((last - end) - (first - start)) < CLOCK_AGREEMENT_S
        if is_shifted and not _moves_with_others(recording, site, offset_s):
            numbers = {"offset_s": round(offset_s, 1)}
            where = f"{recording.name}, {site}"
            found.append(((site,), Finding("clock_offset", Severity.GRAVE, where, numbers)))
    return found


def _clock_jumps(name: str, outlines: Mapping[Site, _Outline]) -> AboutSites:
    found: AboutSites = []
    for site, own in outlines.items():
        jump = jump_of(
            own.spans_s, [other.spans_s for at, other in outlines.items() if at is not site and other.spans_s]
        )
        if jump is not None:
            numbers = {"jump_s": round(jump.by_s, 2), "after_s": round(jump.after_s, 2)}
            found.append(((site,), Finding("clock_jumps", Severity.GRAVE, f"{name}, {site}", numbers)))
    return found


def _moves_with_others(recording: Recording, site: Site, offset_s: float) -> bool:
    """Whether a site moves with the adjacent segment as both are stamped, more than without the offset."""
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
    """An adjacent site without which a worn sensor gives no joint."""
    worn = {site for recording in session.recordings if recording.is_kept for site in recording.imu}
    findings = []
    for joint in LEG_JOINTS:
        missing = {joint.proximal, joint.distal} - worn
        if len(missing) == 1:
            findings.append(Finding("missing_site", Severity.INFO, str(missing.pop()), {"joint": str(joint)}))
    return findings
