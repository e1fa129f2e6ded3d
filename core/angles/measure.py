"""Twist of a joint over a whole recording, once the axes of its two sensors are known.

Everything here is still the bare twist (distal against proximal segment about the joint axis), without clinical sign
and zero; `analysis` turns it. Long recordings are worked through in blocks.
"""

from dataclasses import dataclass

import numpy as np

from core.angles.hinge_angle import hinge_angle, hinge_angle_and_sd
from core.angles.twist import off_axis_rate, ringing, twist
from core.body import Joint
from core.calibration.heading import heading_over
from core.calibration.strap import Turns, joined_turns, turns_over
from core.calibration.zero import within_half_a_turn
from core.gait.inclination import lean_about
from core.published.angles import angle_from_orientations, published_angle
from core.samples import FloatArray
from core.session import Recording, RecordingKind
from core.signal.orientation import oriented_to_north
from core.signal.pair import OrientedTrack, Pair, is_turning, pair_up
from core.signal.rotations import wrap
from core.signal.sensors import SensorTracks
from core.signal.tracks import Block, at_positions

MIN_KNOWN_S = 0.5
REMEMBERED_PAIRS = 4  # of at most ten minutes each: a joint is identified, then measured
BROKEN_SD_RAD = np.deg2rad(2.0)  # measured on simulated walks with lost samples, in stretches of up to
SETTLED_S = 5.0
WITNESS_STEP_S = 0.05  # the statistics behind sign and certainty need no more


@dataclass(frozen=True, slots=True)
class Geometry:
    """What measuring needs: axes (3,), centres (3,), the distal clock's lag, the time constant of eq 15.

    `unknowns` (12,): centres o1, o2 and accelerometer biases b1, b2 as they were fitted together.
    """

    axis_1: FloatArray
    axis_2: FloatArray
    centre_1_m: FloatArray
    centre_2_m: FloatArray
    lag_s: float
    tau_s: float
    unknowns: FloatArray
    is_hinge: bool


@dataclass(frozen=True, slots=True)
class Twist:
    """One joint over one recording. Angles (n,) on the recording's clock, radians, NaN where unknown, without jumps.

    `added_sd_rad` (n,) is what adds to the uncertainty here and there: a hinge's drift, and gaps, for an orientation
    that starts again amid a movement has to find the vertical first. The others are thinned samples (m, ...) while the
    joint's segments move: the angle, and each sensor's own rate about its own axis; and, of those of them at which they
    turn (`is_turning`), all of the off-axis rate and what of it is above 3 Hz.
    `strap_turns` are those of a walk's windows; of another recording there are none.
    `lean_1_rad`, `lean_2_rad` (n,): how both segments stand to the vertical, as `lean_about` has it; of knees only.
    """

    twist_rad: FloatArray
    published_rad: FloatArray
    orientation_rad: FloatArray | None
    added_sd_rad: FloatArray
    moving_twist: FloatArray
    moving_off_axis: FloatArray
    moving_ringing: FloatArray
    moving_rate_1: FloatArray
    moving_rate_2: FloatArray
    strap_turns: Turns
    lean_1_rad: FloatArray | None = None
    lean_2_rad: FloatArray | None = None


def pairs_of(tracks: SensorTracks, recording: Recording, joint: Joint, block: Block, lag_s: float) -> list[Pair]:
    """Pair one block's stretches in order of time on the proximal clock; `lag_s` is added to distal stamps."""
    key = (recording.name, joint, lag_s)
    if block.number or key not in tracks.pairs:
        proximal, distal = (tracks.oriented(recording, site, block) for site in (joint.proximal, joint.distal))
        pairs = paired(proximal, distal, lag_s)
        if block.number:
            return pairs
        while len(tracks.pairs) >= REMEMBERED_PAIRS:
            del tracks.pairs[next(iter(tracks.pairs))]
        tracks.pairs[key] = pairs
    return tracks.pairs[key]


def paired(proximal: list[OrientedTrack], distal: list[OrientedTrack], lag_s: float) -> list[Pair]:
    """Pair stretches in order of time on the proximal clock; `lag_s` is added to distal stamps."""
    pairs = [pair_up(one, two, lag_s) for one in proximal for two in distal]
    return [pair for pair in pairs if pair is not None]


