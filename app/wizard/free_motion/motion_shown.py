"""Contents of the page of free motion, for each joint and for each sensor."""

from dataclasses import replace
from typing import TYPE_CHECKING

from app.widgets.body_figure import SensorMark
from app.widgets.gauge import GaugeFace, GaugeState, gauge_face
from app.widgets.hip_gauge import HipFace, hip_face
from app.wizard.free_motion.hints import absent_note, needed_note, required_of
from core.body import LEG_JOINTS, Joint, Side, Site, hip_of
from core.live.free_motion import FreeMotionState

if TYPE_CHECKING:
    from app.wizard.visit import Visit
    from app.wizard.worn_sensors import WornSensors

SILENT_S = 1.0


def gauge_faces(visit: "Visit", motion: FreeMotionState, now: Joint | None) -> dict[Joint, GaugeFace]:
    """Give each joint's gauge; `now` is the one whose motion is asked for."""
    worn, prosthetic = visit.sensors.sensor_at, visit.prosthetic_joints
    faces = {}
    for joint in LEG_JOINTS:
        needs = needed_note(joint, visit.sensors.detected)
        note = absent_note(joint, worn, visit.without_ankle) if worn else ""
        if note:
            faces[joint] = GaugeFace(GaugeState.ABSENT, note=note)
        elif needs:
            nothing = gauge_face(joint, None, required_of(joint, prosthetic), is_now=False)
            faces[joint] = replace(nothing, state=GaugeState.NEEDS, note=needs)
        else:
            required = required_of(joint, prosthetic)
            faces[joint] = gauge_face(joint, motion.joints.get(joint), required, is_now=joint is now)
    return faces


def hip_faces(visit: "Visit", motion: FreeMotionState, now: Joint | None) -> dict[Joint, HipFace]:
    """Give each hip's gauge; none without a sensor on the pelvis."""
    worn = visit.sensors.sensor_at
    faces = {}
    for joint in (hip_of(side) for side in Side if Site.PELVIS in worn):
        note = absent_note(joint, worn, visit.without_ankle) or needed_note(joint, visit.sensors.detected)
        faces[joint] = HipFace(note=note) if note else hip_face(motion.hips.get(joint), is_now=joint is now)
    return faces


def sensor_marks(sensors: "WornSensors") -> dict[Site, SensorMark]:
    """Give how the sensors that are worn look on the legs."""
    status = sensors.status
    marks = {}
    for name, site in sensors.site_of.items():
        is_silent = name in status and status[name].silent_s > SILENT_S
        worn = SensorMark.SWAPPED if site in sensors.detected else SensorMark.WORN
        marks[site] = SensorMark.SILENT if is_silent else worn
    return marks
