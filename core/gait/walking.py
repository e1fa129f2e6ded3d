"""Events, phases, strides and cycles of each side in one walk, on the recording's clock."""

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any

import numpy as np

from core.body import Joint, Segment, Side, Site, ankle_of, knee_of
from core.gait.clocks import LegClocks, LegSteps, leg_clocks
from core.gait.cycles import cycles_of, excursion_of_cycles, find_peak, range_of_cycles
from core.gait.events import FootEvents, detect_events
from core.gait.fitting import foot_measures, inclination_measures, late_swing_of_knee, shank_to_foot
from core.gait.foot import FootMotion
from core.gait.inclination import tilt_by_speeding_up
from core.gait.phases import phases_at
from core.gait.shank import gait_of_shank
from core.gait.spatiotemporal import parameters_of
from core.gait.strides import strides_of_feet
from core.parameters import EXCURSIONS, PEAK_WINDOWS
from core.results import JointAngle, SideGait
from core.samples import BoolArray, FloatArray
from core.session import Patient, Recording
from core.signal.sensors import SensorTracks
from core.signal.tracks import Block

SAME_S = 0.2  # two landings of one foot lie further apart


def site_of_events(tracks: SensorTracks, recording: Recording, side: Side) -> Site | None:
    """The sensor that shows when a side's foot lands and leaves."""
    for segment in (Segment.FOOT, Segment.SHANK):
        site = Site(f"{side}_{segment}")
        if tracks.is_usable(recording, site):
            return site
    return None


def prosthetic_sides(patient: Patient) -> frozenset[Side]:
    """The sides that wear a prosthetic foot, as the clinic typed them."""
    return frozenset(side for side in Side if patient.prosthetic_side in (side, "both"))


def clocks_in(
    tracks: SensorTracks, recording: Recording, gait: Mapping[Side, SideGait], lags_s: Mapping[Joint, float]
) -> LegClocks | None:
    """Give what ties both legs' clocks in one walk; None where not both were measured."""
    sites = {side: site for side in gait if (site := site_of_events(tracks, recording, side)) is not None}
    if len(sites) < len(Side):
        return None
    steps = {
        side: LegSteps(site, *(_usual(gait[side], name) for name in ("step_time_s", "stance_percent")))
        for side, site in sites.items()
    }
    return leg_clocks(tracks.session, recording, steps, lags_s)


def _usual(gait: SideGait, name: str) -> float:
    """The median of a parameter over the strides used in which it is known."""
    values = gait.parameters[name][gait.strides.is_used]
    known = values[np.isfinite(values)]
    return float(np.median(known)) if len(known) else float("nan")


def gait_in(
    tracks: SensorTracks,
    recording: Recording,
    time_s: FloatArray,
    joints: Mapping[Joint, JointAngle],
    clock_offsets_s: Mapping[Side, float],
    inclinations: Mapping[Site, FloatArray],
) -> dict[Side, SideGait]:
    """Find both sides' gait in one walk, from the foot, else the shank; a side with neither is missing."""
    pitch_rad = {side: np.full(len(time_s), np.nan) for side in Side}
    events = {
        side: _events(tracks, recording, site, clock_offsets_s[side], time_s, pitch_rad[side])
        for side in Side
        if (site := site_of_events(tracks, recording, side)) is not None
    }
    are_declared = recording.test is not None and recording.test.protocol.is_on_stairs
    strides = strides_of_feet(events, are_stairs_declared=are_declared)
    gait = {}
    for side, found in events.items():
        other = strides.get(Side.RIGHT if side is Side.LEFT else Side.LEFT)
        mine = strides[side]
        cycles = {
            joint: cycles_of(time_s, joints[joint].angle_rad, mine.start_s, mine.end_s)
            for joint in (knee_of(side), ankle_of(side))
            if joint in joints
        }
        leaning = {site.segment: found for site, found in inclinations.items() if site.side is side}
        parameters = {
            **parameters_of(mine, other),
            **joint_parameters(cycles),
            **foot_measures(mine, time_s, pitch_rad[side]),
            **inclination_measures(mine, time_s, leaning),
        }
        if Segment.SHANK in leaning:
            shank_rad = leaning[Segment.SHANK] + tilt_by_speeding_up(mine, time_s)
            parameters["shank_to_foot_in_swing_rad"] = shank_to_foot(mine, time_s, pitch_rad[side], shank_rad)
        gait[side] = SideGait(
            tuple(found),
            mine,
            parameters,
            cycles,
            phases_at(time_s, found),
            is_toe_off_biased=side in prosthetic_sides(tracks.session.patient),
        )
    return gait


