"""Every shared recording of two adjacent sensors and more, as sessions."""

import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from core.body import LEG_SITES, Segment, Site
from core.samples import FloatArray, ImuBlock
from core.session import Recording, RecordingKind, Session
from devices.files.session_folder import read_session
from devices.files.xsens_mtmanager import mtmanager_trial
from tests.trials_of_files import import_with

TestData = Callable[[str], Path]
PARTS = {Segment.THIGH: "upper_leg", Segment.SHANK: "lower_leg", Segment.FOOT: "foot"}
BONES = {"femur": "thigh", "tibia": "shank", "calcn": "foot"}
HINGE_SITES = (Site.LEFT_THIGH, Site.LEFT_SHANK)
UNTURNED = Rotation.identity()


def jumping_person(test_data: TestData, *, has_orientations: bool = False) -> Session:
    """A person who moves freely and jumps, 100 s, without standing."""
    signals = ("gyr", "acc", "quat") if has_orientations else ("gyr", "acc")
    with np.load(test_data("full_body_free_motion/legs_arms.npz")) as data:
        imu = {}
        for site in LEG_SITES:
            part = f"{PARTS[site.segment]}_{site.side}"
            time_s, *samples = (data[name].astype(float) for name in ("t", *(f"{part}_{one}" for one in signals)))
            imu[site] = ImuBlock(part, time_s, *samples)
    return Session((Recording("jumps", RecordingKind.FREE_MOTION, "jumps", imu),))


def walking_person(test_data: TestData) -> Session:
    """A walk of 24 s without standing, its rates derived from orientations."""
    folder, placement = test_data("vendor_exports/xsens_mtmanager"), dict[Site, str]()
    for sensor in ET.parse(folder / "OpenSenseExample_myIMUMappings.xml").iter("ExperimentalSensor"):
        bone, side, *_ = (sensor.findtext("name_in_model") or "").split("_")
        if bone in BONES:
            placement[Site(f"{'left' if side == 'l' else 'right'}_{BONES[bone]}")] = sensor.attrib["name"]
    imported = import_with(mtmanager_trial, sorted(folder.glob("OpenSenseExample_*")), placement, "walk 1")
    return Session((Recording("walk 1", RecordingKind.WALKING, "walk_1", imported.imu),))


def recorded_people(test_data: TestData) -> Iterator[tuple[str, Session]]:
    """Six people after stroke, one who jumps, and one who walks."""
    for folder in sorted(test_data("stroke_treadmill").glob("stroke*")):
        yield folder.name, read_session(folder)
    yield "jumps", jumping_person(test_data)
    yield "walk", walking_person(test_data)


def mechanism(test_data: TestData, name: str) -> dict[str, FloatArray]:
    """A joint of one, two or three axes that was moved by hand: its samples and what optics measured."""
    with np.load(test_data(f"hinge_mechanical/{name}.npz")) as archive:
        return {key: np.asarray(archive[key], dtype=float) for key in archive.files}


def session_of_mechanism(
    data: dict[str, FloatArray], turn_1: Rotation = UNTURNED, turn_2: Rotation = UNTURNED
) -> Session:
    """The two sensors worn as thigh and shank; `turn` is sensor from turned sensor."""
    time_s = np.arange(len(data["acc1"])) / float(data["fs"])
    imu = {
        site: ImuBlock(str(site), time_s, turn.inv().apply(data[f"gyr{k}"]), turn.inv().apply(data[f"acc{k}"]))
        for k, site, turn in zip((1, 2), HINGE_SITES, (turn_1, turn_2), strict=True)
    }
    return Session((Recording("hinge", RecordingKind.FREE_MOTION, "hinge", imu),))


def recorded_mechanisms(test_data: TestData) -> Iterator[tuple[str, Session]]:
    """Joints of one, two and three axes, moved by hand."""
    for name in ("1D_02", "1D_03", "2D_02", "3D_02"):
        yield name, session_of_mechanism(mechanism(test_data, name))
