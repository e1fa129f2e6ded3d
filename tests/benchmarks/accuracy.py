"""Accuracy of axes, centres, signs and angles on the project's own patient.

    python tests/benchmarks/accuracy.py --seeds 500 --workers 2 [--only rigid soft ...]

Prints one line per condition and quantity: 50th, 90th percentile and worst over sessions, beside the target.
"""

from collections import defaultdict
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from core.analysis import analyse
from core.angles.measure import Geometry, measure
from core.body import LEG_JOINTS, LEG_SITES, Joint, Segment
from core.calibration.zero import standing_twist, wrapped_to_zero
from core.results import Analysis, JointCalibration, Method, ZeroKind
from core.samples import RateKind
from core.session import RecordingKind
from core.signal.rotations import angle_between
from core.signal.sensors import SensorTracks
from devices.simulation.walker import (
    FreeMotion,
    JointTruth,
    Motion,
    SensorErrors,
    SimulatedSession,
    Standing,
    Tissue,
    Walk,
    WalkerSettings,
    simulate,
)
from tests.driver import options

Errors = dict[str, list[float]]


@dataclass(frozen=True, slots=True)
class Condition:
    """`settings` are varied by seed only; `targets` by quantity: 90th percentile at most."""

    settings: WalkerSettings
    targets: dict[str, float]
    method: Method = Method.ROBUST
    has_true_axes: bool = False  # measure with the walker's own axes beside


LONG, SHORT = (Standing(), FreeMotion(), Walk()), (Standing(), FreeMotion(duration_s=3.0), Walk())
SIGNS = {"pairing wrong": 0.0, "sign wrong": 0.0}
BAD_SENSORS = SensorErrors(gyro_bias_sd_rad_s=np.deg2rad(1.5), acc_bias_sd_m_s2=0.1)
LATE = {site: 0.03 for site in LEG_SITES if site.segment is Segment.SHANK}

CONDITIONS = {
    "rigid": Condition(WalkerSettings(), {**SIGNS, "knee axis": 0.25, "knee Z": 0.13, "ankle Z": 0.45}),
    "rigid 3 s": Condition(WalkerSettings(recordings=SHORT), {**SIGNS, "knee axis": 0.35}),
    "rigid 60 Hz": Condition(WalkerSettings(rate_hz=60.0), {**SIGNS, "knee Z": 0.13}),
    "rigid 200 Hz": Condition(WalkerSettings(rate_hz=200.0), {**SIGNS, "knee Z": 0.13, "ankle Z": 0.45}),
    "rigid, biased sensors": Condition(
        WalkerSettings(errors=BAD_SENSORS), {**SIGNS, "knee Z": 0.20, "knee centre": 3.5, "ankle centre": 3.5}
    ),
    "soft tissue": Condition(
        WalkerSettings(tissue=Tissue.SOFT), {**SIGNS, "ankle Z": 1.2, "knee Z over true axes": 0.1}, has_true_axes=True
    ),
    "real tissue": Condition(WalkerSettings(tissue=Tissue.REAL), {**SIGNS}),
    "walk only, rigid": Condition(WalkerSettings(recordings=(Standing(), Walk())), {**SIGNS}),
    "walk only, soft": Condition(WalkerSettings(recordings=(Standing(), Walk()), tissue=Tissue.SOFT), {**SIGNS}),
    "walk only, no standing": Condition(WalkerSettings(recordings=(Walk(),), tissue=Tissue.SOFT), {**SIGNS}),
    "soft tissue, 3 s": Condition(WalkerSettings(recordings=SHORT, tissue=Tissue.SOFT), {**SIGNS}),
    "lag 30 ms": Condition(WalkerSettings(clock_late_s=LATE), {**SIGNS, "lag": 1.5}),
    "lag 30 ms, soft": Condition(WalkerSettings(clock_late_s=LATE, tissue=Tissue.SOFT), {**SIGNS, "lag": 1.5}),
    "side lying, rigid": Condition(
        WalkerSettings(recordings=(Standing(), FreeMotion(), FreeMotion("lying", motion=Motion.SIDE_LYING))),
        {"lying knee M": 0.15},
    ),
    "side lying, soft": Condition(
        WalkerSettings(
            recordings=(Standing(), FreeMotion(), FreeMotion("lying", motion=Motion.SIDE_LYING)), tissue=Tissue.SOFT
        ),
        {"lying knee M": 0.5},
    ),
    "published, rigid": Condition(WalkerSettings(), {}, Method.PUBLISHED),
    "published, soft": Condition(WalkerSettings(tissue=Tissue.SOFT), {}, Method.PUBLISHED),
}


