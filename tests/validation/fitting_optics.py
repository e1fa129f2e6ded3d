"""The measures for fitting beside optics, as far as public recordings go: the pitch of two feet, the lean of a hinge.

The optical figures are worked out here from optical orientations, with nothing of the core.
"""

from collections import defaultdict
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from core.analysis import analyse
from core.body import Joint, Side, Site
from core.gait.inclination import lean_about
from core.samples import BoolArray, FloatArray, ImuBlock, RateKind
from core.session import Recording, RecordingKind, Session
from core.signal.orientation import oriented
from core.signal.tracks import even_tracks
from tests.benchmarks.gait import optical_foot, recorded_foot
from tests.validation.recordings_with_references import HINGES

SAME_S = 0.15
MAX_AXIS_RISE_RAD = np.deg2rad(45.0)  # about an axis that is nearer the vertical nothing leans


def feet_beside_optics(data: Path) -> Iterator[str]:
    """Ours less the optics', per stride: number, mean, standard deviation, median, middle half, degrees."""
    sites = {Side.LEFT: Site.LEFT_FOOT, Side.RIGHT: Site.RIGHT_FOOT}
    imu = {site: recorded_foot(data, side) for side, site in sites.items()}
    session = Session((Recording("walk", RecordingKind.WALKING, "walk", imu),))
    gait = analyse(session).recordings[-1].gait
    for side in Side:
        apart: dict[str, list[float]] = defaultdict(list)
        strides, found = gait[side].strides, gait[side].parameters
        rise, contact = (np.rad2deg(found[f"foot_{name}_rad"]) for name in ("heel_rise", "pitch_at_contact"))
        for one in optical_foot(data, side).strides:
            at_s, pitch = one.stretch.time_s, _pitch_deg(one.stretch.rotations)
            middle = 0.5 * (one.toe_off_s + one.initial_contact_s)
            for k in np.flatnonzero(strides.is_used & (np.abs(strides.toe_off_s - one.toe_off_s) < SAME_S)):
                apart["foot_heel_rise_deg"].append(float(rise[k] + pitch[at_s <= middle].min()))
            for k in np.flatnonzero(strides.is_used & (np.abs(strides.start_s - one.initial_contact_s) < SAME_S)):
                for name, instant in (("", one.initial_contact_s), (", at our instant", strides.start_s[k])):
                    there = float(np.interp(instant, at_s, pitch))
                    apart[f"foot_pitch_at_contact_deg{name}"].append(float(contact[k]) - there)
        for name, values in apart.items():
            known = np.array(values)[np.isfinite(values)]
            middle_half = np.subtract(*np.percentile(known, [75, 25]))
            spread = f"{known.mean():+.2f} | {known.std(ddof=1):.2f} | {np.median(known):+.2f} | {middle_half:.2f}"
            yield f"| {side} {name} | {len(known)} strides | {spread} |"


def _pitch_deg(earth_from_foot: Rotation) -> FloatArray:
    """Toes up, over what joins both ends of a stretch from stance to stance.

    The optics' axes are not the foot's: forward is level and square to what the foot mostly turns about, and its way
    is given by a heel that rises further than the toes do.
    """
    turns = (earth_from_foot[:-1].inv() * earth_from_foot[1:]).as_rotvec()
    axis = np.linalg.eigh(turns.T @ turns)[1][:, -1]
    forward = np.cross(earth_from_foot[0].inv().apply([0.0, 0.0, 1.0]), axis)
    rise = earth_from_foot.apply(forward / np.linalg.norm(forward))[:, 2]
    pitch = np.rad2deg(np.arcsin(np.clip(rise, -1.0, 1.0)))
    pitch -= np.linspace(pitch[0], pitch[-1], len(pitch))
    return np.asarray(pitch if -pitch.min() > pitch.max() else -pitch)


def hinges_beside_optics(data: Path) -> Iterator[str]:
    """The rows of `hinge_leans`."""
    for name, samples, rms_deg in hinge_leans(data):
        yield f"| {name} | {samples} samples | {rms_deg:.2f} |"


def hinge_leans(data: Path) -> Iterator[tuple[str, int, float]]:
    """Lean of both parts of a mechanical hinge about its axis: root mean square error, mean removed, degrees."""
    for name in HINGES:
        with np.load(data / "hinge_mechanical" / f"{name}.npz") as archive:
            arrays: dict[str, FloatArray] = {key: np.asarray(archive[key], dtype=np.float64) for key in archive.files}
        time_s = np.arange(len(arrays["acc1"])) / float(arrays["fs"])
        sites = (Joint.LEFT_KNEE.proximal, Joint.LEFT_KNEE.distal)
        imu = {s: ImuBlock(s, time_s, arrays[f"gyr{k}"], arrays[f"acc{k}"]) for k, s in enumerate(sites, start=1)}
        found = analyse(Session((Recording("hinge", RecordingKind.FREE_MOTION, "hinge", imu),)))
        knee = found.calibrations[0].joints[Joint.LEFT_KNEE]
        for k, axis in ((1, knee.axis_proximal), (2, knee.axis_distal)):
            bias = (knee.gyro_bias_proximal_rad_s, knee.gyro_bias_distal_rad_s)[k - 1]
            (track,) = even_tracks(imu[sites[k - 1]])
            worn = oriented(track, RateKind.INSTANTANEOUS, np.zeros(3) if bias is None else bias)
            ours = lean_about(axis, worn.earth_from_sensor[:, 2])
            true, is_known = _optical_lean(arrays, k, float(np.sign(axis @ arrays[f"j{k}_ref"])))
            best = min(_rms_deg(ours, true, is_known, offset) for offset in np.arange(-20, 21) / 10)
            yield f"{name}, part {k}", int(is_known.sum()), best


def _optical_lean(arrays: Mapping[str, FloatArray], k: int, sign: float) -> tuple[FloatArray, BoolArray]:
    """Turn of the part about its optical axis against the vertical (n,), and where it means something (n,)."""
    turned = Rotation.from_quat(arrays[f"q{k}_wxyz"], scalar_first=True)
    axis = sign * arrays[f"j{k}_ref"]
    up = turned.inv().apply([0.0, 0.0, 1.0])
    across = np.cross(axis, [1.0, 0.0, 0.0])
    across /= np.linalg.norm(across)
    lean = -np.unwrap(np.arctan2(up @ np.cross(axis, across), up @ across))
    is_level = np.abs(up @ axis) < np.sin(MAX_AXIS_RISE_RAD)
    return lean, (arrays["ref_ok"] > 0) & is_level


def _rms_deg(ours: FloatArray, true: FloatArray, is_known: BoolArray, offset: float) -> float:
    n = np.arange(len(true))
    apart = (ours[: len(true)] - np.interp(n - offset, n, true))[is_known]
    apart = np.angle(np.exp(1j * (apart - np.angle(np.mean(np.exp(1j * apart))))))
    return float(np.rad2deg(np.sqrt(np.mean(apart**2))))
