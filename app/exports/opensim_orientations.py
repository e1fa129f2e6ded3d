"""Orientations for OpenSim's OpenSense: a table of quaternions (.sto) per recording, of those standing too.

Columns are named as OpenSense names a sensor on a body of its models, `femur_r_imu`. Earth has z up and x forward, as
the readers of OpenSim have it, so its tools need `sensor_to_opensim_rotations` of -90 deg about x. The recording
standing places the sensors on a model, the others move it. What is not known is not written: OpenSim takes no gap.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from app.exports.figures import SIMULATED
from app.exports.opensim_motion import MotionPart, known_parts
from app.exports.parts import part_paths
from app.wording.translation import PURPOSE, tr
from core.body import Site
from core.orientations import SensorOrientations, orientations_of
from core.results import Analysis
from core.samples import FloatArray
from core.session import Session
from core.verdicts.status import NO_ZERO, WITH_HEIGHT, joint_status

IMUS = {
    Site.PELVIS: "pelvis_imu",
    Site.RIGHT_THIGH: "femur_r_imu",
    Site.RIGHT_SHANK: "tibia_r_imu",
    Site.RIGHT_FOOT: "calcn_r_imu",
    Site.LEFT_THIGH: "femur_l_imu",
    Site.LEFT_SHANK: "tibia_l_imu",
    Site.LEFT_FOOT: "calcn_l_imu",
}
ABOUT = (
    "Earth from sensor, scalar first; z is up, x forward: sensor_to_opensim_rotations are -1.5707963 0 0.",
    "Headings are not measured. Each sensor faces so that the axis of its joint points left: turns are left out.",
)


def write_orientations(session: Session, analysis: Analysis, folder: Path, name: str) -> list[str]:
    """Write the orientations of each recording into its folder; give a line for each without (translated).
    OpenSim stops at NaN, so at gaps another file begins (`orientations_1.sto`).
    """
    sure = (*WITH_HEIGHT, NO_ZERO)
    reported = {
        one.name: [joint for joint in one.measured if joint_status(one, joint) in sure] for one in analysis.recordings
    }
    lines = []
    for recording, found in orientations_of(session, analysis, reported):
        slipped_s = next((one.slipped_from_s for one in analysis.recordings if one.name == recording.name), {})
        columns = {}
        for site in (site for site in IMUS if site in found.q_earth_from_sensor):
            is_slipped = found.time_s >= (np.inf if site.side is None else slipped_s.get(site.side, np.inf))
            columns[IMUS[site]] = np.where(is_slipped[:, None], np.nan, found.q_earth_from_sensor[site])
        parts = known_parts(found.time_s, {imu: q[:, 0] for imu, q in columns.items()})
        if not parts:
            why = tr("This recording has no orientations to export: no calibrated joint holds its sensors.")
            lines.append(f"{recording.name}: {why}")
            continue
        (folder / recording.folder).mkdir(parents=True, exist_ok=True)
        header = [*([SIMULATED] if session.is_simulated else []), f"Made by gaitwright. {PURPOSE}", *ABOUT]
        places = part_paths(folder / recording.folder / name, len(parts))
        for number, (part, place) in enumerate(zip(parts, places, strict=True), start=1):
            about = [f"{imu} is not known in this part." for imu in columns if imu not in part.names]
            about = [f"Part {number} of {len(parts)}.", *about] if len(parts) > 1 else about
            _write_part(place, found, part, [columns[imu] for imu in part.names], [*header, *about])
    return lines


def _write_part(
    place: Path, found: SensorOrientations, part: MotionPart, columns: Sequence[FloatArray], about: Sequence[str]
) -> None:
    time_s = found.time_s[part.rows]
    rate_hz = 1.0 / float(found.time_s[1] - found.time_s[0])
    header = [f"DataRate={rate_hz:.6f}", "DataType=Quaternion", "version=3", *about, "endheader"]
    with place.open("w", encoding="ascii", newline="\n") as file:
        file.write("\n".join([*header, "\t".join(["time", *part.names])]) + "\n")
        for k, at_s in enumerate(time_s, start=part.rows.start):
            cells = (",".join(f"{value:.9f}" for value in q[k]) for q in columns)
            file.write("\t".join([repr(round(float(at_s), 9)), *cells]) + "\n")
