"""How the body comes along and turns, from both feet: each carries half of the way.

While one foot swings, the body goes half as far; the mean of both feet's ways keeps within a few centimetres of it. The
heading is the integral of each foot's rate about the vertical, read where the foot is standing, so that the sway of
a swing does not count.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from core.body import Segment, Side, Site
from core.gait.events import FootEvents, detect_events
from core.gait.foot import FootMotion, follow
from core.gait.strides import MAX_STRIDE_S
from core.gait.walking import prosthetic_sides
from core.samples import FloatArray
from core.session import Recording
from core.signal.pair import OrientedTrack, moving_mean
from core.signal.sensors import SensorTracks
from core.timed.found import Silence, Turn

STEP_S = 0.02
SILENCE_S = 0.3  # shorter gaps are bridged or cost no step
STILL_S = 1.0  # both feet on the floor for so long: a pause, or the stillness before a start
CALM_S, MOVING_RAD_S = 0.1, 0.3  # a standing foot turns more slowly, on average over
STANDING_S = 1.5  # longer than a slow walker's foot lies flat
PIECE_PAD_S = 0.6
LOST_SWING_S = 1.5  # beside a silence a swing may be missing
TURNING_RAD = np.deg2rad(20.0)  # in the time of one stride; straight strides turn a foot by up to 5 deg
MIN_TURN_RAD = np.deg2rad(60.0)
ONE_TURN_M = 0.6  # two turns to one side with no more way between them are one
LONGEST_STANCE = 1.2  # of a stride: no foot is longer on the floor in walking
PIVOT_RAD, PIVOT_EDGE = np.deg2rad(10.0), 0.1  # a foot that turned so far has turned, from a tenth to nine tenths of it
MAX_ARC_RAD = np.deg2rad(150.0)
USUAL_STRIDE_S = 1.2  # where no stride shows it


@dataclass(frozen=True, slots=True)
class FootSteps:
    """One foot's swings, ascending: when it left, when it landed, and where to (k,).

    `length_m` is how far it went over the floor, `climb_m` how much higher it came to stand. `turned_s` and
    `heading_rad`, (n, 2): from when to when it turned, in a swing or on the spot, and its direction before and after.
    """

    toe_off_s: FloatArray
    contact_s: FloatArray
    length_m: FloatArray
    climb_m: FloatArray
    turned_s: FloatArray = field(default_factory=lambda: np.empty((0, 2)))
    heading_rad: FloatArray = field(default_factory=lambda: np.empty((0, 2)))


@dataclass(frozen=True, slots=True)
class BodyWay:
    """The body's way on an even clock.

    `time_s`, `way_m`, `heading_rad`: (n,): the way with its turns, the heading to the left, from the first sample on;
    of the foot with samples where the other is silent. `lost_s`: a gap too short for a silence took a swing there.
    """

    time_s: FloatArray
    way_m: FloatArray
    heading_rad: FloatArray
    feet: Mapping[Side, FootSteps]
    silences: tuple[Silence, ...]
    lost_s: tuple[float, ...] = ()

    @property
    def swings_s(self) -> FloatArray:
        """Toe-off and contact (k, 2) of both feet's swings, in order of toe-off."""
        rows = [np.stack([foot.toe_off_s, foot.contact_s], axis=1) for foot in self.feet.values()]
        found = np.concatenate([np.empty((0, 2)), *rows])
        return np.asarray(found[np.argsort(found[:, 0])])

    def way_at(self, time_s: float) -> float:
        """How far the body has come, m."""
        return float(np.interp(time_s, self.time_s, self.way_m))

    def passes_s(self, way_m: float) -> float:
        """When the body has come so far, s; NaN where it never does."""
        if not len(self.way_m) or self.way_m[-1] < way_m:
            return float("nan")
        k = int(np.searchsorted(self.way_m, way_m))
        return float(np.interp(way_m, self.way_m[max(k - 1, 0) : k + 1], self.time_s[max(k - 1, 0) : k + 1]))

    def silences_in(self, start_s: float, end_s: float) -> tuple[Silence, ...]:
        """Those that lie between two instants, in part or whole."""
        return tuple(one for one in self.silences if one.start_s < end_s and one.end_s > start_s)

    def is_whole_in(self, start_s: float, end_s: float) -> bool:
        """Whether every swing between two instants was received, so that the way leads where the body went."""
        is_lost = any(start_s <= at_s <= end_s for at_s in self.lost_s)
        return not is_lost and not self.silences_in(start_s, end_s)

    def cadence_in(self, start_s: float, end_s: float) -> float:
        """Steps per minute while walking, from the median stride; NaN without a stride."""
        times = []
        for foot in self.feet.values():
            inside = foot.contact_s[(foot.contact_s >= start_s) & (foot.contact_s <= end_s)]
            times += [float(t) for t in np.diff(inside) if t < MAX_STRIDE_S]
        return 120.0 / float(np.median(times)) if times else float("nan")