def score(name: str, seed: int) -> Errors:
    """Errors of one simulated session: degrees, millimetres, milliseconds, or 1 for wrong."""
    condition = CONDITIONS[name]
    simulated = simulate(replace(condition.settings, seed=seed))
    # what is measured lying is not to calibrate itself: it is analysed as a walk
    recordings = tuple(
        replace(r, kind=RecordingKind.WALKING) if r.name == "lying" else r for r in simulated.session.recordings
    )
    analysis = analyse(replace(simulated.session, recordings=recordings), condition.method)
    errors: Errors = defaultdict(list)
    for recording in analysis.recordings:
        truths = simulated.truth.recordings[recording.name].joints
        calibration = analysis.calibrations[-1].joints
        is_walk = recording.kind is RecordingKind.WALKING and recording.name != "lying"
        for joint in LEG_JOINTS:
            if joint not in recording.joints:
                errors["missing"].append(1.0)
                continue
            kind = "knee" if joint.is_knee else "ankle"
            if is_walk or len(analysis.recordings) == 1:
                _score_calibration(errors, kind, calibration[joint], truths[joint])
            label = kind if is_walk else f"{recording.name} {kind}"
            _score_angle(errors, label, analysis, recording.name, joint, calibration[joint], truths[joint])
    if condition.has_true_axes:
        _score_true_axes(errors, simulated)
    return errors


def _score_true_axes(errors: Errors, simulated: SimulatedSession) -> None:
    """How much of the knee's error comes from its axes: the error found less the one that the walker's axes give."""
    session = simulated.session
    tracks = SensorTracks(session, session.recordings, frozenset(), RateKind.INSTANTANEOUS)
    walk, standing = session.recordings[-1], session.recordings[0]
    for k, joint in enumerate((Joint.LEFT_KNEE, Joint.RIGHT_KNEE)):
        truth = simulated.truth.recordings[walk.name].joints[joint]
        axes, centres = (truth.axis_proximal, truth.axis_distal), (truth.centre_proximal_m, truth.centre_distal_m)
        unknowns = np.concatenate([*centres, np.zeros(6)])
        geometry = Geometry(*axes, *centres, truth.lag_s, 2.0, unknowns, is_hinge=False)
        found = measure(tracks, walk, joint, geometry, truth.time_s, 0.0)
        rests = [tracks.rest(standing, site) for site in (joint.proximal, joint.distal)]
        assert rests[0] is not None
        assert rests[1] is not None
        zero = standing_twist(rests[0].acc_m_s2, rests[1].acc_m_s2, *axes)
        error = np.rad2deg(wrapped_to_zero(found.twist_rad - zero) - (truth.angle_rad - truth.standing_rad))
        floor = float(np.sqrt(np.nanmean(error**2)))
        errors["knee Z with true axes"].append(floor)
        errors["knee Z over true axes"].append(errors["knee Z"][k] - floor)


