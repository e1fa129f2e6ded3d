"""Scores of how well a method finds the events and strides of a foot, beside optics. The same for every method."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from core.samples import BoolArray, FloatArray, IntArray

SAME_S = 0.15  # an event further than this from the true one, less the method's usual delay, is another event
MIN_TRAVEL_M = 0.1  # of the heel in a swing; where it went less, the swing is invented
MAX_SWING_S = 1.0  # the optical list runs two swings of a turn together: no swing's length to compare with
MIN_COVER = 0.5  # of a stride's instants; those a method does not know lie in stance, where the foot hardly turns
CLOCK_OFFSETS_S = np.arange(-6, 7) * 0.0025  # the optics' clock, and which side of a sample an orientation belongs to


@dataclass(frozen=True, slots=True)
class Stretch:
    """Orientations (n,) at instants (n,)."""

    time_s: FloatArray
    rotations: Rotation


@dataclass(frozen=True, slots=True)
class OpticalStride:
    """One stride of the optical recording, seconds and metres; the foot is at `start_s` and `end_s`."""

    start_s: float
    end_s: float
    initial_contact_s: float
    toe_off_s: float
    length_m: float
    stretch: Stretch


@dataclass(frozen=True, slots=True)
class OpticalFoot:
    """What the optics say of one foot: its strides, and the way (n, 2) of its heel over the floor at instants (n,)."""

    strides: list[OpticalStride]
    time_s: FloatArray
    heel_m: FloatArray

    def travel_m(self, from_s: FloatArray, to_s: FloatArray) -> FloatArray:
        """How far the heel went (k,) between instants (k,)."""
        ends = [[np.interp(t, self.time_s, self.heel_m[:, k]) for k in range(2)] for t in (from_s, to_s)]
        return np.asarray(np.hypot(*np.subtract(ends[1], ends[0])))


@dataclass(frozen=True, slots=True)
class FoundEvents:
    """The swings a method found in one foot's recording, (k,) each, in any order."""

    toe_off_s: FloatArray
    initial_contact_s: FloatArray


@dataclass(frozen=True, slots=True)
class FoundStrides:
    """The strides a method measured, (k,) each, known by the initial contact within; and orientations."""

    initial_contact_s: FloatArray
    length_m: FloatArray
    stretches: tuple[Stretch, ...]


@dataclass(frozen=True, slots=True)
class EventScore:
    """Per optical stride (s,), how late the events are, NaN where missed; swings in no stride, and those not made."""

    contact_s: FloatArray
    off_s: FloatArray
    more: int
    invented: int

    @classmethod
    def joined(cls, feet: Sequence[Self]) -> Self:
        return cls(
            contact_s=np.concatenate([foot.contact_s for foot in feet]),
            off_s=np.concatenate([foot.off_s for foot in feet]),
            more=sum(foot.more for foot in feet),
            invented=sum(foot.invented for foot in feet),
        )

    @property
    def is_found(self) -> BoolArray:
        return np.isfinite(self.contact_s) & np.isfinite(self.off_s)


@dataclass(frozen=True, slots=True)
class StrideScore:
    """Per optical stride (s,): length found less true, and true length; RMSE of the pitch (s, offsets of the clock).

    NaN where there is none.
    """

    error_m: FloatArray
    true_m: FloatArray
    pitch_rad: FloatArray

    @classmethod
    def joined(cls, feet: Sequence[Self]) -> Self:
        return cls(
            error_m=np.concatenate([foot.error_m for foot in feet]),
            true_m=np.concatenate([foot.true_m for foot in feet]),
            pitch_rad=np.concatenate([foot.pitch_rad for foot in feet]),
        )

    @property
    def has_length(self) -> BoolArray:
        return np.isfinite(self.error_m)

    @property
    def has_pitch(self) -> BoolArray:
        return np.isfinite(self.pitch_rad[:, 0])

    def pooled_pitch_rad(self, which: BoolArray) -> tuple[float, float]:
        """RMSE over the strides of `which` (s,) at the offset of the clock that suits them best; and that offset, s."""
        pooled = np.sqrt(np.mean(self.pitch_rad[which] ** 2, axis=0))
        best = int(np.argmin(pooled))
        return float(pooled[best]), float(CLOCK_OFFSETS_S[best])