@dataclass(frozen=True, slots=True)
class FootSwings:
    """One foot's swings (k,), ascending: toe-off and contact, the arc of the body's way, and how far it rises.

    `turned_s` and `heading_rad`, (n, 2), n >= k: of each swing, and of each time that the foot turned on the spot,
    which is no swing; the heading goes on from one to the next.
    """

    toe_off_s: FloatArray
    contact_s: FloatArray
    arc_m: FloatArray
    climb_m: FloatArray
    turned_s: FloatArray
    heading_rad: FloatArray

    @property
    def ended_s(self) -> float:
        """When the last of them was over."""
        return float(max(self.contact_s.max(initial=-np.inf), self.turned_s.max(initial=-np.inf)))

    def between(self, from_s: float, to_s: float) -> "FootSwings":
        """The swings and turns that begin after one instant and end before another."""
        rows = (self.toe_off_s > from_s) & (self.contact_s < to_s)
        turns = (self.turned_s[:, 0] > from_s) & (self.turned_s[:, 1] < to_s)
        return FootSwings(
            self.toe_off_s[rows],
            self.contact_s[rows],
            self.arc_m[rows],
            self.climb_m[rows],
            self.turned_s[turns],
            self.heading_rad[turns],
        )


@dataclass(frozen=True, slots=True)
class ReceivedFoot:
    """One foot: from when to when its sensor gave samples; its swings, stretch by stretch, each with its own
    heading."""

    site: Site
    received_s: tuple[tuple[float, float], ...]
    swings: tuple[FootSwings, ...]


def body_way(tracks: SensorTracks, recording: Recording) -> BodyWay:
    """Give the body's way, of up to a quarter of an hour; without foot sensors it has no samples."""
    block = tracks.blocks(recording)[0]
    feet: dict[Side, ReceivedFoot] = {}
    for side in Side:
        site = Site(f"{side}_{Segment.FOOT}")
        if not tracks.is_usable(recording, site):
            continue
        worn = tracks.oriented(recording, site, block)
        is_rigid = side in prosthetic_sides(tracks.session.patient)
        received_s = tuple((one.track.start_s, one.track.end_s) for one in worn)
        pieces = (piece for whole in worn for piece in moving_pieces(whole))
        feet[side] = ReceivedFoot(site, received_s, tuple(swings_of(piece, is_rigid) for piece in pieces))
    return way_of(feet, *tracks.span_of(recording))


def swings_of(one: OrientedTrack, is_rigid: bool) -> FootSwings:
    """The swings of one piece of a foot's track; `is_rigid`: a prosthetic foot."""
    motion = follow(one)
    events = detect_events(motion, one.track.is_measured, is_rigid)
    off_s, on_s = _moments(motion, events)
    heading = _headings(one)
    swung_rad = heading[motion.swings.anchor_after] - heading[motion.swings.anchor_before]
    turned_s, headings = _turnings(motion, np.stack([off_s, on_s], axis=1), heading)
    return FootSwings(off_s, on_s, _arcs(events.length_m, swung_rad), events.climb_m, turned_s, headings)


