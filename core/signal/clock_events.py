"""Events of the clocks of one recording, for whoever imports it: restarts, jumps, pauses and losses on one time line.

The time line begins with the first sample of all sensors, and a clock that jumped goes on one step after it left off.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from core.samples import FloatArray, ImuBlock
from core.signal.clock_jumps import jump_of, spans_of
from core.signal.reception import gaps_of, outside_of, pauses_among, rate_percent
from core.signal.tracks import MAX_REPORTED_GAP_S, MIN_STRETCH_SAMPLES, is_received
from core.verdicts.gates import LIMITS

TOGETHER_S = 0.5  # sensors that are restarted by one command do so within less
MOST_JUMPS = 20  # of one clock: what jumps more often is no clock
MOST_SPANS = 200  # of one sensor, between gaps over a second: looking for jumps takes their square
MOST_PAUSES = 50  # what pauses more often loses samples: nobody splits a recording so often
MOST_PARTS = 200  # of losses, that are drawn apart


class ClockEventKind(StrEnum):
    """What may befall a clock, in the order of what it costs."""

    RESTART = "restart"
    JUMP = "jump"
    PAUSE = "pause"
    LOSS = "loss"
    SPARSE = "sparse"  # samples are missing throughout, evenly


SPLITTABLE = frozenset({ClockEventKind.RESTART, ClockEventKind.JUMP, ClockEventKind.PAUSE})


@dataclass(frozen=True, slots=True)
class ClockBreak:
    """Where a clock goes on from another time: after `at` of its samples.

    `shift_s`: what was added to the times after it. `by_s`: how far it went, negative where it went back.
    """

    kind: ClockEventKind
    at: int
    shift_s: float
    by_s: float


@dataclass(frozen=True, slots=True)
class ClockEvent:
    """`sensors`: whose, by number; all of them in a pause. `at_s`: where, of several losses the longest.

    `length_s`: how far a clock went, how long a pause was, how much was lost in `count` losses. `parts_s`: begin and
    end of what is drawn. `rates_hz`: received and set, where samples are sparse.
    """

    kind: ClockEventKind
    sensors: tuple[int, ...]
    at_s: float
    length_s: float
    count: int = 1
    longest_s: float = 0.0
    parts_s: tuple[tuple[float, float], ...] = ()
    rates_hz: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True, slots=True)
class ClockView:
    """`spans_s`: first and last sample of each sensor on the time line; (0, 0) without samples."""

    spans_s: tuple[tuple[float, float], ...]
    events: tuple[ClockEvent, ...]

    @property
    def length_s(self) -> float:
        return max((last for _, last in self.spans_s), default=0.0)


def closed_jumps(times_s: Sequence[FloatArray]) -> list[tuple[FloatArray, tuple[ClockBreak, ...]]]:
    """Give each sensor's times (n,) without the jumps that the other sensors show, and these jumps."""
    spans = [spans_of(time_s) for time_s in times_s]
    if max(map(len, spans), default=0) > MOST_SPANS:
        return [(time_s, ()) for time_s in times_s]
    closed = []
    for number, time_s in enumerate(times_s):
        others, breaks = [*spans[:number], *spans[number + 1 :]], list[ClockBreak]()
        while len(breaks) < MOST_JUMPS and (jump := jump_of(spans_of(time_s), others)) is not None:
            first = int(np.searchsorted(time_s, time_s[0] + jump.after_s + jump.by_s / 2.0))
            shift_s = float(np.median(np.diff(time_s))) - jump.by_s
            time_s = np.concatenate([time_s[:first], time_s[first:] + shift_s])
            breaks.append(ClockBreak(ClockEventKind.JUMP, first, shift_s, jump.by_s))
        closed.append((time_s, tuple(breaks)))
    return closed


