"""Tests that what is proposed of other programs' recordings is right. Nothing is proposed where nothing is known."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from app.importing.import_drafts import Origin, chains_of_motion, drafts_of, session_of
from core.body import LEG_SITES, Side, Site
from core.samples import ImuBlock, SensorInfo
from core.session import RecordingKind
from devices.files.refusal import FileRefusedError
from devices.files.trial import ImportedSensor, ImportedTrial
from devices.files.xsens_mtmanager import mtmanager_trial
from devices.simulation.walker import FreeMotion, Standing, Walk, WalkerSettings
from tests.simulated import simulation_of

FindData = Callable[[str], Path]
SITES = ("Left Thigh", "Left Shank", "Left Foot", "Right Thigh", "Right Shank", "Right Foot")


def trial(
    names: Mapping[str, str], started: str = "", speed_rad_s: float = 1.0, program: str = "apdm"
) -> ImportedTrial:
    """Sensors by serial, which turn to and fro."""
    time_s = np.arange(1000) / 100.0
    gyr = speed_rad_s * np.sin(time_s)[:, None] * np.ones(3)
    block = ImuBlock("", time_s, gyr, np.tile([0.0, 0.0, 9.81], (1000, 1)))
    sensors = [
        ImportedSensor(name, (serial,), "a.csv", replace(block, sensor=serial), SensorInfo(serial, rate_hz=100.0))
        for serial, name in names.items()
    ]
    return ImportedTrial(program, tuple(sensors), started=started)


def named(*names: str) -> dict[str, str]:
    return {f"S{number}": name for number, name in enumerate(names)}


def test_names_say_the_sites() -> None:
    (draft,) = drafts_of([("walk", trial(named(*SITES, "Lumbar")))])
    assert [sensor.site for sensor in draft.sensors] == [*LEG_SITES, None]
    assert {sensor.origin for sensor in draft.sensors[:6]} == {Origin.NAME}
    assert draft.sensors[6].origin is Origin.NOTHING


def test_two_sensors_of_one_name_are_at_no_site() -> None:
    (draft,) = drafts_of([("walk", trial(named("Left Foot", "left foot", "Left Shank")))])
    assert [sensor.site for sensor in draft.sensors] == [None, None, Site.LEFT_SHANK]


def test_a_sensor_that_is_called_otherwise_in_another_trial_is_at_no_site() -> None:
    trials = [("a", trial({"S1": "Left Foot"})), ("b", trial({"S1": "Right Foot"}))]
    (draft,) = drafts_of(trials)
    assert draft.sensors[0].site is None


@pytest.mark.parametrize(
    ("other", "count"),
    [
        (trial({"S1": "Left Foot"}, "2026-03-09T15:00:00"), 1),
        (trial({"S1": "Left Foot"}), 1),  # it does not report its day
        (trial({"S1": "Left Foot"}, "2026-03-10T09:00:00"), 2),
        (trial({"S9": "Left Foot"}, "2026-03-09T15:00:00"), 2),  # another station's sensors
        (trial({"S1": "Left Foot"}, "2026-03-09T15:00:00", program="xsens-mtmanager"), 2),
    ],
)
def test_a_session_is_one_day_of_one_program_and_its_sensors(other: ImportedTrial, count: int) -> None:
    drafts = drafts_of([("b", trial({"S1": "Left Foot"}, "2026-03-09T09:00:00")), ("a", other)])
    assert len(drafts) == count
    assert drafts[0].started == "2026-03-09T09:00:00"


def test_recordings_are_in_order_of_time() -> None:
    trials = [(hour, trial({"S1": "a"}, f"2026-03-09T{hour}:00:00")) for hour in ("11", "09", "10")]
    (draft,) = drafts_of(trials)
    assert [one.title for one in draft.recordings] == ["09", "10", "11"]


@pytest.mark.parametrize(
    ("title", "speed_rad_s", "kind", "origin"),
    [
        ("static_01", 1.0, RecordingKind.STANDING, Origin.NAME),
        ("Calibration", 1.0, RecordingKind.FREE_MOTION, Origin.NAME),
        ("Gait 3", 0.0, RecordingKind.WALKING, Origin.NAME),
        ("trial 3", 0.05, RecordingKind.STANDING, Origin.MOTION),
        ("trial 3", 1.0, RecordingKind.WALKING, Origin.NOTHING),
    ],
)
def test_what_a_recording_is(title: str, speed_rad_s: float, kind: RecordingKind, origin: Origin) -> None:
    (draft,) = drafts_of([(title, trial({"S1": "a"}, speed_rad_s=speed_rad_s))])
    assert (draft.recordings[0].kind, draft.recordings[0].origin) == (kind, origin)


def test_a_session_is_what_was_confirmed() -> None:
    trials = [(title, trial(named("Left Thigh", "Left Shank", "Lumbar"))) for title in ("static", "walk", "bad")]
    (draft,) = drafts_of(trials)
    sites = {"S0": Site.RIGHT_THIGH, "S1": Site.LEFT_SHANK, "S2": None}
    kinds = [RecordingKind.WALKING, RecordingKind.STANDING, None]  # in order of names: bad, static, walk
    session = session_of(draft, kinds, sites, "2026-03-09")
    by_title = {one.title: kind for one, kind in zip(draft.recordings, kinds, strict=True)}
    assert {one.note: one.kind for one in session.recordings} == {
        title: kind for title, kind in by_title.items() if kind is not None
    }
    for recording in session.recordings:
        assert {site: block.sensor for site, block in recording.imu.items()} == {
            Site.RIGHT_THIGH: "S0",
            Site.LEFT_SHANK: "S1",
        }
    assert session.started == "2026-03-09"
    assert {finding.numbers["name"] for finding in session.findings if finding.key == "file_left_out"} == {"Lumbar"}


def test_the_files_know_their_day_better_than_somebody_who_types_it() -> None:
    (draft,) = drafts_of([("walk", trial({"S1": "Left Foot"}, "2026-03-09T09:00:00"))])
    session = session_of(draft, [RecordingKind.WALKING], {"S1": Site.LEFT_FOOT}, "2025-01-01")
    assert session.started == session.recordings[0].started == "2026-03-09T09:00:00"


def test_sensors_that_shared_a_receiver_have_its_clock_unless_their_files_give_them_others() -> None:
    (draft,) = drafts_of([("walk", trial(named("Left Thigh", "Left Shank")))])
    sites = {"S0": Site.LEFT_THIGH, "S1": Site.LEFT_SHANK}
    assert draft.is_clock_open
    for is_one, clocks in ((True, {"one receiver"}), (False, {""})):
        session = session_of(draft, [RecordingKind.WALKING], sites, is_one_receiver=is_one)
        assert {info.clock for info in session.sensors.values()} == clocks
    known = trial(named("Left Thigh", "Left Shank"))
    on_own = [replace(one, info=replace(one.info, clock=one.name)) for one in known.sensors]
    (draft,) = drafts_of([("walk", replace(known, sensors=tuple(on_own)))])
    assert not draft.is_clock_open
    with pytest.raises(FileRefusedError, match='gives it the clock "Left Thigh", so the sensors did not share one'):
        session_of(draft, [RecordingKind.WALKING], sites, is_one_receiver=True)


def test_two_sensors_at_one_site_are_refused() -> None:
    (draft,) = drafts_of([("walk", trial(named("a", "b")))])
    with pytest.raises(FileRefusedError, match="left_foot is given twice"):
        session_of(draft, [RecordingKind.WALKING], {"S0": Site.LEFT_FOOT, "S1": Site.LEFT_FOOT})


@pytest.fixture(scope="module")
def simulated() -> dict[str, ImportedTrial]:
    """A visit whose sensors say nothing of where they were."""
    required = (Standing(), FreeMotion(), Walk())
    made = simulation_of(WalkerSettings(recordings=required))
    trials = {}
    for recording in made.session.recordings:
        sensors = [
            ImportedSensor(f"S-{site[::-1]}", (), "a.csv", block, SensorInfo(serial=site[::-1]))
            for site, block in recording.imu.items()
        ]
        trials[recording.name] = ImportedTrial("apdm", tuple(sensors))
    return trials


def test_the_motion_shows_the_sites_but_for_the_side(simulated: Mapping[str, ImportedTrial]) -> None:
    (draft,) = drafts_of(list(simulated.items()))
    assert {sensor.site for sensor in draft.sensors} == {None}
    chains = chains_of_motion(draft, [sensor.key for sensor in draft.sensors])
    assert chains is not None
    assert chains.is_certain
    first = Site(chains.legs[0].thigh[::-1]).leg_side
    assert {key: site.value[::-1] for key, site in chains.sites(first).items()} == {
        sensor.key: sensor.key for sensor in draft.sensors
    }
    wrong = chains.sites(first.other)
    assert all(Site(key[::-1]).side is not site.side for key, site in wrong.items())


def test_without_motion_nothing_is_reported(simulated: Mapping[str, ImportedTrial]) -> None:
    name, standing = next(iter(simulated.items()))
    (draft,) = drafts_of([(name, standing)])
    keys = [sensor.key for sensor in draft.sensors]
    assert draft.recordings[0].kind is RecordingKind.STANDING
    assert chains_of_motion(draft, keys) is None
    (moving,) = drafts_of(list(simulated.items()))
    assert chains_of_motion(moving, keys[:1]) is None
    assert chains_of_motion(moving, [*keys, "another"]) is None


def test_a_real_walk_shows_its_legs(test_data: FindData) -> None:
    folder = test_data("vendor_exports/xsens_mtmanager")
    reported = {
        sensor.attrib["name"].lstrip("_"): sensor.findtext("name_in_model") or ""
        for sensor in ElementTree.parse(folder / "OpenSenseExample_myIMUMappings.xml").iter("ExperimentalSensor")
    }
    (draft,) = drafts_of([("walk", mtmanager_trial(sorted(folder.glob("OpenSenseExample_*.txt"))))])
    worn = [key for key, bone in reported.items() if bone.split("_")[0] in ("femur", "tibia", "calcn")]
    chains = chains_of_motion(draft, worn)
    assert chains is not None
    assert chains.is_certain
    legs = [[reported[sensor].removesuffix("_imu") for sensor in leg.sensors] for leg in chains.legs]
    assert sorted(legs) == [["femur_l", "tibia_l", "calcn_l"], ["femur_r", "tibia_r", "calcn_r"]]
    assert chains.sites(Side.LEFT)[chains.legs[0].thigh] is Site.LEFT_THIGH