def way_of(feet: Mapping[Side, ReceivedFoot], start_s: float, end_s: float) -> BodyWay:
    """The body's way from what both feet did; without a foot it has no samples."""
    if not feet:
        nothing = np.empty(0)
        return BodyWay(nothing, nothing, nothing, {}, ())
    time_s = np.arange(start_s, end_s + 0.5 * STEP_S, STEP_S)
    speeds, turnings, silences = [], [], []
    steps: dict[Side, FootSteps] = {}
    for side, foot in feet.items():
        speed, turning = np.full_like(time_s, np.nan), np.full_like(time_s, np.nan)
        for from_s, to_s in foot.received_s:
            received = (time_s >= from_s - STEP_S) & (time_s <= to_s + STEP_S)
            speed[received], turning[received] = 0.0, 0.0
        for swings in foot.swings:
            total_m = np.cumsum(swings.arc_m)
            way_m = np.stack([total_m - swings.arc_m, total_m], axis=1).ravel()
            speed += _rate(time_s, np.stack([swings.toe_off_s, swings.contact_s], axis=1), way_m)
            turning += _rate(time_s, swings.turned_s, swings.heading_rad.ravel())
        names = ("toe_off_s", "contact_s", "arc_m", "climb_m")
        every = {name: [np.empty(0), *(getattr(swings, name) for swings in foot.swings)] for name in names}
        off_s, on_s, length_m, climb_m = (np.concatenate(every[name]) for name in names)
        turned_s = np.concatenate([np.empty((0, 2)), *(swings.turned_s for swings in foot.swings)])
        steps[side] = FootSteps(off_s, on_s, length_m, climb_m, turned_s, _chained(foot.swings))
        silences += _silences(foot, start_s, end_s)
        speeds.append(speed)
        turnings.append(turning)
    # without the rise and fall of speed in each step, which the body has less of than the feet
    stride_s = usual_stride_s(steps)
    way_m = moving_mean(_total(speeds), max(1, round(0.5 * stride_s / STEP_S)))
    lost_s = tuple(at_s for side, foot in feet.items() for at_s in _lost(foot, steps[side], stride_s))
    return BodyWay(time_s, way_m, _total(turnings), steps, tuple(silences), lost_s)


def _lost(foot: ReceivedFoot, steps: FootSteps, stride_s: float) -> list[float]:
    """When a gap took a swing: the foot seems to stand for longer than a stride around it."""
    lost = []
    for (_, gap_s), (again_s, _) in pairwise(foot.received_s):
        landed = steps.contact_s[steps.contact_s <= again_s]
        left = steps.toe_off_s[steps.toe_off_s >= gap_s]
        if len(landed) and len(left) and left[0] - landed[-1] > LONGEST_STANCE * stride_s:
            lost.append(gap_s)
    return lost


def _chained(swings: tuple[FootSwings, ...]) -> FloatArray:
    """The headings (n, 2) of all pieces, each going on from the one before: a standing foot does not turn."""
    parts: list[FloatArray] = [np.empty((0, 2))]
    for one in swings:
        if len(one.heading_rad):
            last = parts[-1][-1, 1] if len(parts[-1]) else 0.0
            parts.append(one.heading_rad - one.heading_rad[0, 0] + last)
    return np.concatenate(parts)


def moving_pieces(whole: OrientedTrack) -> list[OrientedTrack]:
    """A foot's track from each long standing to the next, with a little of both."""
    track = whole.track
    speed = moving_mean(np.linalg.norm(track.gyr_rad_s, axis=1), max(1, round(CALM_S / track.step_s)))
    moving = np.flatnonzero(speed > MOVING_RAD_S)
    if not len(moving):
        return []
    cuts = np.flatnonzero(np.diff(moving) * track.step_s > STANDING_S)
    begins, ends = moving[[0, *(cuts + 1).tolist()]], moving[[*cuts.tolist(), -1]]
    pad = round(PIECE_PAD_S / track.step_s)
    rows = [slice(max(0, int(a) - pad), int(b) + pad + 1) for a, b in zip(begins, ends, strict=True)]
    return [_piece(whole, row) for row in rows]


