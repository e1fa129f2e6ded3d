"""The strides of a foot, and which of them show how the patient walks.

A stride leads from one initial contact to the next of the same foot. Starts, stops, turns, pauses, gaps, doubtful
events and outliers keep their stride out of averages, each with its reason; nothing is dropped in silence.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from core.body import Side
from core.gait.events import FootEvents
from core.gait.stairs import FootClimbs, on_stairs
from core.samples import BoolArray, FloatArray, IntArray

MAX_STRIDE_S = 3.0  # a stride at 0.3 m/s takes 2; longer, the patient stood
PAUSE_RATIO = 1.5  # of the usual stride time
MAX_TURN_RAD = np.deg2rad(12.0)  # straight strides turn a foot by up to 5 deg
EDGE_STRIDES = 2  # so many at either end of a bout may be speeding up or slowing down,
EDGE_RATIO = 0.87  # if they are so much slower or shorter than the bout
OUTLIER_SD, MIN_OUTLIER_SHARE = 4.0, 0.12  # beyond both, a stride is unlike the others
MIN_STRIDES_TO_COMPARE = 5


class Reason(StrEnum):
    """Why a stride is not used. The values are the words of strides.csv."""

    USED = ""
    GAP = "gap"
    DOUBT = "doubtful_events"
    PAUSE = "pause"
    TURN = "turn"
    START = "start"
    STOP = "stop"
    OUTLIER = "outlier"
    SLIPPED = "strap_slipped"
    STAIRS_UP = "stairs_up"
    STAIRS_DOWN = "stairs_down"
    BY_HAND = "left_out_by_hand"


@dataclass(frozen=True, slots=True)
class Strides:
    """Strides of one foot, ascending, all (k,).

    `length_m`, `clearance_m`, `climb_m` and `turn_rad` are of the swing that ends the stride; the clearance is how high
    the foot sensor rises over the floor, not the toe's, the climb how much higher the foot comes to stand. NaN from a
    shank. `bout` numbers the uninterrupted runs of strides.
    """

    start_s: FloatArray
    full_contact_s: FloatArray
    heel_rise_s: FloatArray
    toe_off_s: FloatArray
    end_s: FloatArray
    length_m: FloatArray
    clearance_m: FloatArray
    climb_m: FloatArray
    turn_rad: FloatArray
    bout: IntArray
    reason: tuple[Reason, ...]

    def __len__(self) -> int:
        return len(self.start_s)

    @property
    def is_used(self) -> BoolArray:
        """Which strides (k,) have no reason to be left out."""
        return np.array([reason is Reason.USED for reason in self.reason], dtype=bool)

    @property
    def time_s(self) -> FloatArray:
        """Duration of each stride (k,)."""
        return self.end_s - self.start_s

    @property
    def stance_percent(self) -> FloatArray:
        """Initial contact to toe-off (k,), percent of the stride."""
        return 100.0 * (self.toe_off_s - self.start_s) / self.time_s

    @property
    def speed_m_s(self) -> FloatArray:
        """Length over duration of each stride (k,)."""
        return self.length_m / self.time_s

    def left_out_at(self, times_s: Sequence[float]) -> "Strides":
        """The same strides; those used so far in which one of the times lies are left out by hand."""
        at = np.asarray(times_s, dtype=np.float64)[:, None]
        is_meant = ((self.start_s <= at) & (at < self.end_s)).any(axis=0)
        return self._without(self.is_used & is_meant, Reason.BY_HAND)

    def left_out_from(self, time_s: float, reason: Reason) -> "Strides":
        """The same strides; those used so far that end after `time_s` are left out."""
        return self._without(self.is_used & (self.end_s > time_s), reason)

    def _without(self, is_out: BoolArray, reason: Reason) -> "Strides":
        return replace(self, reason=tuple(reason if out else r for out, r in zip(is_out, self.reason, strict=True)))


def strides_of(stretches: Sequence[FootEvents]) -> Strides:
    """Strides of one foot on level ground from its events, one item per stretch without gaps, in order of time."""
    columns = _columns(stretches)
    return _strides(columns, np.zeros(len(columns["end_s"]), dtype=np.int64))


def strides_of_feet(
    events: Mapping[Side, Sequence[FootEvents]], *, are_stairs_declared: bool = False
) -> dict[Side, Strides]:
    """Give strides of each foot and which are on stairs; events per stretch, in order, on one clock."""
    columns = {side: _columns(stretches) for side, stretches in events.items()}
    climbs = [FootClimbs(c["end_s"], c["length_m"], c["climb_m"]) for c in columns.values()]
    ways = on_stairs(climbs, are_declared=are_stairs_declared)
    return {side: _strides(columns[side], way) for side, way in zip(events, ways, strict=True)}


def _columns(stretches: Sequence[FootEvents]) -> dict[str, FloatArray]:
    parts: dict[str, list[FloatArray]] = {name: [] for name in _COLUMNS}
    for events in stretches:
        start, end = events.initial_contact_s[:-1], events.initial_contact_s[1:]
        is_stride = end - start <= MAX_STRIDE_S
        here = {
            "start_s": start,
            "full_contact_s": events.full_contact_s[:-1],
            "heel_rise_s": events.heel_rise_s[1:],
            "toe_off_s": events.toe_off_s[1:],
            "end_s": end,
            "length_m": events.length_m[1:],
            "clearance_m": events.height_m[1:],
            "climb_m": events.climb_m[1:],
            "turn_rad": events.turn_rad[1:],
            "is_certain": (events.is_certain[1:] & events.is_certain[:-1]).astype(np.float64),
            "is_measured": (events.is_measured[1:] & events.is_measured[:-1]).astype(np.float64),
        }
        for name, values in here.items():
            parts[name].append(values[is_stride])
    return {name: np.concatenate([np.empty(0), *values]) for name, values in parts.items()}


def _strides(columns: dict[str, FloatArray], way: IntArray) -> Strides:
    """`way` (k,) as of `on_stairs`."""
    times = {name: values for name, values in columns.items() if name not in ("is_certain", "is_measured")}
    start, end = columns["start_s"], columns["end_s"]
    bout = np.concatenate([np.zeros(min(1, len(start)), int), np.cumsum(start[1:] > end[:-1] + 1e-6)]).astype(np.int64)
    return Strides(**times, bout=bout, reason=_reasons(columns, bout, way))


_COLUMNS = (
    *("start_s", "full_contact_s", "heel_rise_s", "toe_off_s", "end_s", "length_m", "clearance_m"),
    *("climb_m", "turn_rad"),
    *("is_certain", "is_measured"),
)


def _reasons(columns: dict[str, FloatArray], bout: IntArray, way: IntArray) -> tuple[Reason, ...]:
    """The first reason that holds for each stride, the gravest first."""
    time, length = columns["end_s"] - columns["start_s"], columns["length_m"]
    if not len(time):
        return ()
    order = tuple(Reason)
    code = np.zeros(len(time), dtype=np.int64)

    def mark(where: BoolArray, reason: Reason, *instead_of: Reason) -> None:
        code[where & np.isin(code, [order.index(r) for r in (Reason.USED, *instead_of)])] = order.index(reason)

    mark(columns["is_measured"] == 0.0, Reason.GAP)
    mark(columns["is_certain"] == 0.0, Reason.DOUBT)
    mark(way > 0, Reason.STAIRS_UP, Reason.DOUBT)  # a foot that climbs rolls otherwise
    mark(way < 0, Reason.STAIRS_DOWN, Reason.DOUBT)
    mark(np.abs(columns["turn_rad"]) > MAX_TURN_RAD, Reason.TURN)
    usual = np.median(time[code == 0]) if np.any(code == 0) else np.median(time)
    is_start, is_stop = _edges(time, length, bout, code == 0)
    mark(is_start, Reason.START, Reason.DOUBT)  # a foot that starts or stops hardly rolls
    mark(is_stop, Reason.STOP, Reason.DOUBT)
    mark(time > PAUSE_RATIO * usual, Reason.PAUSE)
    mark(_is_unlike(time, code == 0) | _is_unlike(length, code == 0), Reason.OUTLIER)
    return tuple(order[k] for k in code)


def _edges(time: FloatArray, length: FloatArray, bout: IntArray, is_good: BoolArray) -> tuple[BoolArray, BoolArray]:
    """Strides at the beginning and at the end of each bout that are slower or shorter than the rest of it."""
    is_start, is_stop = np.zeros(len(time), dtype=bool), np.zeros(len(time), dtype=bool)
    for number in np.unique(bout):
        here = np.flatnonzero(bout == number)
        inner = here[EDGE_STRIDES:-EDGE_STRIDES][is_good[here[EDGE_STRIDES:-EDGE_STRIDES]]]
        like = inner if len(inner) else here
        is_slow = time > np.median(time[like]) / EDGE_RATIO
        if np.isfinite(length[like]).all():
            is_slow |= length < EDGE_RATIO * np.median(length[like])
            is_slow |= length / time < EDGE_RATIO * np.median(length[like] / time[like])
        for edge, mask in ((here[:EDGE_STRIDES], is_start), (here[::-1][:EDGE_STRIDES], is_stop)):
            slow = np.flatnonzero(is_slow[edge])
            mask[edge[: slow[-1] + 1 if len(slow) else 0]] = True
    return is_start, is_stop


def _is_unlike(values: FloatArray, is_good: BoolArray) -> BoolArray:
    """Good strides that lie far from the middle of the others (median absolute deviation)."""
    good = values[is_good]
    if len(good) < MIN_STRIDES_TO_COMPARE or not np.isfinite(good).all():
        return np.zeros(len(values), dtype=bool)
    middle = float(np.median(good))
    reach = max(OUTLIER_SD * 1.4826 * float(np.median(np.abs(good - middle))), MIN_OUTLIER_SHARE * abs(middle))
    return is_good & (np.abs(values - middle) > reach)