def _score_calibration(errors: Errors, kind: str, found: JointCalibration, truth: JointTruth) -> None:
    j1, j2 = found.clinical_sign * found.axis_proximal, found.clinical_sign * found.axis_distal
    right = float(j1 @ truth.functional_proximal), float(j2 @ truth.functional_distal)
    errors["pairing wrong"].append(float(right[0] * right[1] < 0))
    errors["sign wrong"].append(float(right[0] < 0))
    for own, other in ((j1, truth.functional_proximal), (j2, truth.functional_distal)):
        errors[f"{kind} axis"].append(float(np.rad2deg(min(angle_between(own, other), angle_between(-own, other)))))
    if found.centre_proximal_m is not None and found.centre_distal_m is not None:
        offsets = found.centre_proximal_m - truth.centre_proximal_m, found.centre_distal_m - truth.centre_distal_m
        for offset, axis in zip(offsets, (truth.axis_proximal, truth.axis_distal), strict=True):
            observable = offset - axis * (axis @ offset) if kind == "knee" else offset
            errors[f"{kind} centre"].append(float(1000 * np.linalg.norm(observable)))
            errors[f"{kind} centre error/sd"].append(float(np.linalg.norm(observable)) / (found.centre_sd_m or np.nan))
    else:
        errors[f"{kind} centre unknown, not a hinge"].append(1.0)
    errors["lag"].append(1000 * abs(found.lag_s - truth.lag_s))
    errors["margin under 1.3"].append(float((found.sign_margin or 0.0) < 1.3))
    errors["sign unclear"].append(float(not found.is_sign_certain))
    errors[f"{kind} called hinge"].append(float(found.is_hinge))


def _score_angle(
    errors: Errors,
    label: str,
    analysis: Analysis,
    name: str,
    joint: Joint,
    calibration: JointCalibration,
    truth: JointTruth,
) -> None:
    recording = next(r for r in analysis.recordings if r.name == name)
    angle = recording.joints[joint]
    lead_s = 0.0 if joint.is_knee else analysis.calibrations[-1].joints[_knee(joint)].lag_s if _knee(joint) else 0.0
    true = np.interp(recording.time_s, truth.time_s + lead_s, truth.angle_rad)
    difference = np.rad2deg(angle.angle_rad - true)
    difference = difference[np.isfinite(difference)]
    if calibration.zero is ZeroKind.STANDING:
        errors[f"{label} Z"].append(float(np.sqrt(np.mean((difference + np.rad2deg(truth.standing_rad)) ** 2))))
    errors[f"{label} M"].append(float(np.std(difference)))
    published = np.rad2deg(angle.published_rad - true)
    errors[f"{label} M eq 15"].append(float(np.nanstd(published)))
    inside = np.abs(difference - difference.mean()) < 2 * np.rad2deg(np.nanmedian(angle.sd_rad))
    errors[f"{label} 2 sd misses"].append(float(np.mean(~inside)))
    errors[f"{label} sd/error"].append(float(np.rad2deg(np.nanmedian(angle.sd_rad)) / np.std(difference)))


def _knee(joint: Joint) -> Joint:
    return Joint(f"{joint.side}_knee")


def run(name: str, seeds: range, workers: int) -> dict[str, np.ndarray]:
    one: Callable[[int], Errors] = partial(score, name)
    pooled: Errors = defaultdict(list)
    if workers == 1:
        results = map(one, seeds)
        for errors in results:
            for key, values in errors.items():
                pooled[key].extend(values)
    else:
        with ProcessPoolExecutor(workers) as pool:
            for errors in pool.map(one, seeds, chunksize=4):
                for key, values in errors.items():
                    pooled[key].extend(values)
    return {key: np.array(values) for key, values in pooled.items()}


def main() -> None:
    arguments = options(__doc__, seeds=20, first=0, workers=2, only={"nargs": "*", "default": list(CONDITIONS)})
    for name in arguments.only:
        pooled = run(name, range(arguments.first, arguments.first + arguments.seeds), arguments.workers)
        print(f"\n{name} ({arguments.seeds} sessions)")
        for key, values in pooled.items():
            if key in ("pairing wrong", "sign wrong", "margin under 1.3", "sign unclear", "missing") or "hinge" in key:
                print(f"  {key:24s} {int(values.sum()):5d} of {len(values)}")
                continue
            p50, p90 = np.quantile(values, [0.5, 0.9])
            target = CONDITIONS[name].targets.get(key)
            verdict = "" if target is None else f"   target {target:g} {'met' if p90 <= target else 'MISSED'}"
            print(f"  {key:24s} p50 {p50:7.2f}  p90 {p90:7.2f}  worst {values.max():7.2f}{verdict}")


if __name__ == "__main__":
    main()