def _piece(whole: OrientedTrack, row: slice) -> OrientedTrack:
    track = whole.track
    part = replace(
        track,
        start_s=track.start_s + track.step_s * row.start,
        gyr_rad_s=track.gyr_rad_s[row],
        acc_m_s2=track.acc_m_s2[row],
        mag=None,
        q_device=None,
        is_measured=track.is_measured[row],
    )
    return OrientedTrack(part, whole.q_earth_from_sensor[row])


def _moments(motion: FootMotion, events: FootEvents) -> tuple[FloatArray, FloatArray]:
    """When each swing begins and ends (k,), never before the one before it has ended."""
    swings = motion.swings
    off_s = np.where(np.isfinite(events.toe_off_s), events.toe_off_s, motion.time_of(swings.anchor_before + 0.0))
    on_s = np.where(
        np.isfinite(events.initial_contact_s), events.initial_contact_s, motion.time_of(swings.anchor_after + 0.0)
    )
    knots = np.maximum.accumulate(np.stack([off_s, np.maximum(on_s, off_s + 1e-3)], axis=1).ravel())
    return knots[::2], knots[1::2]


def _rate(time_s: FloatArray, spans_s: FloatArray, values: FloatArray) -> FloatArray:
    """The rate (n,) of what has `values` (2 k,) at the beginning and end of each span (k, 2), evenly in between."""
    if not len(spans_s):
        return np.zeros_like(time_s)
    return np.asarray(np.diff(np.interp(time_s, spans_s.ravel(), values), prepend=values[0]) / STEP_S)


def _headings(one: OrientedTrack) -> FloatArray:
    """How far the foot has turned about the vertical (n,), rad."""
    upward = np.einsum("ni,ni->n", one.earth_from_sensor[:, 2], one.track.gyr_rad_s)
    return np.asarray(np.cumsum(upward) * one.track.step_s)


def _turnings(motion: FootMotion, swings_s: FloatArray, heading: FloatArray) -> tuple[FloatArray, FloatArray]:
    """When a foot turned (n, 2) and its heading (n, 2): in its swings (k, 2), and on the spot beside them."""
    before, after = motion.swings.anchor_before, motion.swings.anchor_after
    spans = list(zip(swings_s.tolist(), np.stack([heading[before], heading[after]], axis=1).tolist(), strict=True))
    ends = zip([0, *after.tolist()], [*before.tolist(), len(heading) - 1], strict=True)
    for begin, end in ends:
        turned_rad = float(heading[end] - heading[begin]) if begin < end else 0.0
        if abs(turned_rad) >= PIVOT_RAD:
            share = (heading[begin : end + 1] - heading[begin]) / turned_rad
            first, last = int(np.argmax(share > PIVOT_EDGE)), int(np.flatnonzero(share < 1.0 - PIVOT_EDGE)[-1])
            at_s = motion.time_of(begin + np.array([first, max(last, first + 1)], dtype=float))
            spans.append((at_s.tolist(), [float(heading[begin]), float(heading[end])]))
    spans.sort()
    times, headings = np.array([one[0] for one in spans]), np.array([one[1] for one in spans])
    return np.maximum.accumulate(times.ravel()).reshape(-1, 2), headings.reshape(-1, 2)


def _arcs(chord_m: FloatArray, turn_rad: FloatArray) -> FloatArray:
    """Lengths (k,) of the arcs under a swing's straight way (k,): a foot that turns cuts off the body's bend."""
    half = 0.5 * np.clip(np.abs(turn_rad), 0.0, MAX_ARC_RAD)
    return np.asarray(chord_m / np.sinc(half / np.pi))


def usual_stride_s(feet: Mapping[Side, FootSteps]) -> float:
    """Give the median time of a stride, s; 1.2 s where no stride shows it."""
    times = np.concatenate([np.empty(0), *(np.diff(foot.contact_s) for foot in feet.values())])
    return float(np.median(times[times < MAX_STRIDE_S])) if np.any(times < MAX_STRIDE_S) else USUAL_STRIDE_S


