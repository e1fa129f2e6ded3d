"""Straps that slipped: a sensor that turned about its limb no longer sees the joint's axis where it was.

In walking the axis found from a few strides wanders by ten degrees and more, for tissue and turns move it, but it does
so alike in both sensors of the joint. What one of them has turned against the other about the limb stays within two or
three degrees, and jumps when a strap slips.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from core.body import Joint, Segment, Side, Site, ankle_of, knee_of
from core.calibration.joint_axis import loss_and_weights, residuals
from core.calibration.rest import rest_of
from core.samples import FloatArray, ImuBlock, IntArray
from core.session import Recording
from core.signal.datasets import Datasets, gather
from core.signal.pair import Pair
from core.signal.robust import robust_sd
from core.signal.rotations import angle_between, joint_frame
from core.signal.sensors import SensorTracks
from core.timed.protocols import TimedProtocol

WINDOW_S = 5.0  # some four strides
SAMPLES_PER_S = 10.0
MIN_MOVING_S = 2.5  # of each window
RATE_SCALE_RAD_S, NEUTRAL_SCALE_RAD = 0.5, np.deg2rad(10.0)  # off-axis rate and parting of the axes of real walking
# of the turn from window to window: up to 2 deg in simulated walking with tissue as loose as real one, 3 in a real walk
SCATTER_RAD, FEW_SCATTER_RAD = np.deg2rad(1.8), np.deg2rad(3.0)
SIGMAS = 4.0
MIN_USUAL_WINDOWS, WELL_KNOWN_WINDOWS = 2, 4
WINDOWS_OF_SLIP = 2  # one may be a turn
MIN_SLIP_SINCE_CALIBRATION_RAD = np.deg2rad(14.0)  # functional axes of free motion and of walking differ by half of it
MAX_REFUTED_RAD = np.deg2rad(11.0)  # turns and tissue alone look like as much at an ankle
MIN_GRAVITY_SHARE = 0.15
MIN_SHARE = 0.4  # of the knee's turn that the ankle shows too, when the shank's sensor slipped


@dataclass(frozen=True, slots=True)
class Turns:
    """How far the distal sensor of a joint has turned against the proximal one about the vertical, window by window.

    `time_s` (w,) is each window's start, `turn_rad` (w,) the turn since the calibration.
    """

    time_s: FloatArray
    turn_rad: FloatArray

    def between(self, from_s: float, to_s: float) -> "Turns":
        """The windows that start from the one time on and before the other."""
        is_meant = (self.time_s >= from_s) & (self.time_s < to_s)
        return Turns(self.time_s[is_meant], self.turn_rad[is_meant])


def joined_turns(parts: Sequence[Turns]) -> Turns:
    """Turns of one joint, laid end to end."""
    if not parts:
        return Turns(np.empty(0), np.empty(0))
    return Turns(np.concatenate([part.time_s for part in parts]), np.concatenate([part.turn_rad for part in parts]))


@dataclass(frozen=True, slots=True)
class Slip:
    """`from_s` is the start of the first window in which `site` was turned by `turn_rad`."""

    site: Site
    from_s: float
    turn_rad: float

    @property
    def sure_until_s(self) -> float:
        """A slip late in a window hardly moves that window's turn, so the one before `from_s` may hold it already."""
        return self.from_s - WINDOW_S


def turns_over(pair: Pair, axis_1: FloatArray, axis_2: FloatArray) -> Turns:
    """Find turns, rad, per window of walking: the difference of one Gauss-Newton step from the axes (3,)."""
    index = np.flatnonzero(pair.is_moving & pair.is_known)[:: max(1, round(1 / (SAMPLES_PER_S * pair.step_s)))]
    number = ((pair.time_s[index] - pair.time_s[0]) / WINDOW_S).astype(np.int64)
    windows, counts = np.unique(number, return_counts=True)
    windows = windows[counts >= MIN_MOVING_S * min(SAMPLES_PER_S, 1 / pair.step_s)]
    is_used = np.isin(number, windows)
    if not len(windows):
        return joined_turns(())
    data = gather((pair,), [index[is_used]])
    first = np.searchsorted(number[is_used], windows)
    return Turns(pair.time_s[0] + WINDOW_S * windows, _turns(data, first, axis_1, axis_2))


