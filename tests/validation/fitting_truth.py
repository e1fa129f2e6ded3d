"""The measures for fitting as the simulated patient's bones have them, with numpy alone.

Nothing of the core is used to compute them: poses and events of the walker are read, and each measure is worked out as
its definition states.
"""

from collections.abc import Callable, Mapping

import numpy as np

from core.body import Side
from core.samples import FloatArray
from devices.simulation.walker import SimulatedSession
from devices.simulation.walker_motion import LegMotion

EXTENDED_DEG = 3.0


def true_strides(made: SimulatedSession, walk: str, side: Side) -> list[tuple[float, dict[str, float]]]:
    """Initial contact and measures of every whole stride, in degrees and percent of the stride."""
    take = next(one for one in made.moved if one.name == walk)
    standing = next(one for one in made.moved if one.is_standing)
    leg, stood = take.legs[side], standing.legs[side]
    knee = np.rad2deg(leg.angles.knee - np.mean(stood.angles.knee))
    lean = {
        name: _lean_deg(leg, row) - float(np.mean(_lean_deg(stood, row, _heading(leg) - _turn(leg, stood))))
        for row, name in enumerate(("thigh", "shank"))
    }
    pitch = np.rad2deg(np.arctan2(leg.rotations[2, :, 2, 0], np.hypot(*leg.rotations[2, :, :2, 0].T)))
    flat = _during_stances(leg, pitch)
    events = leg.events
    found = []
    for k in range(len(events.initial_contact_s) - 1):
        start, end = events.initial_contact_s[k : k + 2]
        full = float(events.full_contact_s[k])
        rise, off = (float(t[(t > start) & (t < end)][0]) for t in (events.heel_rise_s, events.toe_off_s))
        measures = _measures(leg.time_s, knee, lean, pitch - flat, (start, full, rise, off, end))
        measures |= _ankle_measures(leg, float(start), float(end))
        measures |= _of_steps(take.legs, side, k, (float(start), float(off), float(end)))
        found.append((float(start), measures))
    return found


def _measures(
    time_s: FloatArray,
    knee: FloatArray,
    lean: dict[str, FloatArray],
    pitch: FloatArray,
    instants: tuple[float, float, float, float, float],
) -> dict[str, float]:
    start, full, rise, off, end = instants
    length = end - start

    def at(values: FloatArray) -> Callable[[float], float]:
        return lambda instant: float(np.interp(instant, time_s, values))

    def share(first: float, last: float) -> slice:
        return slice(*np.searchsorted(time_s, (start + first * length, start + last * length)))

    swing = share(0.55, 0.9)
    peak = swing.start + int(np.argmax(knee[swing]))
    late = slice(peak, int(np.searchsorted(time_s, end)))
    least = float(knee[late].min())
    arrived = time_s[late][np.argmax(knee[late] <= least + EXTENDED_DEG)]
    rising = slice(*np.searchsorted(time_s, (rise, 0.5 * (off + end))))
    unbent = slice(*np.searchsorted(time_s, (off + 0.25 * (end - off), off + 0.85 * (end - off))))
    shank = at(lean["shank"])
    measures = {
        "knee_while_loading_deg": float(knee[share(0.05, 0.3)].max()) - at(knee)(start),
        "knee_loading_peak_deg": float(knee[share(0.05, 0.3)].max()),
        "knee_swing_peak_deg": float(knee[peak]),
        "knee_stance_to_swing_deg": float(knee[peak]) - float(knee[share(0.25, 0.6)].min()),
        "knee_swing_peak_percent": 100.0 * (float(time_s[peak]) - start) / length,
        "knee_terminal_extension_deg": least,
        "knee_extended_before_contact_percent": 100.0 * (end - float(arrived)) / length,
        "foot_heel_rise_deg": -float(pitch[rising].min()),
        "foot_pitch_at_contact_deg": at(pitch)(start),
        "foot_flat_percent": 100.0 * (rise - full) / length,
        "shank_heel_rocker_deg": shank(full) - shank(start),
        "shank_over_flat_foot_deg": shank(rise) - shank(full),
        "shank_forefoot_rocker_deg": shank(off) - shank(rise),
        "shank_to_foot_in_swing_deg": float((pitch + lean["shank"])[unbent].mean()),
    }
    for segment, leaning in lean.items():
        middle = 0.5 * (start + off)
        for name, instant in (("initial_contact", start), ("mid_stance", middle), ("toe_off", off)):
            measures[f"{segment}_at_{name}_deg"] = at(leaning)(instant)
    return measures


def _ankle_measures(leg: LegMotion, start: float, end: float) -> dict[str, float]:
    ankle = np.rad2deg(leg.angles.ankle)

    def share(first: float, last: float) -> FloatArray:
        span = np.searchsorted(leg.time_s, (start + first * (end - start), start + last * (end - start)))
        return ankle[slice(*span)]

    over_foot = float(share(0.2, 0.6).max())
    return {
        "ankle_heel_rocker_deg": float(share(0.0, 0.2)[0] - share(0.0, 0.2).min()),
        "ankle_rocker_deg": over_foot - float(share(0.0, 0.2).min()),
        "ankle_push_off_deg": over_foot - float(share(0.5, 0.8).min()),
    }


def _of_steps(
    legs: Mapping[Side, LegMotion], side: Side, k: int, instants: tuple[float, float, float]
) -> dict[str, float]:
    start, off, end = instants
    other = next(leg for one, leg in legs.items() if one is not side).events.initial_contact_s
    place = legs[side].footholds_m[k + 1 : k + 3]  # the first is where it stood
    between = other[(other > start) & (other < end)]
    return {
        "stance_percent": 100.0 * (off - start) / (end - start),
        "stride_length_m": float(np.hypot(*(place[1] - place[0]))),
        "step_time_s": end - float(between[-1]) if len(between) else float("nan"),
    }


def _heading(leg: LegMotion) -> float:
    """Direction of walking over the floor."""
    way = leg.footholds_m[-1] - leg.footholds_m[0]
    return float(np.arctan2(way[1], way[0]))


def _turn(leg: LegMotion, stood: LegMotion) -> float:
    """By how much the foot is in another compass direction than in `stood`."""
    one, other = (m.rotations[2, 0, :2, 0] for m in (leg, stood))
    return float(np.arctan2(one[1], one[0]) - np.arctan2(other[1], other[0]))


def _lean_deg(leg: LegMotion, row: int, heading: float | None = None) -> FloatArray:
    """Forward lean of a segment's long axis in the plane of walking."""
    direction = _heading(leg) if heading is None else heading
    along = leg.rotations[row, :, :, 2]
    forward = along[:, 0] * np.cos(direction) + along[:, 1] * np.sin(direction)
    return np.asarray(np.rad2deg(np.arctan2(forward, along[:, 2])))


def _during_stances(leg: LegMotion, pitch: FloatArray) -> FloatArray:
    """What the pitch of the flat foot is, from stance to stance."""
    instants = [
        0.5 * (full + leg.events.heel_rise_s[leg.events.heel_rise_s > full][0])
        for full in leg.events.full_contact_s[: len(leg.events.heel_rise_s) - 1]
    ]
    return np.asarray(np.interp(leg.time_s, instants, np.interp(instants, leg.time_s, pitch)))