def _total(rates: list[FloatArray]) -> FloatArray:
    """The integral (n,) of the mean of what is known among rates (n,) each."""
    stacked = np.stack(rates)
    known = np.isfinite(stacked)
    mean = np.where(known, stacked, 0.0).sum(axis=0) / np.maximum(known.sum(axis=0), 1)
    return np.asarray(np.cumsum(mean) * STEP_S)


def _silences(foot: ReceivedFoot, start_s: float, end_s: float) -> list[Silence]:
    edges = [start_s, *(t for span_s in foot.received_s for t in span_s), end_s]
    return [Silence(foot.site, a, b) for a, b in zip(edges[::2], edges[1::2], strict=True) if b - a > SILENCE_S]


def turns_of(way: BodyWay) -> tuple[Turn, ...]:
    """Every turn of 60 deg and more, by the heading over the time of one stride."""
    if not len(way.time_s):
        return ()
    half = max(1, round(0.5 * usual_stride_s(way.feet) / STEP_S))
    padded = np.concatenate([np.full(half, way.heading_rad[0]), way.heading_rad, np.full(half, way.heading_rad[-1])])
    change = padded[2 * half :] - padded[: -2 * half]
    spans: list[tuple[int, int, float]] = []
    for sign in (1.0, -1.0):
        edges = np.flatnonzero(np.diff(np.concatenate([[0], sign * change > TURNING_RAD, [0]]).astype(np.int8)))
        spans += [(int(a), int(b) - 1, sign) for a, b in zip(edges[::2], edges[1::2], strict=True)]
    joined: list[tuple[int, int, float]] = []
    for begin, end, sign in sorted(spans):
        if joined and joined[-1][2] == sign and way.way_m[begin] - way.way_m[joined[-1][1]] < ONE_TURN_M:
            joined[-1] = (joined[-1][0], end, sign)
        else:
            joined.append((begin, end, sign))
    found = []
    for begin, end, _ in joined:
        inner = way.heading_rad[max(0, begin - half)], way.heading_rad[min(len(way.time_s) - 1, end + half)]
        angle = float(inner[1] - inner[0])
        if abs(angle) >= MIN_TURN_RAD:
            found.append(Turn(float(way.time_s[begin]), float(way.time_s[end]), angle))
    return tuple(found)


def pauses_of(way: BodyWay) -> tuple[tuple[float, float], ...]:
    """Give contact to toe-off, in s, wherever both feet stood for a second between two steps and did not turn."""
    swings = way.swings_s
    landed = np.maximum.accumulate(swings[:, 1]) if len(swings) else np.empty(0)
    turned = sorted((a, b) for foot in way.feet.values() for a, b in foot.turned_s.tolist())
    found = []
    for landed_s, off_s in zip(landed[:-1].tolist(), swings[1:, 0].tolist(), strict=True):
        edges = [landed_s, *(t for a, b in turned if landed_s < a and b < off_s for t in (a, b)), off_s]
        for from_s, to_s in zip(edges[::2], edges[1::2], strict=True):
            is_received = not way.silences_in(from_s - LOST_SWING_S, to_s + LOST_SWING_S)
            if to_s - from_s >= STILL_S and is_received:
                found.append((from_s, to_s))
    return tuple(found)


def start_of(way: BodyWay) -> tuple[float, float]:
    """Give the first contact after both feet stood for 1 s and its swing's toe-off, in s; NaN without one."""
    swings = way.swings_s
    if len(swings):
        landed = np.concatenate([way.time_s[:1], np.maximum.accumulate(swings[:-1, 1])])
        still = np.flatnonzero(swings[:, 0] - landed >= STILL_S)
        if len(still):
            first = swings[still[0]]
            return float(first[1]), float(first[0])
    return float("nan"), float("nan")


def laps_between(turns: tuple[Turn, ...], start_s: float, end_s: float) -> tuple[tuple[float, float], ...]:
    """Give the laps from the middle of one turn to the next, in s, the last one as far as it came."""
    inner = [turn.middle_s for turn in turns if turn.is_about and start_s < turn.middle_s < end_s]
    return tuple(pairwise([start_s, *inner, end_s]))
