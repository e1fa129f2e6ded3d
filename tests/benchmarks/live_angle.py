"""Distance of the live joint angle from the offline one, and which of its two causal forms is nearer.

    python -m tests.benchmarks.live_angle [--sessions 25] [--only rigid "soft tissue" ...]

Walks of the simulated patient, and a mechanical hinge where GAITWRIGHT_TEST_DATA names the shared recordings, with the
calibration of the offline analysis in force. RMSE in degrees against the offline angle from SCORED_FROM_S on, the
largest change of that difference from one sample to the next (a jump), and how often the truth lies within 2 sd. Then
the same by half-seconds from the start on, for walks that begin in standing and for walks cut open.
"""

import os
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from core.analysis import analyse
from core.body import Joint, Site
from core.live.angle import AngleSamples, LiveAngle
from core.live.orientation import LiveOrientation
from core.live.streams import EvenStream
from core.results import JointCalibration
from core.samples import FloatArray, ImuBlock, RateKind
from core.session import Recording, RecordingKind, Session
from devices.simulation.walker import FreeMotion, Standing, Tissue, Walk, WalkerSettings, simulate
from tests.benchmarks.trials import HINGES
from tests.driver import options

SCORED_FROM_S = 3.0
CUT_S = (3.3, 4.6, 6.1)  # instants amid the walk
BINS_S = 0.5
SETTLING_BINS = 12
TARGETS = {("knee", "hinge"): 0.35, ("knee", "human"): 1.0, ("ankle", "hinge"): 1.0, ("ankle", "human"): 1.0}
MECHANICAL_TARGET = 0.5


@dataclass(frozen=True, slots=True)
class Condition:
    """`bias_rad_s` is left in the distal rate, about the joint axis."""

    tissue: Tissue
    bias_rad_s: float = 0.0
    standing_s: float = 2.0


LEFT_RAD_S = np.deg2rad(1.5)
CONDITIONS = {
    "rigid": Condition(Tissue.RIGID),
    "rigid, 1.5 deg/s": Condition(Tissue.RIGID, LEFT_RAD_S),
    "soft tissue": Condition(Tissue.SOFT),
    "soft tissue, 1.5 deg/s": Condition(Tissue.SOFT, LEFT_RAD_S),
    "soft tissue, 1.5 deg/s, hardly any standing": Condition(Tissue.SOFT, LEFT_RAD_S, 0.5),
    "real tissue": Condition(Tissue.REAL),
    "real tissue, 1.5 deg/s": Condition(Tissue.REAL, LEFT_RAD_S),
}


@dataclass(frozen=True, slots=True)
class Walked:
    """One joint over one walk: its calibration, and offline and true angle (n,) at `time_s`, radians."""

    joint: Joint
    recording: Recording
    calibration: JointCalibration
    time_s: FloatArray
    offline_rad: FloatArray
    true_rad: FloatArray


@dataclass(frozen=True, slots=True)
class Scored:
    """Degrees: against the offline angle, against the truth, the largest jump. `covered`: share within 2 sd."""

    rmse: float
    true_rmse: float
    jump: float
    covered: float


def live_angle(
    recording: Recording, calibration: JointCalibration, rate_hz: float, kind: RateKind, bias_rad_s: float = 0.0
) -> AngleSamples:
    """A whole recording at once, which gives the same as block by block."""
    joint, turned = calibration.joint, []
    biases = [calibration.gyro_bias_proximal_rad_s, calibration.gyro_bias_distal_rad_s]
    for site, known, left_rad_s in zip((joint.proximal, joint.distal), biases, (0.0, bias_rad_s), strict=True):
        bias = np.zeros(3) if known is None else known
        stream = EvenStream(rate_hz)
        stream.feed(recording.imu[site])
        orientation = LiveOrientation(bias - left_rad_s * calibration.axis_distal, kind, stream.step_s)
        turned.append(orientation.update(stream.take()))
    return LiveAngle(calibration, 1 / rate_hz, 1 / rate_hz).update(*turned)


def cut_open(recording: Recording, from_s: float) -> Recording:
    """The recording from an instant on."""
    imu = {}
    for site, block in recording.imu.items():
        later = block.time_s >= from_s
        imu[site] = ImuBlock(block.sensor, block.time_s[later], block.gyr_rad_s[later], block.acc_m_s2[later])
    return replace(recording, imu=imu)


def walks(condition: Condition, sessions: range) -> Iterator[Walked]:
    for seed in sessions:
        required = Standing(), FreeMotion(), Walk(strides=27, standing_before_s=condition.standing_s)
        made = simulate(WalkerSettings(seed=seed, tissue=condition.tissue, recordings=required))
        found, recording = analyse(made.session), made.session.recordings[-1]
        offline = found.recordings[-1]
        for joint, calibration in found.calibrations[-1].joints.items():
            truth = made.truth.recordings[recording.name].joints[joint]
            true_rad = np.interp(offline.time_s, truth.time_s, truth.angle_rad) - truth.standing_rad
            angle_rad = offline.joints[joint].angle_rad
            yield Walked(joint, recording, calibration, offline.time_s, angle_rad, true_rad)


def forms(calibration: JointCalibration) -> dict[str, JointCalibration]:
    """The same calibration, once measured as a human joint and, where its centre is known, once as a hinge."""
    both = {"twist": replace(calibration, is_hinge=False)}
    if calibration.centre_proximal_m is not None:
        both["integral"] = replace(calibration, is_hinge=True)
    return both


