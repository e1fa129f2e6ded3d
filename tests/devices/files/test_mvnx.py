"""Tests that the exports of MVN, written as its manual describes them, become samples of each sensor."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest
from syrupy.assertion import SnapshotAssertion

from core.body import Site
from core.samples import FloatArray, RateKind
from devices.files.formats import read_trial, recognised
from devices.files.mvnx import mvnx_trial
from devices.files.site_names import site_of_name
from tests.swinging_sensor import SwingingSensor, swinging_sensor
from tests.trials_of_files import import_with, refused

NAMES = ("LeftUpperLeg", "LeftLowerLeg")
POSE = '<frame time="0" index="" tc="" ms="0" type="npose"><orientation>1 0 0 0</orientation></frame>'


def two() -> tuple[SwingingSensor, SwingingSensor]:
    return swinging_sensor(), swinging_sensor(reach_rad=0.3)


def elements(sensors: Sequence[SwingingSensor], *required: str) -> dict[str, FloatArray]:
    """Of each element the values of all sensors side by side, (n, sensors * width)."""
    of = {
        "sensorOrientation": [one.q_earth_from_sensor for one in sensors],
        "sensorFreeAcceleration": [one.free_m_s2 for one in sensors],
        "sensorAcceleration": [one.acc_m_s2 for one in sensors],
        "sensorAngularVelocity": [one.gyr_rad_s for one in sensors],
        "sensorMagneticField": [np.tile([0.1, 0.2, 0.3 + k], (300, 1)) for k in range(len(sensors))],
    }
    return {name: np.hstack(of[name]) for name in required}


def mvnx(
    path: Path,
    held: Mapping[str, FloatArray],
    rate: str = "100",
    index: Sequence[int] = range(300),
    names: Sequence[str] = NAMES,
    ms_each: float = 10.0,
) -> Path:
    """A file with the elements whose values these are."""
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        '<!DOCTYPE mvnx SYSTEM "http://www.xsens.com/mvn/mvnx/schema.dtd">',
        '<mvnx xmlns="http://www.xsens.com/mvn/mvnx" version="4"><mvn version="2022.0" build="1"/><comment/>',
        f'<subject label="Suit" frameRate="{rate}" segmentCount="23" recDate="Mon Nov 2 2026">',
        '<segments><segment label="Pelvis" id="1"><points><point label="p"/></points></segment></segments>',
        "<sensors>" + "".join(f'<sensor label="{name}"/>' for name in names) + "</sensors>",
        f'<frames segmentCount="23" sensorCount="{len(names)}" jointCount="22">',
        POSE,
    ]
    for row, number in enumerate(index):
        inner = "".join(
            f"<{name}>{' '.join(f'{value:.6f}' for value in values[row])}</{name}>" for name, values in held.items()
        )
        lines.append(
            f'<frame time="{int(number * ms_each)}" index="{number}" tc="00:00:00:00" ms="1" type="normal">'
            f"<orientation>1 0 0 0</orientation>{inner}</frame>"
        )
    path.write_text("\n".join([*lines, "</frames></subject></mvnx>"]))
    return path


def refusal(path: Path, rate_hz: float | None = None) -> str:
    return refused(mvnx_trial, [path], rate_hz)


def test_free_acceleration_and_orientation_become_motion_in_sensor_axes(tmp_path: Path) -> None:
    sensors = two()
    path = mvnx(
        tmp_path / "a.mvnx",
        elements(sensors, "sensorFreeAcceleration", "sensorMagneticField", "sensorOrientation"),
    )
    assert recognised([path]) == "mvnx"
    trial = mvnx_trial([path])
    assert trial.started == "Mon Nov 2 2026"
    for k, (found, truth) in enumerate(zip(trial.sensors, sensors, strict=True)):
        block = found.block
        assert (found.name, found.info.serial, found.info.rate_hz) == (NAMES[k], NAMES[k], 100.0)
        np.testing.assert_allclose(block.time_s, truth.time_s, atol=1e-9)
        np.testing.assert_allclose(block.acc_m_s2, truth.acc_m_s2, atol=1e-4)
        np.testing.assert_allclose(block.gyr_rad_s[2:-2], truth.gyr_rad_s[2:-2], atol=0.01)
        assert block.mag is not None
        assert block.mag[0, 2] == pytest.approx(0.3 + k)
        assert block.is_rate_derived
        assert [finding.key for finding in found.findings] == ["rate_from_orientation", "gravity_from_orientation"]
    assert len({found.info.clock for found in trial.sensors} - {""}) == 1


def test_older_files_hold_what_the_sensors_measured(tmp_path: Path) -> None:
    sensors = two()
    path = mvnx(
        tmp_path / "a.mvnx",
        elements(sensors, "sensorAcceleration", "sensorAngularVelocity", "sensorOrientation"),
    )
    for found, truth in zip(mvnx_trial([path]).sensors, sensors, strict=True):
        np.testing.assert_allclose(found.block.acc_m_s2, truth.acc_m_s2, atol=1e-6)
        np.testing.assert_allclose(found.block.gyr_rad_s, truth.gyr_rad_s, atol=1e-6)
        assert found.info.rate_kind is RateKind.INSTANTANEOUS
        assert found.findings == ()


def test_missing_frames_are_a_gap_and_a_repeated_one_is_reported(tmp_path: Path) -> None:
    held = elements(two(), "sensorFreeAcceleration", "sensorOrientation")
    path = mvnx(tmp_path / "a.mvnx", held, index=[*range(100), *range(150, 350)])
    (block, _) = (sensor.block for sensor in mvnx_trial([path]).sensors)
    assert len(block) == 300
    assert float(np.diff(block.time_s).max()) == pytest.approx(0.51)
    assert np.isnan(block.gyr_rad_s[[0, 99, 100, 299]]).all()  # there is no adjacent one on one side
    trial = mvnx_trial([mvnx(tmp_path / "b.mvnx", held, index=[*range(100), *range(99, 299)])])
    assert len(trial.sensors[0].block) == 299
    assert trial.sensors[0].findings[-1].numbers == {"count": 1}
    mvnx(tmp_path / "b.mvnx", held, index=[*range(100), *range(5, 205)])
    # its stamps contradict what was continued
    split = refused(read_trial, "mvnx", [tmp_path / "b.mvnx"], None, splits=True)
    assert all("frame 101: index goes back from 99 to 5" in one for one in (split, refusal(tmp_path / "b.mvnx")))


def test_one_frame_is_a_recording(tmp_path: Path) -> None:
    held = elements(two(), "sensorAcceleration", "sensorOrientation")
    one = mvnx_trial([mvnx(tmp_path / "b.mvnx", held, index=[7])]).sensors[0]
    assert len(one.block) == 1


def test_sensors_are_placed_by_their_segments(tmp_path: Path) -> None:
    path = mvnx(tmp_path / "a.mvnx", elements(two(), "sensorFreeAcceleration", "sensorOrientation"))
    placed = {Site.LEFT_THIGH: "LeftUpperLeg", Site.LEFT_SHANK: "leftlowerleg"}
    assert [site_of_name(name) for name in NAMES] == [Site.LEFT_THIGH, Site.LEFT_SHANK]
    assert set(import_with(mvnx_trial, [path], placed, "walk 1").imu) == set(placed)


def test_what_is_left_out_and_other_units_are_refused(tmp_path: Path, snapshot: SnapshotAssertion) -> None:
    path = tmp_path / "a.mvnx"
    free, force, rate, turn = (
        "sensorFreeAcceleration",
        "sensorAcceleration",
        "sensorAngularVelocity",
        "sensorOrientation",
    )
    held = elements(two(), force, rate, turn)

    def of(**changes: FloatArray) -> str:
        return refusal(mvnx(path, held | changes))

    no_rate = refusal(mvnx(path, elements(two(), free, turn), rate=""))
    assert mvnx_trial([path], 100.0).sensors[0].info.rate_hz == 100.0
    path.write_text('<mvnx version="4"><subject frameRate="100"><frames/></subject></mvnx>')
    assert {
        "no sensors": refusal(path),
        "no frame rate": no_rate,
        "no frames": refusal(mvnx(path, elements(two(), force, turn), index=())),
        "free acceleration without orientation": refusal(mvnx(path, elements(two(), free))),
        "no rates and no orientation": refusal(mvnx(path, elements(two(), force))),
        "force in g": of(sensorAcceleration=held[force] / 9.81),
        "rates in deg/s": of(sensorAngularVelocity=np.degrees(held[rate])),
        "a value too few": of(sensorAcceleration=held[force][:, :5]),
        "orientations of twice their length": of(sensorOrientation=2.0 * held[turn]),
        "times of another rate than the file states": refusal(mvnx(path, held, ms_each=20.0)),
        "two sensors of one name": refusal(mvnx(path, held, names=("A", "A"))),
    } == snapshot


@pytest.mark.endurance
def test_damaged_xml_is_refused_and_entities_take_no_memory(tmp_path: Path) -> None:
    path = mvnx(tmp_path / "a.mvnx", elements(two(), "sensorFreeAcceleration", "sensorOrientation"))
    path.write_text(path.read_text()[:-100])
    assert "a.mvnx: the file is not a complete XML file" in refusal(path)
    levels = "".join(f'<!ENTITY e{k} "{f"&e{k - 1};" * 10}">' for k in range(1, 12))
    (tmp_path / "b.mvnx").write_text(
        f'<?xml version="1.0"?><!DOCTYPE mvnx [<!ENTITY e0 "0">{levels}]>'
        '<mvnx version="4"><comment>&e11;</comment></mvnx>'
    )
    assert "b.mvnx: the file is not a complete XML file" in refusal(tmp_path / "b.mvnx")
    assert "an MVNX file contains all sensors of a trial" in refused(mvnx_trial, [path, path])
