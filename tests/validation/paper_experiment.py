"""The paper's experiment as the walker makes it: a user of a transfemoral prosthesis, six sensors, six walks, optics.

Seel, Raisch and Schauer 2014, section 4: sensors at 60 Hz, ten seconds of circling each side, six walks of ten metres,
an optical system at 120 Hz whose clock is not the sensors'. On the prosthesis sensors and markers sit on the same rigid
parts; on the sound leg clusters of markers ride on the skin elsewhere, each in its own way. What the simulation shows
is that part of the paper's differences which skin makes; what its markers, model and hinge make is not in it.
"""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from core.analysis import analyse
from core.body import LEG_JOINTS, LEG_SITES, Joint, Segment, Side, Site
from core.samples import FloatArray
from core.session import Session
from devices.files.references.reading import read_reference
from devices.simulation.walker import (
    FreeMotion,
    Standing,
    Tissue,
    Walk,
    WalkerSettings,
    simulate,
)
from devices.simulation.walker_body import make_leg
from devices.simulation.walker_sensors import Mounting, Ride, draw_ride, sensor_poses
from devices.simulation.walker_truth import MovedRecording

PROSTHESIS = Side.LEFT
WALKS, STRIDES = 6, 8  # of 1.28 m: ten metres
SENSORS_HZ, OPTICS_HZ = 60.0, 120.0
LATER_S, FASTER = 31.7, 150e-6  # the optics' clock
MARKER_NOISE_RAD = np.deg2rad(0.1)  # of a cluster's turn: half a millimetre over 30 cm
ON_SKIN, OF_MARKERS, OF_NOISE = 101, 102, 103  # streams of chance that the walker has not
AS_STRAPPED = 4  # the walker's own stream of how a sensor rides on its strap


def settings(seed: int, tissue: Tissue = Tissue.REAL, walks: int = WALKS) -> WalkerSettings:
    required = (Walk(f"walk {k}", strides=STRIDES) for k in range(1, walks + 1))
    return WalkerSettings(
        seed=seed,
        recordings=(Standing(), FreeMotion(duration_s=10.0, is_in_turn=True), *required),
        tissue=tissue,
        prosthetic_side=PROSTHESIS,
        rate_hz=SENSORS_HZ,
    )


def experiment(seed: int, folder: Path, tissue: Tissue = Tissue.REAL, walks: int = WALKS) -> tuple[Session, Path]:
    """Give the session and the optical system's file, which is written into `folder`."""
    required = settings(seed, tissue, walks)
    simulated = simulate(required)
    clusters = {site: draw_ride(np.random.default_rng([seed, ON_SKIN, list(Site).index(site)])) for site in LEG_SITES}
    rows = []
    for number, moved in enumerate(simulated.moved):
        if moved.name.startswith("walk"):
            at_s, angles = _seen(required, moved, number, clusters)
            shown_s = at_s * (1.0 + FASTER) + LATER_S * number
            table = np.column_stack([shown_s, *(np.rad2deg(angles[joint]) for joint in LEG_JOINTS)])
            rows += [",".join([moved.name, *(f"{value:.6f}" for value in row)]) for row in table]
    path = folder / "optics.csv"
    path.write_text("\n".join([f"recording,time_s,{','.join(LEG_JOINTS)}", *rows, ""]), encoding="utf-8")
    return simulated.session, path


def against_bones(seed: int, tissue: Tissue, folder: Path, walks: int = WALKS) -> tuple[float, float, float]:
    """The sound knee, degrees RMSE, means removed: ours and the optics' against the bones, ours against the optics."""
    required = settings(seed, tissue, walks)
    simulated, joint = simulate(required), Joint(f"{PROSTHESIS.other}_knee")
    session, path = experiment(seed, folder, tissue, walks)
    optics = {trial.name: trial.angles[joint] for trial in read_reference(path).trials}
    found = []
    for walk in analyse(session).recordings:
        if walk.name in optics:
            number = [one.name for one in simulated.moved].index(walk.name)
            shown_s, seen_rad = optics[walk.name]
            own_s = (shown_s - LATER_S * number) / (1.0 + FASTER)
            truth = simulated.truth.recordings[walk.name].joints[joint]
            bones = np.interp(walk.time_s, truth.time_s, truth.angle_rad)
            seen = np.interp(walk.time_s, own_s, seen_rad, left=np.nan, right=np.nan)
            ours = walk.joints[joint].angle_rad
            found.append([np.nanstd(pair) for pair in (ours - bones + 0 * seen, seen - bones + 0 * ours, ours - seen)])
    ours_deg, seen_deg, both_deg = np.rad2deg(np.mean(found, axis=0)).tolist()
    return ours_deg, seen_deg, both_deg


def _seen(
    required: WalkerSettings, moved: MovedRecording, number: int, clusters: Mapping[Site, Ride]
) -> tuple[FloatArray, dict[Joint, FloatArray]]:
    """Instants (n,) of the walk and the angles (n,) that the optical system makes of its clusters."""
    fine_s = moved.legs[Side.LEFT].time_s
    inside = (fine_s >= 0.0) & (fine_s <= fine_s[-1] - 0.3)
    at_s = np.arange(fine_s[inside][0], fine_s[inside][-1], 1.0 / OPTICS_HZ)
    angles: dict[Joint, FloatArray] = {}
    for joint in LEG_JOINTS:
        leg = make_leg(required, joint.side)
        poses = [_cluster(required, moved, number, site, clusters) for site in (joint.proximal, joint.distal)]
        relative = Rotation.from_matrix(np.swapaxes(poses[0], 1, 2) @ poses[1])
        axis = leg.knee_axis if joint.is_knee else leg.ankle_axis
        angle = np.interp(at_s, fine_s, np.unwrap(_turn_about(relative, axis)))
        noise = np.random.default_rng([required.seed, OF_NOISE, number, list(Joint).index(joint)])
        angles[joint] = angle + noise.normal(0.0, np.sqrt(2.0) * MARKER_NOISE_RAD, len(at_s))
    return at_s, angles


def _cluster(
    required: WalkerSettings, moved: MovedRecording, number: int, site: Site, clusters: Mapping[Site, Ride]
) -> FloatArray:
    """Earth from segment (n, 3, 3) as a cluster of markers has it: on skin, or on the parts that hold the sensors."""
    is_rigid = site.side is PROSTHESIS
    bare = is_rigid and site.segment is not Segment.THIGH
    tissue = Tissue.RIGID if bare else required.tissue
    index = list(Site).index(site)
    first = next(k for k, one in enumerate(required.recordings) if isinstance(one, Walk))
    # sensor and markers on one socket ride as one: drawn as the walker draws it, once for all walks, its wobble in each
    strapped = np.random.default_rng([required.seed, AS_STRAPPED, index, number])
    own = draw_ride(np.random.default_rng([required.seed, AS_STRAPPED, index, first]))
    draw_ride(strapped)  # the walker draws one before each recording's wobble
    chance = strapped if is_rigid else np.random.default_rng([required.seed, OF_MARKERS, index, number])
    ride = own if is_rigid else clusters[site]
    at_joint = Mounting(np.eye(3), np.zeros(3))
    rotation, _ = sensor_poses(moved.legs[site.leg_side], site, at_joint, tissue, ride, chance)
    return rotation


def _turn_about(relative: Rotation, axis: FloatArray) -> FloatArray:
    """The part (n,) of rotations that turns about an axis, by their quaternions."""
    q = relative.as_quat(scalar_first=True)
    return np.asarray(2.0 * np.arctan2(q[:, 1:] @ axis, q[:, 0]))
