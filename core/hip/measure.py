"""Angles of hips and pelvis in each recording of one span of validity."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from core.angles.measure import pairs_of, place, unwrap_over_gaps
from core.body import Joint, Side, Site, hip_of, knee_of
from core.calibration.validity import in_force
from core.hip.clocks import HipClocks
from core.hip.frames import heading_of, hip_cardan, pitch_and_roll, seen_from_pelvis, segment_frame
from core.hip.heading import HipFit, fit_hip
from core.hip.results import HipAngle, HipIdentification, PelvisAngles
from core.results import JointCalibration
from core.samples import FloatArray
from core.session import Recording, RecordingKind
from core.signal.pair import Pair
from core.signal.rotations import wrap
from core.signal.sensors import SensorTracks
from core.signal.tracks import Block, at_positions

MAX_3D_SD_RAD = np.deg2rad(6.0)
MIN_MARGIN, MAX_DISAGREEMENT = 1.5, 0.2
SD_RAD, SD_SHARE = np.deg2rad(2.0), 0.1  # of flexion: 2 deg and a tenth of the distance from the median
DEEP_RAD, DEEP_SD_RAD = np.deg2rad(80.0), np.deg2rad(4.0)  # more flexion than this adds so much


@dataclass(frozen=True, slots=True)
class HipFrames:
    """Rows x forward, y left, z up (3, 3) of the pelvis and of both thighs, in their sensors' axes.

    `standing_from` is the recording that gave the verticals.
    """

    pelvis: FloatArray
    thighs: Mapping[Side, FloatArray]
    standing_from: str


@dataclass(frozen=True, slots=True)
class HipsAndPelvis:
    """One recording: hips, the pelvis without its rotation, and its heading (n,), rad, without jumps."""

    hips: Mapping[Joint, HipAngle]
    pelvis: PelvisAngles
    heading_rad: FloatArray


Knees = Mapping[Joint, JointCalibration]


def is_trusted(found: HipFit | HipIdentification) -> bool:
    """Whether both sensors moved as adjacent segments of one hip do, beyond doubt about the heading."""
    return found.margin >= MIN_MARGIN and found.disagreement < MAX_DISAGREEMENT


def is_by_cardan_angles(fit: HipFit) -> bool:
    """Whether its heading is sure enough for Cardan angles, and is one of adjacent segments at all."""
    return fit.sd_rad <= MAX_3D_SD_RAD and is_trusted(fit)


def fits_of(tracks: SensorTracks, recording: Recording, clocks: HipClocks, side: Side) -> list[HipFit | None]:
    """Give a hip's fits in the first block, one per pair of `pairs_of`; None where it hardly moves."""
    if not tracks.is_usable(recording, Site.PELVIS, hip_of(side).distal):
        return []
    block = tracks.blocks(recording)[0]
    return [fit_hip(pair) for pair in pairs_of(tracks, recording, hip_of(side), block, clocks.lag_s.get(side, 0.0))]


def frames_of(
    tracks: SensorTracks,
    recording: Recording,
    knees: Knees,
    clocks: Mapping[str, HipClocks],
    fits: Mapping[tuple[str, Side], list[HipFit | None]],
) -> HipFrames | None:
    """Give one recording's frames by its knees' axes; None without standing, knee or certain heading."""
    thighs: dict[Side, FloatArray] = {}
    seen: list[FloatArray] = []
    up_pelvis, standing_from = None, ""
    for side in Side:
        knee, thigh = knees.get(knee_of(side)), hip_of(side).distal
        standing = in_force(tracks.span, recording, RecordingKind.STANDING, (Site.PELVIS, thigh), tracks.is_usable)
        if knee is None or standing is None:
            continue
        rests = tracks.rest(standing, Site.PELVIS), tracks.rest(standing, thigh)
        if rests[0] is None or rests[1] is None:
            continue
        left = knee.clinical_sign * knee.axis_proximal
        thighs[side] = segment_frame(rests[1].acc_m_s2, left)
        up_pelvis, standing_from = rests[0].acc_m_s2, standing.name
        mean = _seen(tracks, side, thighs[side][1], clocks, fits)
        if mean is not None:
            seen.append(mean)
    if up_pelvis is None or not seen:
        return None
    return HipFrames(segment_frame(up_pelvis, np.sum(seen, axis=0)), thighs, standing_from)


