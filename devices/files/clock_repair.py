"""The clocks of files, repaired the same way for every reader: turns of counters, wrong stamps, steps back, jumps.

A stamp that fits neither those before nor those after is put where it belongs, with a finding; where that is unknown
its sample is left out. Where the clock goes on from another time than it left off, nothing shows how much time passed:
the file is refused with the place, so that nobody reads a false rate or half a recording. Only who will split it there
reads on: see `restarts_continued`.
"""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass

import numpy as np

from core.findings import Finding, Severity
from core.samples import BoolArray, FloatArray
from devices.files.orientation_rates import Numbers
from devices.files.refusal import FileRefusedError, plain
from devices.files.table_header import CORRECT_IT
from devices.files.tables import Table

SPLIT_IT = "Split the recording there, or export it again"
FEW = 8  # samples in a row whose stamps may be wrong without another sign that they are
AS_COUNTED = 0.5  # of a step: the stamps around wrong ones are as far apart as the samples between them make them
DRIFT = 0.02  # as above, of a long run
MOST_LOST = 1000  # steps: what may be missing beside a wrong stamp
LEAST = 4 * FEW  # samples, of which a few at an end may be left out
MOST_RUNS = 100  # that are looked for through the whole file
MOST_RESTARTS = 20  # of one clock: what restarts more often is no clock
RESTARTED = "clock_restarted"  # the finding of a clock that was continued, for `formats.read_trial` alone
WINDOW = 16  # samples over which steps are averaged: stamps may come in batches, or be rounded


@dataclass(frozen=True, slots=True)
class FileClock:
    """How a refusal names a clock: the file, a row of it, and what its stamps are called.

    `unit_s`: seconds of one unit of its stamps.
    """

    where: str
    place: Callable[[int], str]
    name: str
    unit_s: float = 1.0


@dataclass(frozen=True, slots=True)
class RepairedClock:
    """`stamps` (n,): NaN where a sample has none. `is_new` (n,): which are later than all before them."""

    stamps: FloatArray
    is_new: BoolArray
    findings: tuple[Finding, ...]

    @property
    def doubled(self) -> int:
        """How many samples repeat a stamp."""
        return int(np.sum(np.isfinite(self.stamps) & ~self.is_new))


@dataclass(frozen=True, slots=True)
class _WrongRun:
    """Samples [first, end) with wrong stamps; `is_placed`: they can only have been taken evenly in between."""

    first: int
    end: int
    is_placed: bool


def whole_clock(stamps: FloatArray, clock: FileClock, remedy: str) -> RepairedClock:
    """As `repaired`, of stamps (n,) all of which have to be there; `remedy` is for one that is not."""
    is_there = np.isfinite(stamps)
    if not is_there.all():
        place = clock.place(int(np.argmin(is_there)))
        raise FileRefusedError.stated_elsewhere(f"{clock.where}, {place}", "a sample has no time", remedy, {})
    return repaired(stamps, clock)


def usual_rate(time_s: FloatArray) -> float | None:
    """Samples per second of stamps (n,), to a tenth; None of fewer than two."""
    steps_s = np.diff(time_s)
    return round(1.0 / float(np.median(steps_s)), 1) if len(steps_s) else None


def repaired(
    stamps: FloatArray | Numbers, clock: FileClock, *, slack: float = 0.0, step: float | None = None
) -> RepairedClock:
    """Mend wrong stamps (n,), NaN where there is none; raises FileRefusedError if it steps back for good.

    `slack`: so far back a stamp may lie, because stamps are of arrivals. `step`: from sample to sample, where known.
    """
    mended = np.array(stamps, dtype=np.float64)
    rows = np.flatnonzero(np.isfinite(mended))
    times = mended[rows]
    usual = step or _usual_step(times)
    restarts: list[_Restart] = []
    runs, lasting = _wrong_runs(times, usual, slack)
    while lasting is not None:
        refusal = steps_back(clock, int(rows[lasting]), times[lasting - 1], times[lasting])
        restarts.append(_continued_at(times, lasting, usual, refusal, len(restarts)))
        mended[rows] = times
        runs, lasting = _wrong_runs(times, usual, slack)
    findings = []
    if runs:
        first = runs[0].first
        off = abs(times[first] - _at(times, runs[0], usual))
        numbers = {
            "count": sum(run.end - run.first for run in runs),
            "left_out": sum(run.end - run.first for run in runs if not run.is_placed),
            "first": int(rows[first]) + 1,
            "off_s": float(f"{off * clock.unit_s:.6g}"),
        }
        findings.append(Finding("stamps_mended", Severity.WARNING, "", numbers))
        for run in runs:
            times[run.first : run.end] = np.nan
            if run.is_placed:
                around = times[run.first - 1], times[run.end]
                times[run.first : run.end] = np.linspace(*around, run.end - run.first + 2)[1:-1]
        mended[rows] = times
    is_new = is_later(mended)
    found = RepairedClock(mended, is_new, ())
    doubled = _doubled(found.doubled if not slack else 0)
    restarted = [_restart_finding(one, is_new[rows], times, clock.unit_s) for one in restarts]
    return RepairedClock(mended, is_new, (*findings, *doubled, *restarted))


