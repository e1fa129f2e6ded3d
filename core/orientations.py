"""Orientation of every sensor in one earth, for programs that take orientations in place of angles.

Without a magnetometer a sensor knows the vertical, not where it faces. Here each sensor faces so that the axis of its
joint points to the left, of the ankle's so that it has the direction that it has in the shank: both legs, the pelvis
and all recordings agree then, and turns about the vertical, which nothing here measures, are taken away.
"""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from core.body import Joint, Segment, Side, Site, ankle_of, hip_of, knee_of
from core.calibration.rate_kind import tracks_of_kind
from core.calibration.validity import spans_of_validity
from core.results import Analysis, JointCalibration, RecordingAnalysis
from core.samples import FloatArray
from core.session import Recording, RecordingKind, Session
from core.signal.rotations import matrix_from_quaternion, quaternions_about_vertical
from core.signal.sensors import SensorTracks
from core.signal.tracks import at_positions, continuous, nominal_step_s
from core.verdicts.quality import look_at

LEFT_RAD = 0.5 * np.pi  # from forward, seen from above
STEEP = 0.5  # of a unit vector: the level part of an axis that stands steeper than 60 deg gives no direction


@dataclass(frozen=True, slots=True)
class SensorOrientations:
    """Of one recording: even stamps (n,) on its clock; earth from sensor (n, 4), scalar first, NaN where unknown.

    Earth has z up and x forward.
    """

    time_s: FloatArray
    q_earth_from_sensor: Mapping[Site, FloatArray]


Joints = Mapping[str, Collection[Joint]]
"""The joints whose axes and signs may be relied on, by the name of a recording."""


def orientations_of(
    session: Session, analysis: Analysis, reported: Joints
) -> Iterator[tuple[Recording, SensorOrientations]]:
    """Give the orientations of every kept recording, of those standing too; no sites where no joint holds them."""
    unusable, analysed = look_at(session).unusable, {one.name: one for one in analysis.recordings}
    for span in spans_of_validity(session):
        tracks, _ = tracks_of_kind(session, span, unusable)
        for recording in span:
            measured = _measured_with(span, recording, analysed)
            if measured is None:
                continue
            sure = reported.get(measured.name, ())
            joints = {joint: one for joint, one in analysis.calibrated_for(measured).items() if joint in sure}
            hips = [hip for hip in measured.hips if hip in sure]
            yield recording, _facing(tracks, recording, measured, joints, hips)


def _measured_with(
    span: tuple[Recording, ...], recording: Recording, analysed: Mapping[str, RecordingAnalysis]
) -> RecordingAnalysis | None:
    """The recording's own analysis; of standing that of the first walk after it, else of any other of its span."""
    if recording.kind is not RecordingKind.STANDING:
        return analysed.get(recording.name)
    after = span.index(recording)
    others = [one for one in (*span[after:], *span[:after]) if one.name in analysed]
    walks = [one for one in others if one.kind is RecordingKind.WALKING]
    return analysed[(walks or others)[0].name] if others else None