def _seen(
    tracks: SensorTracks,
    side: Side,
    left: FloatArray,
    clocks: Mapping[str, HipClocks],
    fits: Mapping[tuple[str, Side], list[HipFit | None]],
) -> FloatArray | None:
    """Unit direction (3,) of a thigh's y in the pelvis's sensor, over all walks, else all free motions."""
    for kind in (RecordingKind.WALKING, RecordingKind.FREE_MOTION):
        total = np.zeros(3)
        for recording in (one for one in tracks.span if one.kind is kind):
            known = fits.get((recording.name, side), [])
            if not known:
                continue
            lag_s = clocks[recording.name].lag_s.get(side, 0.0)
            pairs = pairs_of(tracks, recording, hip_of(side), tracks.blocks(recording)[0], lag_s)
            for pair, fit in zip(pairs, known, strict=True):
                if fit is not None and is_trusted(fit):
                    some = pair.is_moving & pair.is_known
                    turned = pair.earth_from_1[some], pair.earth_from_2[some], fit.heading(pair)[some]
                    total += fit.moving_s / fit.sd_rad * seen_from_pelvis(*turned, left)
        if np.any(total):
            return np.asarray(total / np.linalg.norm(total))
    return None


def measure_hips(
    tracks: SensorTracks,
    recording: Recording,
    frames: HipFrames,
    clocks: HipClocks,
    fits: Mapping[tuple[str, Side], list[HipFit | None]],
    time_s: FloatArray,
) -> HipsAndPelvis:
    """Measure hips and pelvis at ascending stamps (n,), rad from standing; NaN: unknown."""
    worn = [side for side in frames.thighs if tracks.is_usable(recording, Site.PELVIS, hip_of(side).distal)]
    from_pelvis_s = clocks.from_pelvis_s(worn[0]) if worn else 0.0  # the first thigh gives the recording its clock
    hips = {}
    for side in worn:
        angle = _hip(tracks, recording, frames, side, clocks, fits.get((recording.name, side), []), time_s)
        if angle is not None:
            hips[hip_of(side)] = angle
    return HipsAndPelvis(_with_places(hips, frames), *_pelvis(tracks, recording, frames, time_s, from_pelvis_s))


def _hip(
    tracks: SensorTracks,
    recording: Recording,
    frames: HipFrames,
    side: Side,
    clocks: HipClocks,
    first_fits: list[HipFit | None],
    time_s: FloatArray,
) -> HipAngle | None:
    """One hip on its own leg's clock, as its knee is: where clocks are not known to be one, only its leg's hold."""
    lag_s, from_pelvis_s = clocks.lag_s.get(side, 0.0), clocks.from_pelvis_s(side)
    flexion, abduction = np.full(len(time_s), np.nan), np.full(len(time_s), np.nan)
    known: list[HipFit] = []
    for block in tracks.blocks(recording):
        pairs = pairs_of(tracks, recording, hip_of(side), block, lag_s)
        for k, pair in enumerate(pairs):
            fit = fit_hip(pair) if block.number else first_fits[k]
            if fit is None:
                continue
            known.append(fit)
            angles = _angles(pair, fit, frames, side)
            for into, values in zip((flexion, abduction), angles, strict=True):
                place(into, values, pair, time_s, from_pelvis_s, block)
    if not known:
        return None
    unwrap_over_gaps(flexion)
    longest = max(known, key=lambda fit: fit.moving_s)
    flexion, sd = with_sd(flexion)
    identification = HipIdentification(
        centre_proximal_m=longest.centre_proximal_m,
        centre_distal_m=longest.centre_distal_m,
        margin=longest.margin,
        disagreement=longest.disagreement,
        heading_sd_rad=longest.sd_rad,
        is_3d=is_by_cardan_angles(longest),
        moving_s=longest.moving_s,
        lag_s=lag_s,
        standing_from=frames.standing_from,
        centres_apart_m=None,
        frame_proximal=frames.pelvis,
        frame_distal=frames.thighs[side],
    )
    return HipAngle(flexion, sd, abduction, identification)