def _turns(data: Datasets, first: IntArray, axis_1: FloatArray, axis_2: FloatArray) -> FloatArray:
    """Turns (w,) of the windows that begin at samples `first` (w,)."""
    lengths = np.diff([*first, len(data)])
    flat_1, flat_2 = ((turn @ axis)[:, :2] for turn, axis in ((data.earth_from_1, axis_1), (data.earth_from_2, axis_2)))
    product = (flat_1 @ [1, 1j]) * (flat_2 @ [1, -1j])
    heading = np.repeat(np.angle(np.add.reduceat(product, first)), lengths)
    found = residuals(data, axis_1[None], axis_2[None], heading[None], RATE_SCALE_RAD_S, NEUTRAL_SCALE_RAD)
    weight = loss_and_weights(found.value)[1][0]
    slopes = np.concatenate([found.by_axes[0], found.by_heading[0][..., None]], axis=-1)
    matrix = np.add.reduceat(np.einsum("nr,nri,nrj->nij", weight, slopes, slopes), first)
    gradient = np.add.reduceat(np.einsum("nr,nri->ni", weight * found.value[0], slopes), first)
    step = -np.linalg.solve(matrix + 1e-3 * np.eye(5), gradient[..., None])[..., 0]
    return _about_vertical(data, first, lengths, heading, (axis_1, axis_2), step)


def _about_vertical(
    data: Datasets,
    first: IntArray,
    lengths: IntArray,
    heading: FloatArray,
    axes: tuple[FloatArray, FloatArray],
    step: FloatArray,
) -> FloatArray:
    """What of each step (w, 5) turns the one axis in its limb against the other about the vertical, (w,)."""

    def horizontal(turns: FloatArray, vector: FloatArray, by: FloatArray) -> FloatArray:
        flat = (turns @ vector)[:, :2] @ [1, 1j] * np.exp(1j * by)
        return np.add.reduceat(flat, first) / lengths

    still = np.zeros_like(heading)
    along = horizontal(data.earth_from_1, axes[0], still)
    left = 1j * along / np.abs(along)  # horizontal, square to the axis
    turn = np.zeros(len(first))
    for sign, turns, axis, by, at in (
        (-1.0, data.earth_from_1, axes[0], still, 0),
        (1.0, data.earth_from_2, axes[1], heading, 2),
    ):
        for k, tangent in enumerate(joint_frame(axis)):
            turn += sign * step[:, at + k] * np.real(horizontal(turns, tangent, by) * np.conj(left))
    return turn


def slips(turns: Mapping[Joint, Turns], since_calibration_rad: float = MIN_SLIP_SINCE_CALIBRATION_RAD) -> list[Slip]:
    """Find each side's first strap slip by turns of knee and ankle; a great turn at the start is one before."""
    found = []
    for side in Side:
        mine = [turns.get(joint) for joint in (knee_of(side), ankle_of(side))]
        jumps = [_start_of_jump(one, since_calibration_rad) for one in mine if one is not None]
        starts = [start for start in jumps if start is not None]
        if starts:
            found.append(_named(side, min(starts), mine))
    return found


def slips_in_walks(
    tracks: SensorTracks,
    walks: Sequence[Recording],
    turns_of: Mapping[Joint, Mapping[str, Turns]],
    *,
    are_axes_published: bool,
) -> list[tuple[Recording, Slip]]:
    """Find slips in walks of one calibration, in order of time on each walk's own clock.

    `turns_of` has each joint's turns by the name of the walk in which it was measured.
    """
    starts_s = np.cumsum([0.0, *(last - first for first, last in map(tracks.span_of, walks))])
    turns = {}
    for joint, measured in turns_of.items():
        parts = []
        for walk, start_s in zip(walks, starts_s[:-1], strict=True):
            if walk.name in measured and not _is_in_place(walk):
                offset_s = start_s - tracks.span_of(walk)[0]  # the walks are laid end to end
                parts.append(Turns(measured[walk.name].time_s + offset_s, measured[walk.name].turn_rad))
        if parts:
            turns[joint] = joined_turns(parts)
    located = []
    # axes as published lie tens of degrees off in some walks, which is no slip
    for slip in slips(turns, np.inf if are_axes_published else MIN_SLIP_SINCE_CALIBRATION_RAD):
        k = int(np.searchsorted(starts_s[1:-1], slip.from_s, side="right"))
        from_s = slip.from_s - starts_s[k] + tracks.span_of(walks[k])[0]
        found_slip = replace(slip, from_s=from_s)
        if not is_refuted(tracks, walks[k], found_slip):
            located.append((walks[k], found_slip))
    return located