@dataclass(frozen=True, slots=True)
class _Restart:
    """A clock that began again at stamp `at`, those after it moved by `shift`; `refusal`: where it is not split."""

    at: int
    shift: float
    refusal: FileRefusedError


_continued: ContextVar[list[FileRefusedError] | None] = ContextVar("continued clocks", default=None)


@contextmanager
def restarts_continued() -> Iterator[list[FileRefusedError]]:
    """Let clocks that begin again go on one step after they left off, instead of refusing their files.

    It gives what would have been refused. A variable of the context, for it concerns whoever reads the trial, and no
    reader: each of them passes on the findings of its clocks.
    """
    met: list[FileRefusedError] = []
    token = _continued.set(met)
    try:
        yield met
    finally:
        _continued.reset(token)


def _continued_at(times: FloatArray, at: int, step: float, refusal: FileRefusedError, count: int) -> _Restart:
    """Move all stamps from `at` on behind those before, in place; raises `refusal` where nobody will split there."""
    met = _continued.get()
    if met is None or count >= MOST_RESTARTS:
        raise refusal
    met.append(refusal)
    shift = float(times[at - 1] + step - times[at])
    times[at:] += shift
    return _Restart(at, shift, refusal)


def _restart_finding(restart: _Restart, is_new: BoolArray, times: FloatArray, unit_s: float) -> Finding:
    """`samples` of `of`: those before it, of all that have a new time."""
    refusal = restart.refusal
    numbers: Mapping[str, float | int | str] = {
        "samples": int(np.sum(is_new[: restart.at])),
        "of": int(np.sum(is_new)),
        "after_s": float(np.nanmax(times[: restart.at]) - np.nanmin(times)) * unit_s,
        "shift_s": restart.shift * unit_s,
        "where": refusal.where,
        **{name: str(value) for name, value in refusal.values.items()},
    }
    return Finding(RESTARTED, Severity.GRAVE, "", numbers)


def restart_refusal(finding: Finding) -> FileRefusedError:
    """The refusal of a clock that was continued, where its recording is not split there."""
    of = finding.numbers
    return _steps_back(str(of["where"]), str(of["name"]), str(of["before"]), str(of["after"]))


def continued(
    time_s: FloatArray, clock: FileClock, next_back: Callable[[FloatArray], int | None], step_s: float
) -> tuple[FloatArray, tuple[Finding, ...]]:
    """Times (n,) continued wherever `next_back` finds the first that is lastingly earlier; raises FileRefusedError."""
    times = time_s.copy()
    restarts: list[_Restart] = []
    while (back := next_back(times)) is not None:
        refusal = steps_back(clock, back, float(times[back - 1]), float(times[back]))
        restarts.append(_continued_at(times, back, step_s, refusal, len(restarts)))
    every = np.ones(len(times), dtype=bool)
    return times, tuple(_restart_finding(one, every, times, 1.0) for one in restarts)


def steps_back(clock: FileClock, row: int, before: float, after: float) -> FileRefusedError:
    """The refusal of a clock that steps back at a row and goes on from there."""
    return _steps_back(f"{clock.where}, {clock.place(row)}", clock.name, plain(before), plain(after))


def _steps_back(where: str, name: str, before: str, after: str) -> FileRefusedError:
    return FileRefusedError(
        where, "{name} goes back from {before} to {after}", SPLIT_IT, name=name, before=before, after=after
    )


def is_later(stamps: FloatArray | Numbers) -> BoolArray:
    """Give which stamps are later than all before them; False where NaN."""
    is_there = np.isfinite(stamps)
    if not is_there.all():
        stamps = np.where(is_there, stamps, -np.inf)
    latest = np.maximum.accumulate(stamps)
    is_first = np.ones(len(stamps[:1]), dtype=bool)
    return is_there & np.concatenate([is_first, stamps[1:] > latest[:-1]])