def with_sd(flexion_rad: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Bring flexion (n,) within half a turn of standing; sd 2 deg and 10 % from the median, 4 more over 80."""
    received = flexion_rad[np.isfinite(flexion_rad)]
    median = float(np.median(received)) if len(received) else 0.0
    flexion_rad = flexion_rad - 2 * np.pi * np.round(median / (2 * np.pi))
    sd_rad = SD_RAD + SD_SHARE * np.abs(flexion_rad - wrap(np.array(median)))
    return flexion_rad, np.where(flexion_rad > DEEP_RAD, sd_rad + DEEP_SD_RAD, sd_rad)


def _angles(pair: Pair, fit: HipFit, frames: HipFrames, side: Side) -> tuple[FloatArray, FloatArray]:
    """Flexion and abduction (n,) of one stretch: by Cardan angles where its heading is sure, else by the vertical."""
    pelvis, thigh = frames.pelvis, frames.thighs[side]
    if is_by_cardan_angles(fit):
        first, second = hip_cardan(pelvis, thigh, pair.earth_from_1, pair.earth_from_2, fit.heading(pair))
        return -first, second if side is Side.LEFT else -second
    pitch_1, pitch_2 = pitch_and_roll(pelvis, pair.earth_from_1)[0], pitch_and_roll(thigh, pair.earth_from_2)[0]
    return pitch_1 - pitch_2, np.full(len(pair), np.nan)


def _with_places(hips: dict[Joint, HipAngle], frames: HipFrames) -> dict[Joint, HipAngle]:
    """The same, given how far the left hip's centre lies to the left of the right one."""
    if len(hips) < len(Side):
        return hips
    left, right = (-frames.pelvis @ hips[hip_of(side)].identification.centre_proximal_m for side in Side)
    apart_m = float((left - right)[1])
    return {
        joint: replace(hip, identification=replace(hip.identification, centres_apart_m=apart_m))
        for joint, hip in hips.items()
    }


def _pelvis(
    tracks: SensorTracks, recording: Recording, frames: HipFrames, time_s: FloatArray, from_pelvis_s: float
) -> tuple[PelvisAngles, FloatArray]:
    tilt, obliquity, heading = (np.full(len(time_s), np.nan) for _ in range(3))
    for block in tracks.blocks(recording):
        for worn in tracks.oriented(recording, Site.PELVIS, block):
            turned = worn.earth_from_sensor
            values = [*pitch_and_roll(frames.pelvis, turned), heading_of(frames.pelvis, turned)]
            here, position = _positions(
                worn.track.start_s, worn.track.step_s, len(turned), time_s, from_pelvis_s, block
            )
            is_received = worn.track.is_measured[np.round(position).astype(int)]
            for into, found in zip((tilt, obliquity, heading), values, strict=True):
                into[here] = np.where(is_received, at_positions(found[:, None], position)[:, 0], into[here])
    unwrap_over_gaps(heading)
    return PelvisAngles(tilt, obliquity, np.full(len(time_s), np.nan)), heading


def _positions(
    start_s: float, step_s: float, n: int, time_s: FloatArray, offset_s: float, block: Block
) -> tuple[slice, FloatArray]:
    """Which stamps lie in a stretch and in its block's core, and at which fractional samples of it."""
    first_s = max(start_s + offset_s, block.core_from_s)
    last_s = min(start_s + (n - 1) * step_s + offset_s, block.core_to_s)
    here = slice(*np.searchsorted(time_s, [first_s, last_s + 0.25 * step_s]))
    return here, np.clip((time_s[here] - offset_s - start_s) / step_s, 0, n - 1)
