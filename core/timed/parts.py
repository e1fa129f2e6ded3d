"""The parts of an up and go: rise, way out, turn, way back, turn to sit, sit; when each begins and ends.

A rise is from the thighs' having left the seat by a tenth of the way to standing until they are a tenth from it; a
sitting the same the other way round. A turn is from when the body has turned by a tenth of the turn's angle to when a
tenth is left; the turn to sit lasts until the sitting begins, also of who waits or sits down while still
turning. The ways out and back are what lies between. So the parts follow each other, and together are the test's time.

These borders are our own. Published ones use the trunk, where no sensor of ours need be: Salarian et al. 2010 (doi
10.1109/TNSRE.2010.2047606) separate sit-to-stand, gait, turn and turn-to-sit, the last two as one; so their times are
not ours.

How far the body has turned is read from the feet, in the middle of each stance: there a foot points as the body does.
Between stances it is interpolated. As feet also point to either side, half of what counts is a smooth turn fitted to
all stances. On 200 simulated courses of 3 m the feet's directions vary by 1 to 4 deg and lag by up to 0.1 s; that, and
no rule that was tried, limits how exact the turns are (`tests.validation.timed_courses`).
"""

import math

import numpy as np
from scipy.interpolate import PchipInterpolator
from scipy.optimize import least_squares
from scipy.special import erf

from core.samples import FloatArray
from core.timed.found import PartOfUpAndGo, Turn, UpAndGoPart
from core.timed.seat import SeatMotions
from core.timed.way import BodyWay, FootSteps, usual_stride_s

STEP_S = 0.01
EDGE_SHARE = 0.1  # of a turn's angle
OVER_FOOT_SHARE = 0.3  # of a stride after its contact the body is over the foot
LONG_STANCE_SHARE = 0.75  # of a stride: a stance as long is standing, and has no middle that counts
REST_STRIDES = 1.0  # beside the first and the last stance nothing turns any more
FEET_RAD = 0.05  # by so much a standing foot points another way than the body
FIT_FROM = 4  # stances; fewer show no smooth turn


def parts_of(
    way: BodyWay, seat: SeatMotions, turns: tuple[Turn | None, Turn | None], start_s: float, end_s: float
) -> tuple[UpAndGoPart, ...]:
    """Give all six parts of a test from `start_s` to `end_s`, from its turn at the cone and the one before the seat."""
    unknown = (math.nan, math.nan)
    rise = next(((a.left_seat_s, a.upright_s) for a in seat.rises if start_s <= a.left_seat_s < end_s), unknown)
    sits = [(a.left_upright_s, a.seated_s) for a in seat.sittings if start_s < a.seated_s <= end_s]
    sit = sits[-1] if sits else unknown
    out, about = turn_edges(way, turns)
    borders = {
        PartOfUpAndGo.RISE: rise,
        PartOfUpAndGo.WALK_OUT: (rise[1], out[0]),
        PartOfUpAndGo.TURN: out,
        PartOfUpAndGo.WALK_BACK: (out[1], about[0]),
        PartOfUpAndGo.TURN_TO_SIT: (about[0], max(about[0], sit[0]) if sits else about[1]),
        PartOfUpAndGo.SIT: sit,
    }
    return tuple(UpAndGoPart(part, *borders[part]) for part in PartOfUpAndGo)


def turn_edges(way: BodyWay, turns: tuple[Turn | None, Turn | None]) -> tuple[tuple[float, float], tuple[float, float]]:
    """When each of two turns begins and ends, in s; NaN where there is none, or no stance shows it."""
    unknown = (math.nan, math.nan)
    first, last = turns
    known = [one for one in turns if one is not None]
    time_s, heading = _stances(way, known[0].start_s) if known else (np.empty(0), np.empty(0))
    if len(time_s) < 2:
        return unknown, unknown
    between_s = 0.5 * (first.end_s + last.start_s) if first and last else math.inf if first else -math.inf
    is_out = time_s < between_s
    return (
        _edges(time_s[is_out], heading[is_out], first) if first else unknown,
        _edges(time_s[~is_out], heading[~is_out], last) if last else unknown,
    )