def _is_in_place(walk: Recording) -> bool:
    """Whether nobody walks in it: rising bends knees so far that the tissue turns a sensor as a slip would."""
    # a strap that slips meanwhile shows in the next walk
    return walk.test is not None and walk.test.protocol is TimedProtocol.SIT_TO_STAND


def is_refuted(tracks: SensorTracks, walk: Recording, slip: Slip) -> bool:
    """Whether gravity at rest, unchanged, refutes a small turn of a foot's sensor; False for thigh and shank."""
    if slip.site.segment is not Segment.FOOT or abs(slip.turn_rad) > MAX_REFUTED_RAD:
        return False
    block, first = walk.imu[slip.site], tracks.span.index(walk)
    cut = np.searchsorted(block.time_s, [slip.sure_until_s, slip.from_s + WINDOW_S])
    parts = [_rows(block, rows) for rows in (slice(None, int(cut[0])), slice(int(cut[1]), None))]
    before = [rest_of(parts[0]), *(tracks.rest(r, slip.site) for r in reversed(tracks.span[:first]))]
    after = [rest_of(parts[1]), *(tracks.rest(r, slip.site) for r in tracks.span[first + 1 :])]
    rests = [next((rest for rest in side if rest is not None), None) for side in (before, after)]
    if rests[0] is None or rests[1] is None:
        return False
    return angle_between(rests[0].acc_m_s2, rests[1].acc_m_s2) < MIN_GRAVITY_SHARE * abs(slip.turn_rad)


def _rows(block: ImuBlock, rows: slice) -> ImuBlock:
    return ImuBlock(block.sensor, block.time_s[rows], block.gyr_rad_s[rows], block.acc_m_s2[rows])


def _start_of_jump(turns: Turns, since_calibration_rad: float) -> float | None:
    """When a joint's turn leaves what was usual before; None where it does not."""
    turn = turns.turn_rad
    for k in range(len(turn) - WINDOWS_OF_SLIP + 1):
        limit, before = since_calibration_rad, turn[:k]
        if k >= MIN_USUAL_WINDOWS:
            scatter = robust_sd(before - np.median(before))
            limit = SIGMAS * max(scatter, SCATTER_RAD if k >= WELL_KNOWN_WINDOWS else FEW_SCATTER_RAD)
        away = turn[k : k + WINDOWS_OF_SLIP] - _usual(before)
        if np.all(away > limit) or np.all(away < -limit):
            return float(turns.time_s[k])
    return None


def _usual(before: FloatArray) -> float:
    return float(np.median(before)) if len(before) >= MIN_USUAL_WINDOWS else 0.0


def _named(side: Side, from_s: float, turns: list[Turns | None]) -> Slip:
    knee, ankle = (0.0 if one is None else _change(one, from_s) for one in turns)
    if knee * ankle < 0 and min(abs(knee), abs(ankle)) > MIN_SHARE * max(abs(knee), abs(ankle)):
        return Slip(Site(f"{side}_{Segment.SHANK}"), from_s, knee)
    if abs(knee) > abs(ankle):
        return Slip(Site(f"{side}_{Segment.THIGH}"), from_s, -knee)
    return Slip(Site(f"{side}_{Segment.FOOT}"), from_s, ankle)


def _change(turns: Turns, from_s: float) -> float:
    first = int(np.searchsorted(turns.time_s, from_s - 0.5 * WINDOW_S))
    # the first window may hold the slip itself
    now = turns.turn_rad[first + 1 : first + 1 + WINDOWS_OF_SLIP]
    return float(np.median(now)) - _usual(turns.turn_rad[:first]) if len(now) else 0.0