def measure(
    tracks: SensorTracks,
    recording: Recording,
    joint: Joint,
    geometry: Geometry,
    time_s: FloatArray,
    clock_offset_s: float,
) -> Twist:
    """Measure one joint at ascending stamps (n,); NaN: unknown. The offset leads from the proximal clock."""
    names = ("twist", "published", "orientation", "added_sd", *(("lean_1", "lean_2") if joint.is_knee else ()))
    angles = {name: np.full(len(time_s), np.nan) for name in names}
    witnesses: list[tuple[FloatArray, ...]] = []
    turns: list[Turns] = []
    j1, j2 = geometry.axis_1, geometry.axis_2
    for block in tracks.blocks(recording):
        pairs = [p for p in pairs_of(tracks, recording, joint, block, geometry.lag_s) if is_anchored(p)]
        for pair in pairs:
            heading = heading_over(pair, j1, j2, geometry.unknowns)
            fused = published_angle(pair, j1, j2, geometry.centre_1_m, geometry.centre_2_m, geometry.tau_s)
            if geometry.is_hinge:
                angle, added_sd = hinge_angle_and_sd(pair, j1, j2, geometry.unknowns)
            else:
                angle, added_sd = twist(pair, j1, j2, heading), np.zeros(len(pair))
            found = {"twist": angle, "published": -fused, "added_sd": added_sd}
            if joint.is_knee:
                found["lean_1"] = lean_about(j1, pair.earth_from_1[:, 2])
                found["lean_2"] = lean_about(j2, pair.earth_from_2[:, 2])
            if len(pairs) > 1:
                share = min(1.0, (SETTLED_S / pair.duration_s) ** 2)
                found["added_sd"] = np.hypot(added_sd, share * BROKEN_SD_RAD)
                if not geometry.is_hinge:  # the joint's accelerations know better than two filters that have just begun
                    angle += share * float(np.median(wrap(hinge_angle(pair, j1, j2, geometry.unknowns) - angle)))
            for name, values in found.items():
                place(angles[name], values, pair, time_s, clock_offset_s, block)
            chosen = np.flatnonzero(pair.is_moving & pair.is_measured)[:: max(1, round(WITNESS_STEP_S / pair.step_s))]
            turning = chosen[is_turning(pair.g1, pair.g2)[chosen]]
            off_axis = off_axis_rate(pair, j1, heading)
            rung, rates = ringing(off_axis, pair.step_s)[turning], (pair.g1[chosen] @ j1, pair.g2[chosen] @ j2)
            witnesses.append((found["twist"][chosen], off_axis[turning], rung, *rates))
            if recording.kind is RecordingKind.WALKING:
                turns.append(turns_over(pair, j1, j2).between(block.core_from_s, block.core_to_s))
        for pair in _north_pairs(tracks, recording, joint, block, geometry.lag_s):
            values = np.unwrap(-angle_from_orientations(pair.earth_from_1, pair.earth_from_2, j1, j2))
            place(angles["orientation"], values, pair, time_s, clock_offset_s, block)
    joined = [np.concatenate(parts) for parts in zip(*witnesses, strict=True)] if witnesses else []
    for name in ("twist", "published", "orientation"):
        unwrap_over_gaps(angles[name])
    return Twist(
        twist_rad=angles["twist"],
        published_rad=angles["published"],
        orientation_rad=angles["orientation"] if np.isfinite(angles["orientation"]).any() else None,
        added_sd_rad=np.nan_to_num(angles["added_sd"]),
        moving_twist=within_half_a_turn(joined[0]) if joined else np.empty(0),
        moving_off_axis=joined[1] if joined else np.empty((0, 2)),
        moving_ringing=joined[2] if joined else np.empty((0, 2)),
        moving_rate_1=joined[3] if joined else np.empty(0),
        moving_rate_2=joined[4] if joined else np.empty(0),
        strap_turns=joined_turns(turns),
        lean_1_rad=angles.get("lean_1"),
        lean_2_rad=angles.get("lean_2"),
    )


def is_anchored(pair: Pair) -> bool:
    """Whether enough of a stretch is known to say what its angle is."""
    return int(np.count_nonzero(pair.is_known)) * pair.step_s >= MIN_KNOWN_S


def _north_pairs(tracks: SensorTracks, recording: Recording, joint: Joint, block: Block, lag_s: float) -> list[Pair]:
    sides = []
    for site in (joint.proximal, joint.distal):
        found = [oriented_to_north(one.track) for one in tracks.oriented(recording, site, block)]
        sides.append([one for one in found if one is not None])
    return paired(sides[0], sides[1], lag_s)


def place(
    into: FloatArray, values: FloatArray, pair: Pair, time_s: FloatArray, clock_offset_s: float, block: Block
) -> None:
    """Write a pair's values (m,) into `into` (n,) at the stamps (n,) where both sensors were received."""
    start_s = float(pair.time_s[0]) + clock_offset_s
    first = int(np.searchsorted(time_s, max(start_s - 0.25 * pair.step_s, block.core_from_s)))
    end_s = float(pair.time_s[-1]) + clock_offset_s
    last = int(np.searchsorted(time_s, min(end_s + 0.25 * pair.step_s, block.core_to_s)))
    if last <= first:
        return
    position = np.clip((time_s[first:last] - start_s) / pair.step_s, 0, len(values) - 1)
    whole = np.round(position)
    position = np.where(np.abs(position - whole) < 1e-3, whole, position)
    is_received = pair.is_measured[np.floor(position).astype(int)] & pair.is_measured[np.ceil(position).astype(int)]
    placed = at_positions(values[:, None], position)[:, 0]
    into[first:last] = np.where(is_received, placed, into[first:last])


def unwrap_over_gaps(angle_rad: FloatArray) -> None:
    """Remove jumps of whole turns from an angle (n,) with NaN gaps, in place."""
    received = np.flatnonzero(np.isfinite(angle_rad))
    if len(received):
        angle_rad[received] = np.unwrap(angle_rad[received])