def _stances(way: BodyWay, turn_s: float) -> tuple[FloatArray, FloatArray]:
    """When the body is over each standing foot (n,), ascending, and where that points, rad, straight on 0."""
    stride_s = usual_stride_s(way.feet)
    times: list[FloatArray] = [np.empty(0)]
    headings: list[FloatArray] = [np.empty(0)]
    for foot in way.feet.values():
        if len(foot.heading_rad):
            time_s, heading = _stances_of(foot, stride_s)
            straight = (time_s < turn_s) & (time_s > time_s[0])
            heading = heading - float(np.median(heading[straight]) if np.any(straight) else heading[0])
            times.append(time_s)
            headings.append(heading)
    time_s, heading = np.concatenate(times), np.concatenate(headings)
    order = np.argsort(time_s, kind="stable")
    time_s, heading = time_s[order], heading[order]
    apart = np.concatenate([[True], np.diff(time_s) > STEP_S]) if len(time_s) else np.empty(0, bool)
    return time_s[apart], heading[apart]


def _stances_of(foot: FootSteps, stride_s: float) -> tuple[FloatArray, FloatArray]:
    """The middle of each stance; both ends of a long one, in which the body may turn on."""
    over_s = OVER_FOOT_SHARE * stride_s
    from_s = np.concatenate([foot.turned_s[:1, 0] - 2.0 * over_s, foot.turned_s[:, 1]])
    to_s = np.append(foot.turned_s[:, 0], foot.turned_s[-1:, 1] + 2.0 * over_s)
    is_long = to_s - from_s > LONG_STANCE_SHARE * stride_s
    first_s = np.where(is_long, from_s + over_s, 0.5 * (from_s + to_s))
    heading = np.append(foot.heading_rad[:1, 0], foot.heading_rad[:, 1])
    return np.append(first_s, to_s[is_long] - over_s), np.append(heading, heading[is_long])


def _edges(time_s: FloatArray, heading: FloatArray, turn: Turn) -> tuple[float, float]:
    """When a tenth and nine tenths of a turn are done."""
    if len(time_s) < 2:
        return math.nan, math.nan
    before, after = heading[time_s < turn.start_s], heading[time_s > turn.end_s]
    begin = float(np.median(before)) if len(before) else float(heading[0])
    end = float(np.median(after)) if len(after) else float(np.mean(heading[-2:]))
    rest_s = max(REST_STRIDES, turn.end_s - turn.start_s)
    clock = np.arange(time_s[0] - rest_s, time_s[-1] + rest_s, STEP_S)
    knots_s = np.concatenate([[time_s[0] - rest_s], time_s, [time_s[-1] + rest_s]])
    knots = np.concatenate([heading[:1], heading, heading[-1:]])
    share = (PchipInterpolator(knots_s, knots)(clock) - begin) / (end - begin)
    if len(time_s) >= FIT_FROM:
        share = 0.5 * (share + _smooth_turn(time_s, (heading - begin) / (end - begin), turn, clock))
    middle = int(np.searchsorted(clock, turn.middle_s))
    early = np.flatnonzero(share[:middle] < EDGE_SHARE)
    late = np.flatnonzero(share[middle:] > 1.0 - EDGE_SHARE)
    return (
        float(clock[early[-1]]) if len(early) else math.nan,
        float(clock[middle + late[0]]) if len(late) else math.nan,
    )


def _smooth_turn(time_s: FloatArray, share: FloatArray, turn: Turn, clock: FloatArray) -> FloatArray:
    """The turn (n,) on `clock` that fits the stances' shares (k,) best: fast in its middle, slow at both ends."""

    def turned(about: FloatArray, at_s: FloatArray) -> FloatArray:
        begin, end, middle_s, lasts_s = about
        return np.asarray(begin + (end - begin) * 0.5 * (1.0 + erf((at_s - middle_s) / lasts_s)))

    def off(about: FloatArray) -> FloatArray:
        return (turned(about, time_s) - share) * abs(turn.angle_rad) / FEET_RAD

    fit = least_squares(off, [0.0, 1.0, turn.middle_s, 0.4 * (turn.end_s - turn.start_s)], loss="soft_l1")
    middle_s, lasts_s = fit.x[2:]
    return turned(np.array([0.0, 1.0, middle_s, abs(lasts_s)]), clock)