def unwrapped(table: Table, name: str, turns_at: int, where: str) -> Numbers:
    """Give a counter or clock without its turns, from the first number on; raises FileRefusedError.

    `turns_at`: the first number that it does not reach.
    """
    raw = table.numbers[name]
    is_count = (raw >= 0) & (raw < turns_at) & (raw == np.floor(raw))
    if not is_count.all():
        raise FileRefusedError(
            f"{where}, {table.place(int(np.argmin(is_count)))}",
            "{name} is not a whole number from 0 to {most}",
            CORRECT_IT,
            name=name,
            most=turns_at - 1,
        )
    return without_turns(raw.astype(np.int64), turns_at)


def without_turns(count: Numbers, turns_at: int) -> Numbers:
    """(n,) counts that go on where the counter begins again; a wrong one changes none of those after it."""
    half = turns_at // 2
    step: Numbers = (np.diff(count) + half) % np.int64(turns_at) - half
    first = count[:1]
    return np.concatenate([first, first + np.cumsum(step)])


def _doubled(count: int) -> list[Finding]:
    return [Finding("doubled_stamps", Severity.WARNING, "", {"count": count})] if count else []


def _usual_step(times: FloatArray) -> float:
    steps = np.diff(times)
    later = steps[steps > 0]
    if not len(later):
        return 1.0
    usual = float(np.median(later))
    if len(times) > 4 * WINDOW:
        usual = min(usual, max(float(np.median(times[WINDOW:] - times[:-WINDOW])) / WINDOW, 0.0) or usual)
    return usual


def _at(times: FloatArray, run: _WrongRun, step: float) -> float:
    """Where the first of wrong stamps should be."""
    return float(times[run.first - 1] + step) if run.first else float(times[run.end] - step * run.end)


def _wrong_runs(times: FloatArray, step: float, slack: float) -> tuple[list[_WrongRun], int | None]:
    """Runs of wrong stamps in order, and where the clock steps back for good."""
    runs: list[_WrongRun] = []
    first, last = _without_ends(times, MOST_LOST * step)
    if first:
        runs.append(_WrongRun(0, first, is_placed=False))
    done, looked = first, 0
    tail = [_WrongRun(last, len(times), is_placed=False)] if last < len(times) else []
    for at in np.flatnonzero(np.diff(times) < -slack) + 1:
        if at <= done:
            continue
        if at >= last:
            break
        run = _few_wrong(times[:last], int(at), done, step, max(AS_COUNTED * step, slack))
        if run is None:
            looked += 1
            run = _many_wrong(times[:last], int(at), done, step, slack) if looked <= MOST_RUNS else None
        if run is None:
            return runs, int(at)
        runs.append(run)
        done = run.end
        if done == last:
            break
    return runs + tail, None


def _without_ends(times: FloatArray, leap: float) -> tuple[int, int]:
    """[first, last) without a few stamps at an end from which the clock leaps forward for good."""
    first, last = 0, len(times)
    for at in np.flatnonzero(np.diff(times) > leap) + 1 if last >= LEAST else ():
        if at <= FEW and np.median(times[at : at + 2 * FEW + 1]) > times[:at].max() + leap:
            first = int(at)
        elif at >= len(times) - FEW and times[at:].min() > times[at - 1] + leap:
            last = int(at)
            break
    return first, last


def _few_wrong(times: FloatArray, at: int, done: int, step: float, most_off: float) -> _WrongRun | None:
    """The least run about a step back without which stamps are as far apart as their samples."""
    for count in range(1, FEW + 1):
        firsts = [k for k in range(at - count, at + 1) if k > done and k + count < len(times)]
        off = {k: abs(times[k + count] - times[k - 1] - (count + 1) * step) for k in firsts}
        best = min(firsts, key=lambda k: off[k], default=None)
        if best is not None and off[best] <= most_off:
            return _WrongRun(best, best + count, is_placed=True)
    return None


def _many_wrong(times: FloatArray, at: int, done: int, step: float, slack: float) -> _WrongRun | None:
    """A run that leaps away and returns, before or after a step back, or a few at an end of the file."""
    last = len(times)
    ahead = np.flatnonzero(times[done:at] >= times[at])
    behind = np.flatnonzero(times[at:] > times[at - 1])
    spans = [(done + int(ahead[0]), at)] if len(ahead) else []
    spans += [(at, at + int(behind[0]))] if len(behind) else []
    for first, end in spans:
        count = end - first
        if first > done:
            off = times[end] - times[first - 1] - (count + 1) * step
            if abs(off) <= max(AS_COUNTED * step, DRIFT * count * step, slack):
                return _WrongRun(first, end, is_placed=True)
            if 0.0 < off <= MOST_LOST * step and count <= FEW:
                return _WrongRun(first, end, is_placed=False)
    if last < LEAST:
        return None
    if at <= FEW and done == 0:
        return _WrongRun(0, at, is_placed=False)
    return _WrongRun(at, last, is_placed=False) if last - at <= FEW else None
