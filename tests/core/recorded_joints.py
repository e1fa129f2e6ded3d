"""Every shared recording of two adjacent sensors and more, as sessions."""

import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from core.body import LEG_SITES, Segment, Site
from core.samples import ImuBlock
from core.session import Recording, RecordingKind, Session
from devices.files.session_folder import read_session
from devices.files.xsens_mtmanager import mtmanager_trial
from tests.trials_of_files import import_with

TestData = Callable[[str], Path]
PARTS = {Segment.THIGH: "upper_leg", Segment.SHANK: "lower_leg", Segment.FOOT: "foot"}
BONES = {"femur": "thigh", "tibia": "shank", "calcn": "foot"}


def recorded_people(test_data: TestData) -> Iterator[tuple[str, Session]]:
    """Six people after stroke, one who jumps, and one who walks."""
    for folder in sorted(test_data("stroke_treadmill").glob("stroke*")):
        yield folder.name, read_session(folder)
    with np.load(test_data("full_body_free_motion/legs_arms.npz")) as data:
        imu = {}
        for site in LEG_SITES:
            part = f"{PARTS[site.segment]}_{site.side}"
            imu[site] = ImuBlock(part, data["t"].astype(float), data[f"{part}_gyr"], data[f"{part}_acc"])
    yield "jumps", Session((Recording("jumps", RecordingKind.FREE_MOTION, "jumps", imu),))
    folder, placement = test_data("vendor_exports/xsens_mtmanager"), dict[Site, str]()
    for sensor in ET.parse(folder / "OpenSenseExample_myIMUMappings.xml").iter("ExperimentalSensor"):
        bone, side, *_ = (sensor.findtext("name_in_model") or "").split("_")
        if bone in BONES:
            placement[Site(f"{'left' if side == 'l' else 'right'}_{BONES[bone]}")] = sensor.attrib["name"]
    imported = import_with(mtmanager_trial, sorted(folder.glob("OpenSenseExample_*")), placement, "walk 1")
    yield "walk", Session((Recording("walk 1", RecordingKind.WALKING, "walk_1", imported.imu),))


def recorded_mechanisms(test_data: TestData) -> Iterator[tuple[str, Session]]:
    """Joints of one, two and three axes, moved by hand."""
    for name in ("1D_02", "1D_03", "2D_02", "3D_02"):
        with np.load(test_data(f"hinge_mechanical/{name}.npz")) as data:
            time_s = np.arange(len(data["acc1"])) / float(data["fs"])
            imu = {
                site: ImuBlock(str(site), time_s, data[f"gyr{k}"].astype(float), data[f"acc{k}"].astype(float))
                for k, site in ((1, Site.LEFT_THIGH), (2, Site.LEFT_SHANK))
            }
        yield name, Session((Recording(name, RecordingKind.FREE_MOTION, name, imu),))