def differences(walked: Walked, live: AngleSamples) -> tuple[FloatArray, FloatArray]:
    """Of the live angle from the offline and from the true one (n,), degrees."""
    offline = np.interp(live.time_s, walked.time_s, walked.offline_rad)
    true = np.interp(live.time_s, walked.time_s, walked.true_rad)
    return np.rad2deg(live.angle_rad - offline), np.rad2deg(live.angle_rad - true)


def score(walked: Walked, live: AngleSamples) -> Scored:
    error, true_error = differences(walked, live)
    scored = live.time_s > live.time_s[0] + SCORED_FROM_S
    error, true_error, sd = error[scored], true_error[scored], np.rad2deg(live.sd_rad[scored])
    return Scored(
        rmse=float(np.sqrt(np.mean(error**2))),
        true_rmse=float(np.sqrt(np.mean(true_error**2))),
        jump=float(np.max(np.abs(np.diff(error)))),
        covered=float(np.mean(np.abs(true_error) < 2 * sd)),
    )


def run(name: str, sessions: range, rate_hz: float = 100.0) -> None:
    condition = CONDITIONS[name]
    scores: dict[tuple[str, str, str], list[Scored]] = defaultdict(list)
    settling: dict[tuple[str, str], list[FloatArray]] = defaultdict(list)
    for walked in walks(condition, sessions):
        kind = "knee" if walked.joint.is_knee else "ankle"
        is_hinge = walked.calibration.is_hinge and walked.calibration.centre_proximal_m is not None
        human = "hinge" if is_hinge else "human"
        for form, calibration in forms(walked.calibration).items():
            live = live_angle(walked.recording, calibration, rate_hz, RateKind.INSTANTANEOUS, condition.bias_rad_s)
            is_shown = form == ("integral" if is_hinge else "twist")
            scores[kind, human, f"{form}{', shown' if is_shown else ''}"].append(score(walked, live))
            if is_shown:
                settling[kind, "begins in standing"].append(differences(walked, live)[0])
        known = "knows the centre" if walked.calibration.centre_proximal_m is not None else "without a centre"
        for from_s in CUT_S:
            part = cut_open(walked.recording, from_s)
            live = live_angle(part, walked.calibration, rate_hz, RateKind.INSTANTANEOUS, condition.bias_rad_s)
            settling[kind, f"cut open, {known}"].append(differences(walked, live)[0])
    print(f"\n{name} ({len(sessions)} sessions)")
    print("  joint  kind   form               n   p50   p90   max  target    truth   jump  in 2 sd")
    for (kind, human, form), found in sorted(scores.items()):
        rmse = [s.rmse for s in found]
        p50, p90, worst = np.quantile(rmse, [0.5, 0.9, 1.0])
        target = TARGETS[kind, human]
        verdict = f"{target:4.2f} {'met' if p90 <= target else 'MISSED'}" if "shown" in form else ""
        true, jump = float(np.median([s.true_rmse for s in found])), max(s.jump for s in found)
        covered = float(np.mean([s.covered for s in found]))
        print(
            f"  {kind:6s} {human:6s} {form:16s} {len(found):3d} {p50:5.2f} {p90:5.2f} {worst:5.2f}"
            f"  {verdict:10s} {true:5.2f}  {jump:5.2f}  {covered:5.2f}"
        )
    print("  RMSE by half-seconds from the start on (- where less than half is told)")
    for (kind, start), errors in sorted(settling.items()):
        print(f"  {kind:6s} {start:27s}", " ".join(_by_half_seconds(errors, rate_hz)))


def _by_half_seconds(errors: list[FloatArray], rate_hz: float) -> Iterator[str]:
    width = round(BINS_S * rate_hz)
    for k in range(SETTLING_BINS):
        part = np.concatenate([e[k * width : (k + 1) * width] for e in errors])
        reported = np.isfinite(part)
        yield f"{np.sqrt(np.mean(part[reported] ** 2)):5.2f}" if np.mean(reported) > 0.5 else "    -"


def run_mechanical(folder: Path) -> None:
    print(f"\nmechanical hinge, against offline, target {MECHANICAL_TARGET}")
    for name in HINGES:
        with np.load(folder / "hinge_mechanical" / f"{name}.npz") as archive:
            data = {key: np.asarray(archive[key], dtype=float) for key in archive.files}
        rate_hz = float(data["fs"])
        time_s = np.arange(len(data["acc1"])) / rate_hz
        sites = (Site.LEFT_THIGH, Site.LEFT_SHANK)
        imu = {s: ImuBlock(str(s), time_s, data[f"gyr{k}"], data[f"acc{k}"]) for k, s in enumerate(sites, start=1)}
        recording = Recording("hinge", RecordingKind.FREE_MOTION, "hinge", imu)
        found = analyse(Session((recording,)))
        calibration = found.calibrations[0].joints[Joint.LEFT_KNEE]
        angle_rad = found.recordings[0].joints[Joint.LEFT_KNEE].angle_rad
        walked = Walked(Joint.LEFT_KNEE, recording, calibration, time_s, angle_rad, angle_rad)
        for left_rad_s in (0.0, LEFT_RAD_S):
            for form, one in forms(calibration).items():
                live = live_angle(recording, one, rate_hz, RateKind.INSTANTANEOUS, left_rad_s)
                s = score(walked, live)
                print(f"  {name} {np.rad2deg(left_rad_s):3.1f} deg/s  {form:8s} {s.rmse:5.2f}  jump {s.jump:5.2f}")


def main() -> None:
    required = options(__doc__, sessions=25, first=0, only={"nargs": "*", "default": list(CONDITIONS)})
    reported = os.environ.get("GAITWRIGHT_TEST_DATA")
    if reported:
        run_mechanical(Path(reported))
    for name in required.only:
        run(name, range(required.first, required.first + required.sessions))


if __name__ == "__main__":
    main()