def _facing(
    tracks: SensorTracks,
    recording: Recording,
    measured: RecordingAnalysis,
    joints: Mapping[Joint, JointCalibration],
    hips: Collection[Joint],
) -> SensorOrientations:
    """The sensors of a leg whose joint's axis is known, one after the other; then the pelvis."""
    found: dict[Site, FloatArray] = {}
    sites = [site for site in Site if tracks.is_usable(recording, site) and len(recording.imu[site]) > 1]
    if not sites:
        return SensorOrientations(np.empty(0), {})
    first_s, last_s = tracks.span_of(recording)
    step_s = nominal_step_s(recording.imu[sites[0]].time_s)
    time_s = first_s + step_s * np.arange(int((last_s - first_s) / step_s + 1e-6) + 1)
    right_late_s = measured.leg_clock.applied_s if measured.leg_clock is not None else 0.0
    for side in Side:
        knee, ankle = joints.get(knee_of(side)), joints.get(ankle_of(side))
        legs_s = -right_late_s if side is Side.RIGHT else 0.0
        thigh, shank, foot = (Site(f"{side}_{segment}") for segment in (Segment.THIGH, Segment.SHANK, Segment.FOOT))
        knee_s = legs_s + (knee.lag_s if knee is not None else 0.0)
        if knee is not None:
            for site, axis, late_s in ((thigh, knee.axis_proximal, legs_s), (shank, knee.axis_distal, knee_s)):
                if site in sites:
                    q = _tracked(tracks, recording, site, time_s, late_s)
                    found[site] = _turned_to(q, knee.clinical_sign * axis, LEFT_RAD)
        if ankle is None:
            continue
        if knee is None and shank in sites:
            q = _tracked(tracks, recording, shank, time_s, knee_s)
            found[shank] = _turned_to(q, -ankle.clinical_sign * ankle.axis_proximal, LEFT_RAD)
        if shank in found and foot in sites:
            q = _tracked(tracks, recording, foot, time_s, knee_s + ankle.lag_s)
            found[foot] = _turned_to(q, ankle.axis_distal, _direction(found[shank], ankle.axis_proximal))
    for hip in (one for one in map(hip_of, Side) if one in hips and Site.PELVIS in sites):
        identified = measured.hips[hip].identification
        late_s = -identified.lag_s - (right_late_s if hip.side is Side.RIGHT else 0.0)
        q = _tracked(tracks, recording, Site.PELVIS, time_s, late_s)
        found[Site.PELVIS] = _turned_to(q, identified.frame_proximal[1], LEFT_RAD)
        break
    return SensorOrientations(time_s, {site: found[site] for site in Site if site in found})


def _tracked(tracks: SensorTracks, recording: Recording, site: Site, time_s: FloatArray, late_s: float) -> FloatArray:
    """A sensor's orientation (n, 4) at stamps of the recording, by the vertical alone; NaN in gaps."""
    found = np.full((len(time_s), 4), np.nan)
    for block in tracks.blocks(recording):
        for one in tracks.oriented(recording, site, block):
            start_s, step_s, last = one.track.start_s + late_s, one.track.step_s, len(one.track) - 1
            ends_s = max(start_s, block.core_from_s), min(start_s + last * step_s, block.core_to_s)
            here = slice(*np.searchsorted(time_s, [ends_s[0] - 0.01 * step_s, ends_s[1] + 0.01 * step_s]))
            position = np.clip((time_s[here] - start_s) / step_s, 0, last)
            q = at_positions(continuous(one.q_earth_from_sensor), position)
            beside = np.floor(position).astype(int), np.ceil(position).astype(int)
            is_received = one.track.is_measured[beside[0]] & one.track.is_measured[beside[1]]
            found[here] = np.where(is_received[:, None], q / np.linalg.norm(q, axis=1, keepdims=True), np.nan)
    return found


def _direction(q: FloatArray, axis: FloatArray) -> FloatArray:
    """The direction (n,) of a sensor's axis (3,) seen from above, rad from x to y; NaN where it is steep."""
    seen = np.full((len(q), 3), np.nan)
    is_known = np.isfinite(q).all(axis=1)
    seen[is_known] = matrix_from_quaternion(q[is_known]) @ axis
    is_level = np.hypot(seen[:, 0], seen[:, 1]) > STEEP
    return np.where(is_level, np.arctan2(seen[:, 1], seen[:, 0]), np.nan)


def _turned_to(q: FloatArray, axis: FloatArray, direction_rad: FloatArray | float) -> FloatArray:
    """Turn about the vertical so that a sensor's axis (3,) has a direction (n,); rotations (n, 4) without jumps."""
    turned = quaternions_about_vertical(direction_rad - _direction(q, axis), q)
    is_known = np.isfinite(turned).all(axis=1)
    turned[is_known] = continuous(turned[is_known])
    turned[~is_known] = np.nan
    return turned
