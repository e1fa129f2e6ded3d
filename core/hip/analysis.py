"""What a pelvis sensor adds to the analysis of one span of validity: clocks first, angles once knees are known."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from core.body import Side, Site, hip_of
from core.gait.clocks import ClockTie, LegClocks
from core.gait.cycles import cycles_of
from core.hip.clocks import NO_CLOCKS, HipClocks, hip_clocks
from core.hip.heading import HipFit
from core.hip.measure import Knees, fits_of, frames_of, measure_hips
from core.hip.pelvis import hip_parameters, pelvis_parameters, rotation_of, turns_of
from core.hip.results import ClockStatus, LegClock
from core.results import RecordingAnalysis, SideGait
from core.samples import FloatArray
from core.session import Recording, RecordingKind
from core.signal.sensors import SensorTracks


@dataclass(frozen=True, slots=True)
class HipsOfSpan:
    """Clocks by the recording's name, and the fits of both hips in its first ten minutes."""

    clocks: Mapping[str, HipClocks]
    fits: Mapping[tuple[str, Side], list[HipFit | None]]

    def offset_s(self, recording: Recording, side: Side) -> float:
        """What brings the stamps of a leg to the recording's clock, which is the left thigh's, s."""
        return -self.clocks.get(recording.name, NO_CLOCKS).right_late_s if side is Side.RIGHT else 0.0


NO_HIPS = HipsOfSpan({}, {})


def find_hips(tracks: SensorTracks) -> HipsOfSpan:
    """Find clocks and headings of every moving recording; nothing without a pelvis sensor."""
    moving = [one for one in tracks.span if one.kind is not RecordingKind.STANDING and one.holds(Site.PELVIS)]
    if not moving:
        return NO_HIPS
    clocks = {recording.name: hip_clocks(tracks, recording) for recording in moving}
    fits = {
        (recording.name, side): fits_of(tracks, recording, clocks[recording.name], side)
        for recording in moving
        for side in Side
    }
    return HipsOfSpan(clocks, fits)


def with_hips(
    found: RecordingAnalysis, tracks: SensorTracks, recording: Recording, hips: HipsOfSpan, knees: Knees
) -> RecordingAnalysis:
    """Add what the pelvis sensor shows; without one, the same object. Knee axes give the thighs' frames."""
    clocks = hips.clocks.get(recording.name)
    if clocks is None:
        return found
    found = replace(found, leg_clock=clocks.legs, clocks=_tied(found.clocks, clocks.legs))
    frames = frames_of(tracks, recording, knees, hips.clocks, hips.fits)
    if frames is None:
        return found
    measured = measure_hips(tracks, recording, frames, clocks, hips.fits, found.time_s)
    turns = turns_of(found.time_s, measured.heading_rad)
    rotation = rotation_of(found.time_s, measured.heading_rad, turns, _stride_s(found.gait))
    pelvis = replace(measured.pelvis, rotation_rad=rotation)
    gait = {}
    for side, one in found.gait.items():
        strides, hip = one.strides, measured.hips.get(hip_of(side))
        added: dict[str, FloatArray] = pelvis_parameters(strides, found.time_s, pelvis, side)
        cycles = dict(one.cycles)
        if hip is not None:
            added |= hip_parameters(strides, found.time_s, hip)
            cycles[hip_of(side)] = cycles_of(found.time_s, hip.angle_rad, strides.start_s, strides.end_s)
        gait[side] = replace(one, parameters={**one.parameters, **added}, cycles=cycles)
    return replace(found, hips=measured.hips, pelvis=pelvis, turns=turns, gait=gait)


def _tied(clocks: LegClocks | None, legs: LegClock | None) -> LegClocks | None:
    """The evidence about both legs' clocks, with the pelvis's where there was none."""
    if clocks is None or legs is None or legs.status is not ClockStatus.FOUND or clocks.tie is not ClockTie.UNKNOWN:
        return clocks
    return replace(clocks, tie=ClockTie.PELVIS, residual_s=legs.sd_s)


def _stride_s(gait: Mapping[Side, SideGait]) -> float:
    times = [one.strides.time_s[one.strides.is_used] for one in gait.values()]
    known = np.concatenate(times) if times else np.empty(0)
    return float(np.median(known)) if len(known) else float("nan")
