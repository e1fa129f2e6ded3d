"""Tests that OpenSense's mapping files name sensors, and that what is none is refused."""

from collections.abc import Callable
from pathlib import Path

from core.body import Site
from devices.files.formats import read_trial
from devices.files.gathering import gather
from devices.files.imports import mapped_sites, place_trial
from devices.files.sensor_mapping import read_mapping
from tests.trials_of_files import refused

FindData = Callable[[str], Path]
FOLDER, MAPPING = "vendor_exports/xsens_mtmanager", "OpenSenseExample_myIMUMappings.xml"


def mapping(path: Path, *pairs: tuple[str, str], reader: str = "Xsens") -> Path:
    sensors = "".join(
        f'<ExperimentalSensor name="{sensor}"><name_in_model>{name}</name_in_model></ExperimentalSensor>'
        for sensor, name in pairs
    )
    settings = f"<{reader}DataReaderSettings><ExperimentalSensors>{sensors}</ExperimentalSensors>"
    path.write_text(f'<?xml version="1.0"?><OpenSimDocument>{settings}</{reader}DataReaderSettings></OpenSimDocument>')
    return path


def test_a_real_mapping_names_a_real_walk(test_data: FindData) -> None:
    folder = test_data(FOLDER)
    trial = read_trial("", [*sorted(folder.glob("OpenSenseExample_MT*.txt")), folder / MAPPING], None)
    sites = mapped_sites(trial)
    assert set(sites) == set(Site)
    imported = place_trial(trial, sites, "walk 1")
    assert imported.sensors[Site.RIGHT_FOOT].serial == "00B421EF"
    assert [one.numbers for one in imported.findings if one.key == "file_left_out"] == [{"name": "torso_imu"}]
    by_file = place_trial(trial, {Site.LEFT_FOOT: "OpenSenseExample_MT_012005D6_009-001_00B421E6.txt"}, "walk 1")
    assert by_file.sensors[Site.LEFT_FOOT].serial == "00B421E6"


def test_a_mapping_goes_with_the_trial_that_it_names(test_data: FindData) -> None:
    found = gather([test_data(FOLDER)])
    with_it = {one.name for one in found.trials if any(file.endswith(MAPPING) for file in one.files)}
    assert "OpenSenseExample_MT_012005D6_009_001" in with_it
    assert "MT46_01_000" not in with_it  # of other sensors
    assert not any(MAPPING in str(refusal) for refusal in found.refused)
    assert "the file names sensors and holds no recording" in refused(gather, [test_data(FOLDER) / MAPPING])


def test_the_mapping_of_apdm_is_one_too(tmp_path: Path) -> None:
    names = read_mapping(mapping(tmp_path / "a.xml", ("Left Shank", "tibia_l_imu"), reader="APDM"))
    assert names == {"LEFT SHANK": "tibia_l_imu"}


def test_what_is_no_mapping_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.xml"
    twice = refused(read_mapping, mapping(path, ("A", "tibia_l_imu"), ("B", "tibia_l_imu")))
    assert 'assigns "tibia_l_imu" twice' in twice
    assert "the file names no sensors" in refused(read_mapping, mapping(path))
    path.write_text(mapping(path, ("A", "tibia_l_imu")).read_text()[:-30])
    assert "the file is not a complete XML file" in refused(read_mapping, path)


def test_a_mapping_without_legs_places_nothing(test_data: FindData, tmp_path: Path) -> None:
    (file,) = test_data(FOLDER).glob("OpenSenseExample_*00B421E6.txt")
    trial = read_trial("", [file, mapping(tmp_path / "a.xml", ("_00B421E6", "hand_l_imu"))], None)
    assert [one.name for one in trial.sensors] == ["hand_l_imu"]
    assert "the mapping file names no part of a leg: hand_l_imu" in refused(mapped_sites, trial)
