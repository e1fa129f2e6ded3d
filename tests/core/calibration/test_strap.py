"""A strap that slips is named, with its time, in whole walks; walking, turning and loose tissue are no slip."""

from dataclasses import replace

import numpy as np
import pytest

from core.analysis import analyse
from core.angles.measure import pairs_of
from core.body import LEG_JOINTS, LEG_SITES, Side, Site
from core.calibration.strap import Slip, slips, turns_over
from core.gait.strides import Reason
from core.results import Method
from core.samples import RateKind
from core.session import Recording, Session
from core.signal.sensors import SensorTracks
from core.timed.protocols import PlannedTest, TimedProtocol
from devices.simulation.walker import (
    CourseKind,
    FreeMotion,
    SimulatedSession,
    Standing,
    TimedCourse,
    Tissue,
    Walk,
    WalkerSettings,
)
from tests.core.cut_blocks import about_the_vertical, part_of, turned
from tests.simulated import session_of, simulation_of

pytestmark = pytest.mark.endurance  # minutes in all: the default run has three

WALK = "walk 1"
SLIP_S = 22.0


@pytest.fixture(scope="module")
def soft() -> SimulatedSession:
    return patient(Tissue.SOFT, turn_rad=0.0)


def patient(tissue: Tissue, turn_rad: float) -> SimulatedSession:
    recordings = (Standing(), FreeMotion(), Walk(WALK, strides=32, turn_rad=turn_rad))
    return simulation_of(WalkerSettings(seed=5, recordings=recordings, tissue=tissue))


def slipped(session: Session, site: Site, angle_rad: float, at_s: float = SLIP_S) -> Session:
    """The same session, with the sensor turned about its limb from `at_s` of the walk on."""
    standing, free_motion, walk = session.recordings
    return replace(session, recordings=(standing, free_motion, with_turned(walk, standing, site, angle_rad, at_s)))


def with_turned(
    recording: Recording, standing: Recording, site: Site, angle_rad: float, from_s: float = -np.inf
) -> Recording:
    turn = about_the_vertical(standing.imu[site], angle_rad)
    return replace(recording, imu={**recording.imu, site: turned(recording.imu[site], turn, from_s)})


def found_in(session: Session, simulated: SimulatedSession) -> list[Slip]:
    tracks = SensorTracks(session, session.recordings, frozenset(), RateKind.INSTANTANEOUS)
    walk = session.recordings[2]
    turns = {}
    for joint in LEG_JOINTS:
        truth = simulated.truth.recordings[WALK].joints[joint]
        (pair,) = pairs_of(tracks, walk, joint, tracks.blocks(walk)[0], 0.0)
        turns[joint] = turns_over(pair, truth.functional_proximal, truth.functional_distal)
    return slips(turns)


@pytest.mark.parametrize("site", list(LEG_SITES))
@pytest.mark.parametrize("angle_deg", [12.0, -20.0])
def test_names_the_strap_that_slipped_and_when(soft: SimulatedSession, site: Site, angle_deg: float) -> None:
    (slip,) = found_in(slipped(soft.session, site, np.deg2rad(angle_deg)), soft)
    assert slip.site is site
    assert slip.from_s == pytest.approx(SLIP_S, abs=5.0)
    assert np.rad2deg(slip.turn_rad) == pytest.approx(angle_deg, abs=0.25 * abs(angle_deg))


def test_walking_with_a_turn_is_no_slip() -> None:
    simulated = patient(Tissue.REAL, turn_rad=np.pi)
    assert found_in(simulated.session, simulated) == []


def test_a_slip_of_three_degrees_is_not_reported(soft: SimulatedSession) -> None:
    assert found_in(slipped(soft.session, Site.LEFT_SHANK, np.deg2rad(3.0)), soft) == []


def test_axes_that_were_never_right_are_no_slip() -> None:
    """Seed 11's left ankle is 15 deg off with the axes as published; the robust ones say that nothing slipped."""
    recordings = (Standing(), FreeMotion(), Walk(WALK, strides=14))
    session = session_of(WalkerSettings(seed=11, recordings=recordings, tissue=Tissue.REAL))
    found = analyse(session, method=Method.PUBLISHED)
    assert "strap_slipped" not in {one.key for one in found.findings}
    assert all(gait.strides.is_used.any() for gait in found.recordings[-1].gait.values())


def test_a_slip_is_named_with_the_axes_as_published_too(soft: SimulatedSession) -> None:
    found = analyse(slipped(soft.session, Site.RIGHT_SHANK, np.deg2rad(20.0)), method=Method.PUBLISHED)
    assert [one.where for one in found.findings if one.key == "strap_slipped"] == [f"{WALK}, right_shank"]


def test_an_analysis_names_the_slip_and_leaves_out_the_strides_after_it(soft: SimulatedSession) -> None:
    analysis = analyse(slipped(soft.session, Site.RIGHT_SHANK, np.deg2rad(20.0)))
    (finding,) = [one for one in analysis.findings if one.key == "strap_slipped"]
    assert finding.where == f"{WALK}, right_shank"
    assert finding.numbers["from_s"] == pytest.approx(SLIP_S, abs=5.0)
    walk = next(recording for recording in analysis.recordings if recording.name == WALK)
    right, left = walk.gait[Side.RIGHT].strides, walk.gait[Side.LEFT].strides
    assert right.is_used.sum() > 5
    assert right.end_s[right.is_used].max() <= finding.numbers["from_s"]
    assert Reason.SLIPPED in right.reason
    assert Reason.SLIPPED not in left.reason