def paired(found_s: FloatArray, true_s: FloatArray) -> IntArray:
    """Index (s,) of the event found for each true one, -1 where there is none.

    The window lies around the method's own usual delay, so that another definition of an event loses none. Events of
    one kind and foot lie further apart than two windows, so no event is found for two.
    """
    if not len(found_s) or not len(true_s):
        return np.full(len(true_s), -1)
    late = found_s[np.argmin(np.abs(found_s - true_s[:, None]), axis=1)] - true_s
    away = np.abs(found_s - true_s[:, None] - np.median(late))
    nearest = np.argmin(away, axis=1)
    return np.where(away[np.arange(len(true_s)), nearest] < SAME_S, nearest, -1)


def score_events(found: FoundEvents, foot: OpticalFoot) -> EventScore:
    """Contacts and toe-offs are paired each for itself: a turn's optical stride takes them from two swings."""
    pairs = {}
    for name in ("initial_contact_s", "toe_off_s"):
        true_s, found_s = np.array([getattr(s, name) for s in foot.strides]), getattr(found, name)
        pairs[name] = paired(found_s, true_s), found_s, true_s
    contacts = pairs["initial_contact_s"][0]
    is_more = ~np.isin(np.arange(len(found.initial_contact_s)), contacts)
    order = np.argsort(found.initial_contact_s)
    is_again = np.zeros(len(order), dtype=bool)  # begins before the last one's end: one swing found twice
    is_again[order[1:]] = found.toe_off_s[order[1:]] < found.initial_contact_s[order[:-1]]
    is_still = foot.travel_m(found.toe_off_s, found.initial_contact_s) < MIN_TRAVEL_M
    return EventScore(
        contact_s=_at(*pairs["initial_contact_s"]),
        off_s=_at(*pairs["toe_off_s"]),
        more=int(np.sum(is_more)),
        invented=int(np.sum(is_more & (is_again | is_still))),
    )


def _at(index: IntArray, found: FloatArray, true: FloatArray) -> FloatArray:
    late = np.full(len(true), np.nan)
    late[index >= 0] = found[index[index >= 0]] - true[index >= 0]
    return late


def score_strides(found: FoundStrides, foot: OpticalFoot) -> StrideScore:
    true_s = np.array([stride.initial_contact_s for stride in foot.strides])
    true_m = np.array([stride.length_m for stride in foot.strides])
    error_m = _at(paired(found.initial_contact_s, true_s), found.length_m, true_m)
    error_m[[stride.initial_contact_s - stride.toe_off_s > MAX_SWING_S for stride in foot.strides]] = np.nan
    pitch_rad = np.array([_pitch_errors_rad(found.stretches, stride.stretch) for stride in foot.strides])
    return StrideScore(error_m, true_m, pitch_rad)


def _pitch_errors_rad(stretches: Sequence[Stretch], true: Stretch) -> FloatArray:
    """RMSE, per offset of the clock, of the turn about the foot's main axis since the stride began, less the means."""
    reach_s = CLOCK_OFFSETS_S[-1]
    is_known = [(true.time_s >= s.time_s[0] + reach_s) & (true.time_s <= s.time_s[-1] - reach_s) for s in stretches]
    best = max(range(len(stretches)), key=lambda k: int(is_known[k].sum()), default=None)
    if best is None or is_known[best].mean() < MIN_COVER:
        return np.full(len(CLOCK_OFFSETS_S), np.nan)
    inside = is_known[best]
    found = Slerp(stretches[best].time_s, stretches[best].rotations)
    true_rad = _main_turn_rad(true.rotations[inside])
    shifted_s = true.time_s[inside] - CLOCK_OFFSETS_S[:, None]
    return np.array([float(np.std(_main_turn_rad(found(time_s)) - true_rad)) for time_s in shifted_s])


def _main_turn_rad(rotations: Rotation) -> FloatArray:
    """Turn (n,) since the first about the axis the foot mostly turns about, the greatest being positive."""
    since = (rotations[0].inv() * rotations).as_rotvec()
    turn = since @ np.linalg.eigh(since.T @ since)[1][:, -1]
    return np.asarray(turn * np.sign(turn[np.argmax(np.abs(turn))]))