def clock_view(
    blocks: Sequence[ImuBlock], restarts: Sequence[Sequence[ClockBreak]], nominal_hz: Sequence[float | None]
) -> ClockView:
    """Find what befell the clocks of one recording; `restarts`, `nominal_hz`: of each sensor, as its file gives them.

    A single sensor's jump looks like a pause.
    """
    closed = closed_jumps([block.time_s for block in blocks])
    zero_s = min((float(time_s[0]) for time_s, _ in closed if len(time_s)), default=0.0)
    received = []
    for block, (time_s, _) in zip(blocks, closed, strict=True):
        is_there = is_received(time_s, block.gyr_rad_s, block.acc_m_s2)
        received.append(time_s[is_there] - zero_s)
    breaks = [
        (number, one, middle_s(time_s, one.at) - zero_s)
        for number, (time_s, jumps) in enumerate(closed)
        for one in (*jumps, *restarts[number])
    ]
    pauses = pauses_among(received)
    pauses = pauses if len(pauses) <= MOST_PAUSES else []
    every = tuple(range(len(blocks)))
    events = [
        *_together(breaks),
        *(ClockEvent(ClockEventKind.PAUSE, every, a, b - a, parts_s=((a, b),)) for a, b in pauses),
    ]
    for number, time_s in enumerate(received):
        if len(time_s) >= MIN_STRETCH_SAMPLES:
            events += _losses(number, time_s, pauses)
            events += _sparse(number, time_s, nominal_hz[number])
    spans_s = tuple((float(time_s[0]), float(time_s[-1])) if len(time_s) else (0.0, 0.0) for time_s in received)
    in_order = sorted(events, key=lambda one: (one.kind not in SPLITTABLE, one.at_s if one.kind in SPLITTABLE else 0.0))
    return ClockView(spans_s, tuple(in_order))


def middle_s(time_s: FloatArray, at: int) -> float:
    """Give the time between samples `at` - 1 and `at` of (n,)."""
    return float(time_s[at - 1] + time_s[at]) / 2.0


def _together(breaks: Sequence[tuple[int, ClockBreak, float]]) -> list[ClockEvent]:
    """One event of clocks that break alike at the same time."""
    found: list[ClockEvent] = []
    for number, one, at_s in sorted(breaks, key=lambda one: one[2]):
        same = next((k for k, e in enumerate(found) if e.kind is one.kind and at_s - e.at_s <= TOGETHER_S), None)
        if same is None or number in found[same].sensors:
            found.append(ClockEvent(one.kind, (number,), at_s, abs(one.by_s), parts_s=((at_s, at_s),)))
        else:
            before = found[same]
            sensors, length_s = (*before.sensors, number), max(before.length_s, abs(one.by_s))
            found[same] = ClockEvent(one.kind, sensors, before.at_s, length_s, parts_s=before.parts_s)
    return found


def _losses(number: int, received_s: FloatArray, pauses: Sequence[tuple[float, float]]) -> list[ClockEvent]:
    gaps_s = gaps_of(received_s)
    lost_s = outside_of(pauses, gaps_s)
    is_lost = lost_s > MAX_REPORTED_GAP_S
    gaps_s, lost_s = gaps_s[is_lost], lost_s[is_lost]
    if not len(lost_s):
        return []
    longest = int(np.argmax(lost_s))
    parts: list[tuple[float, float]] = []
    nearest_s = float(received_s[-1] - received_s[0]) / MOST_PARTS
    for begin_s, end_s in gaps_s.tolist():
        if parts and begin_s - parts[-1][1] < nearest_s:
            parts[-1] = parts[-1][0], end_s
        else:
            parts.append((begin_s, end_s))
    return [
        ClockEvent(
            ClockEventKind.LOSS,
            (number,),
            float(gaps_s[longest, 0]),
            float(lost_s.sum()),
            len(lost_s),
            float(lost_s[longest]),
            tuple(parts),
        )
    ]


def _sparse(number: int, received_s: FloatArray, nominal_hz: float | None) -> list[ClockEvent]:
    percent = rate_percent(received_s, nominal_hz)
    least_percent = 100.0 - LIMITS.rate_percent[1]  # below it, the verdicts report no angle
    if percent is None or nominal_hz is None or percent >= least_percent:
        return []
    span = float(received_s[0]), float(received_s[-1])
    rates_hz = nominal_hz * percent / 100.0, nominal_hz
    return [ClockEvent(ClockEventKind.SPARSE, (number,), *span, parts_s=(span,), rates_hz=rates_hz)]