def _events(
    tracks: SensorTracks,
    recording: Recording,
    site: Site,
    offset_s: float,
    time_s: FloatArray,
    pitch_rad: FloatArray,
) -> list[FootEvents]:
    """Events of one side, stretch by stretch, a long recording's seams closed; its pitch (n,) is written in place."""
    found: list[FootEvents] = []
    is_rigid = site.side in prosthetic_sides(tracks.session.patient)
    for block in tracks.blocks(recording):
        for k, worn in enumerate(tracks.oriented(recording, site, block)):
            if worn.track.end_s < block.core_from_s or worn.track.start_s >= block.core_to_s:
                continue  # another block's, seen in the overlap
            if site.segment is Segment.FOOT:
                motion = tracks.foot_motions(recording, site, block)[k]
                events = detect_events(motion, worn.track.is_measured, is_rigid)
                _place_pitch(motion, worn.track.is_measured, offset_s, block, time_s, pitch_rad)
            else:
                events = gait_of_shank(worn)
            events = _rows(events, events.initial_contact_s < block.core_to_s)
            if found and worn.track.start_s < block.core_from_s:
                found[-1] = _continued(found[-1], events, block.core_from_s)
            else:
                found.append(events)
    return [_later(events, offset_s) for events in found if len(events)]


def _place_pitch(
    motion: FootMotion, is_measured: BoolArray, offset_s: float, block: Block, time_s: FloatArray, into: FloatArray
) -> None:
    """Write the pitch of one stretch at the stamps (n,) of the recording's clock, in place."""
    last_s = motion.start_s + motion.step_s * (len(motion.pitch_rad) - 1)
    bounds = max(motion.start_s, block.core_from_s) + offset_s, min(last_s, block.core_to_s) + offset_s
    here = slice(*np.searchsorted(time_s, bounds))
    position = (time_s[here] - offset_s - motion.start_s) / motion.step_s
    pitch = np.where(is_measured, motion.pitch_rad, np.nan)
    into[here] = np.interp(position, np.arange(len(pitch)), pitch)


def _continued(before: FootEvents, after: FootEvents, seam_s: float) -> FootEvents:
    """One stretch of two blocks, which may contain the same landing on either side of their seam."""
    last_s = before.initial_contact_s[-1] if len(before) else -np.inf
    new = _rows(after, after.initial_contact_s > max(seam_s - SAME_S, last_s + SAME_S))
    both: dict[str, Any] = {n: np.concatenate([getattr(before, n), getattr(new, n)]) for n in _rows_of(before)}
    return replace(before, **both)


def _rows(events: FootEvents, keep: BoolArray) -> FootEvents:
    return replace(events, **{name: getattr(events, name)[keep] for name in _rows_of(events)})


def _rows_of(events: FootEvents) -> list[str]:
    """The names of what `events` hold one row per swing of."""
    return [one.name for one in fields(events) if one.name != "is_from_shank"]


def _later(events: FootEvents, by_s: float) -> FootEvents:
    times = ("heel_rise_s", "toe_off_s", "initial_contact_s", "full_contact_s")
    return replace(events, **{name: getattr(events, name) + by_s for name in times})


def joint_parameters(cycles: Mapping[Joint, FloatArray]) -> dict[str, FloatArray]:
    """Compute peaks, excursions, ranges and contact angles per stride (k,), rad or percent, from (k, 101)."""
    parameters: dict[str, FloatArray] = {}
    for joint, windows in ((j, PEAK_WINDOWS[j.kind]) for j in cycles):
        kind, curves = joint.kind, cycles[joint]
        parameters[f"{kind}_at_initial_contact_rad"] = curves[:, 0] if len(curves) else np.empty(0)
        for window in windows:
            peak = find_peak(curves, window)
            parameters[f"{window.name}_rad"] = peak.value
            if window.name == "knee_swing_peak":
                parameters["knee_swing_peak_percent"] = peak.percent
        parameters[f"{kind}_range_rad"] = range_of_cycles(curves)
        if joint.is_knee:
            parameters |= late_swing_of_knee(curves)
        for excursion in EXCURSIONS:
            if excursion.name.startswith(kind):
                parameters[f"{excursion.name}_rad"] = excursion_of_cycles(curves, excursion)
    return parameters