@pytest.mark.parametrize(
    "at_s", [23.0, pytest.param(22.0, marks=pytest.mark.endurance), pytest.param(24.7, marks=pytest.mark.endurance)]
)
def test_no_stride_after_a_slip_is_used_wherever_in_its_window_it_lies(soft: SimulatedSession, at_s: float) -> None:
    session = slipped(soft.session, Site.LEFT_THIGH, np.deg2rad(-15.0), at_s)
    analysis = analyse(session)
    assert "strap_slipped" in {one.key for one in analysis.findings}
    strides = analysis.recordings[-1].gait[Side.LEFT].strides
    assert strides.end_s[strides.is_used].max() <= at_s
    assert strides.end_s[strides.is_used].max() > at_s - 10.0


@pytest.mark.parametrize(
    ("between", "is_used"),
    [(Standing("in between"), False), pytest.param(FreeMotion("in between"), True, marks=pytest.mark.endurance)],
)
def test_a_slip_holds_until_the_next_free_motion_not_the_next_standing(
    between: Standing | FreeMotion, is_used: bool
) -> None:
    recordings = (Standing(), FreeMotion(), Walk(WALK, strides=32), between, Walk("walk 2"))
    session = session_of(WalkerSettings(seed=5, recordings=recordings, tissue=Tissue.SOFT))
    early, late = session.recordings[:3], session.recordings[3:]
    late = tuple(with_turned(one, early[0], Site.LEFT_SHANK, np.deg2rad(15.0)) for one in late)
    early = slipped(replace(session, recordings=early), Site.LEFT_SHANK, np.deg2rad(15.0)).recordings
    analysis = analyse(replace(session, recordings=early + late))
    assert [one.where for one in analysis.findings if one.key == "strap_slipped"] == [f"{WALK}, left_shank"]
    strides = {side: gait.strides for side, gait in analysis.recordings[-1].gait.items()}
    assert strides[Side.LEFT].is_used.any() == is_used
    assert strides[Side.RIGHT].is_used.any()


def test_a_slip_in_one_walk_holds_for_the_next(soft: SimulatedSession) -> None:
    session = slipped(soft.session, Site.LEFT_FOOT, np.deg2rad(25.0))
    standing, free_motion, walk = session.recordings
    late = {site: part_of(block, 25.0, 45.0) for site, block in walk.imu.items()}
    early = {site: part_of(block, 0.0, 25.0) for site, block in walk.imu.items()}
    walks = (replace(walk, imu=early), replace(walk, name="walk 2", folder="walk_2", imu=late))
    analysis = analyse(replace(session, recordings=(standing, free_motion, *walks)))
    assert [one.where for one in analysis.findings if one.key == "strap_slipped"] == [f"{WALK}, left_foot"]
    second = next(recording for recording in analysis.recordings if recording.name == "walk 2")
    assert not second.gait[Side.LEFT].strides.is_used.any()
    assert second.gait[Side.RIGHT].strides.is_used.any()


@pytest.mark.parametrize("seed", [1, 5])
def test_walking_again_slower_is_no_slip_and_a_slip_between_the_walks_is_reported(seed: int) -> None:
    recordings = (Standing(), FreeMotion(), Walk(WALK, strides=14), Walk("walk 2", strides=14, speed_m_s=0.8))
    session = session_of(WalkerSettings(seed=seed, recordings=recordings, tissue=Tissue.SOFT))
    assert "strap_slipped" not in {one.key for one in analyse(session).findings}
    *before, second = session.recordings
    second = with_turned(second, before[0], Site.LEFT_THIGH, np.deg2rad(15.0))
    analysis = analyse(replace(session, recordings=(*before, second)))
    assert [one.where for one in analysis.findings if one.key == "strap_slipped"] == ["walk 2, left_thigh"]


def test_rising_from_a_chair_is_no_slip_and_what_slips_meanwhile_shows_in_the_next_walk() -> None:
    rises = TimedCourse(CourseKind.SIT_TO_STAND, seed=1, rise_s=1.4, name="rises")
    recordings = (Standing(), FreeMotion(), Walk(WALK, strides=12), rises, Walk("walk 2", strides=12))
    session = session_of(WalkerSettings(seed=5, recordings=recordings, tissue=Tissue.SOFT))

    def reported(test: PlannedTest | None, session: Session) -> list[str]:
        taken = tuple(replace(one, test=test) if one.name == "rises" else one for one in session.recordings)
        findings = analyse(replace(session, recordings=taken)).findings
        return [finding.where.split(",")[0] for finding in findings if finding.key == "strap_slipped"]

    rising = PlannedTest(TimedProtocol.SIT_TO_STAND)
    assert "rises" in reported(None, session)
    assert reported(rising, session) == []
    *before, last = session.recordings
    last = with_turned(last, before[0], Site.RIGHT_SHANK, np.deg2rad(20.0))
    assert reported(rising, replace(session, recordings=(*before, last))) == ["walk 2"]
