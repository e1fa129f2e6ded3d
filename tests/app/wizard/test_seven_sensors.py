"""A visit with a sensor on the pelvis: placed, recorded, shown live, silent and back, taken up again, replayed."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QObject, QTimer
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from app.storage.analysis_content import packed
from app.storage.exchange import session_with_samples
from app.wizard.free_motion.step import FreeMotionStep
from app.wizard.sensors.replays import replay_of
from app.wizard.sensors.step import SensorsStep
from app.wizard.standing.step import StandStillStep
from app.wizard.step import Step
from app.wizard.visit import Visit
from app.wizard.walking.step import WalkingStep
from app.wizard.worn_corrections import opposite
from app.wizard.worn_sensors import WornSensors
from app.workers.library_controller import LibraryController
from core.body import LEG_JOINTS, LEG_SITES, Side, Site, hip_of
from core.session import RecordingKind, Session
from devices.decoders import DECODERS
from devices.files.session_folder import read_session
from devices.simulation.replay import ReplaySource
from devices.simulation.walker import DEMONSTRATION, FreeMotion, Motion, Standing, Walk
from tests.app.storage.library.folder_export import write_folder
from tests.app.wizard.begun_visit import begin, record
from tests.app.wizard.conftest import SPEED
from tests.app.wizard.present import present
from tests.app.wizard.pressing import press
from tests.simulated import session_of

HIPS = {hip_of(side) for side in Side}
LIVE_SPEED = 4.0
TICK_MS = 10


@pytest.fixture(scope="module")
def simulated_session() -> Session:
    played = (
        Standing(duration_s=10.0),
        FreeMotion("free motion", duration_s=12.8, motion=Motion.LUNGES),
        FreeMotion("legs", duration_s=14.0, is_in_turn=True),
        Walk(strides=24, turn_rad=np.pi),
    )
    return session_of(replace(DEMONSTRATION, sites=tuple(Site), recordings=played))


@pytest.fixture
def worn() -> dict[str, Site]:
    return {f"DEMO-{site}": site for site in Site}


def test_the_pelvis_stays_where_sides_are_changed() -> None:
    assert opposite(Site.PELVIS) is Site.PELVIS
    assert opposite(Site.LEFT_FOOT) is Site.RIGHT_FOOT


@pytest.mark.parametrize(
    ("sites", "price"),
    [
        (tuple(Site), ""),
        (
            tuple(site for site in Site if site is not Site.LEFT_THIGH),
            "No sensor at L thigh: no angles for left knee and left hip.",
        ),
        (LEG_SITES, ""),  # nobody asked for hips
        (LEG_SITES[1:], "No sensor at L thigh: no angles for left knee."),
    ],
)
def test_what_is_missing_costs_hips_only_where_there_is_a_pelvis(
    qapp: QApplication, sites: tuple[Site, ...], price: str
) -> None:
    parent = QObject()
    sensors = WornSensors(parent)
    sensors.assign_all({f"0A{number}": site for number, site in enumerate(sites)})
    assert sensors.price_of_missing() == price
    assert set(sensors.hips) == {hip for hip in HIPS if {Site.PELVIS, hip.distal} <= set(sites)}
    assert set(sensors.joints) <= set(LEG_JOINTS)


def recorded(qtbot: QtBot, visit: Visit, worn: dict[str, Site]) -> None:
    """A standing, lunges, legs and a walk, evaluated."""
    begin(qtbot, visit, worn)
    record(qtbot, visit, RecordingKind.STANDING, 4.0)
    for seconds in (12.0, 13.0):
        with qtbot.waitSignal(visit.evaluation.done):
            record(qtbot, visit, RecordingKind.FREE_MOTION, seconds)
    with qtbot.waitSignal(visit.evaluation.done):
        record(qtbot, visit, RecordingKind.WALKING, 24.0)


@pytest.mark.endurance
def test_all_that_is_kept_of_a_session_holds_the_pelvis(
    qtbot: QtBot, controller: LibraryController, visit: Visit, worn: dict[str, Site], tmp_path: Path
) -> None:
    recorded(qtbot, visit, worn)
    assert set(visit.evaluation.hips) == HIPS
    assert visit.session is not None
    for recording in visit.recordings.every:
        assert set(present(recording.stored.placement).sensors) == set(Site)
        assert set(present(recording.read_back).imu) == set(Site)
    again = Visit(controller, [])
    with qtbot.waitSignals([again.resumed, again.evaluation.done]):
        again.resume(visit.session.id)
    assert set(again.rests) == set(worn)
    assert set(again.evaluation.hips) == HIPS
    one, other = present(visit.evaluation.analysis), present(again.evaluation.analysis)
    assert packed(one) == packed(other)
    with qtbot.waitSignal(again.evaluation.done):
        again.worn.swap_sides()
    placement = present(again.recordings.walks[-1].stored.placement)
    assert placement.sensors[Site.PELVIS].name == "DEMO-pelvis"
    assert placement.sensors[Site.LEFT_FOOT].name == "DEMO-right_foot"
    again.finish()

    opened = present(controller.state).library
    stored = opened.library.sessions.get(visit.session.id)
    played = replay_of(session_with_samples(opened, stored, DECODERS, lambda *_: None), "again")
    assert played.worn["DEMO-pelvis"] is Site.PELVIS
    for is_identified in (False, True):
        folder = tmp_path / f"{is_identified}"
        write_folder(opened, stored.id, folder, DECODERS, is_identified=is_identified)
        assert len(list(folder.rglob("pelvis.csv"))) == len(stored.recordings)
        session = read_session(folder)
        assert all(Site.PELVIS in recording.imu for recording in session.recordings)
        assert ("DEMO" in session.sensors[Site.PELVIS].serial) is is_identified


@pytest.fixture
def source(simulated_session: Session, request: pytest.FixtureRequest) -> ReplaySource:
    """Slow enough for what is looked at live."""
    return ReplaySource(simulated_session, speed=LIVE_SPEED if "live" in request.node.name else SPEED)


class Looked:
    """A step that is entered and looked at as the wizard does."""

    def __init__(self, step: Step) -> None:
        self.step, self._timer = step, QTimer()
        step.page.resize(1064, 600)
        step.page.show()
        step.enter()
        self._timer.setInterval(TICK_MS)
        self._timer.timeout.connect(step.tick)
        self._timer.start()

    def end(self) -> None:
        self._timer.stop()
        self.step.leave()


@pytest.fixture
def looked(qtbot: QtBot, visit: Visit) -> Iterator[list[Looked]]:
    steps: list[Looked] = []
    yield steps
    for one in steps:
        one.end()
    qtbot.waitUntil(lambda: visit.recordings.is_idle)
    for one in steps:
        one.step.deleteLater()


@pytest.mark.endurance
def test_live_hips_are_thin_then_sure_and_a_silent_pelvis_costs_them_alone(
    qtbot: QtBot, begun: Visit, source: ReplaySource, looked: list[Looked]
) -> None:
    record(qtbot, begun, RecordingKind.STANDING, 4.0)
    with qtbot.waitSignal(begun.evaluation.done):
        record(qtbot, begun, RecordingKind.FREE_MOTION, 12.0)
    step = WalkingStep(begun)
    qtbot.addWidget(step.page)
    looked.append(Looked(step))
    page = step.page
    assert page.charts.hip.isVisible() is False  # the walks stand there until one is recorded
    with qtbot.waitSignal(begun.recordings.begun):
        press(step)
    qtbot.waitUntil(lambda: set(page.live.hips) == set(Side))
    assert page.charts.hip.isVisible()
    assert page.live.hips[Side.LEFT].is_provisional
    qtbot.waitUntil(lambda: not any(one.is_provisional for one in page.live.hips.values()))
    hip_deg = np.rad2deg(page.live.hips[Side.LEFT].angle_rad[-300:])
    assert np.nanmax(hip_deg) - np.nanmin(hip_deg) > 25.0
    pelvis = begun.sensors.sensor_at[Site.PELVIS]
    source.silence(pelvis)
    qtbot.waitUntil(lambda: page.notice.text.startswith("Pelvis: no signal for"))
    assert "Recording continues, including knees and ankles" in page.notice.text
    assert page.live.missing == (Site.PELVIS,)
    assert page.live.now_s - page.live.knees[Side.LEFT].time_s[-1] < 1.0
    assert page.live.now_s - page.live.hips[Side.LEFT].time_s[-1] > 1.0
    source.wake(pelvis)
    qtbot.waitUntil(lambda: page.notice.text.startswith("Pelvis: signal back"))
    with qtbot.waitSignal(begun.recordings.ended):
        press(step)
    walk = begun.recordings.walks[-1]
    assert Site.PELVIS in present(walk.read_back).imu


@pytest.mark.endurance
def test_live_gauges_of_hips_close_and_never_hold_up_the_free_motion(
    qtbot: QtBot, begun: Visit, looked: list[Looked]
) -> None:
    record(qtbot, begun, RecordingKind.STANDING, 4.0)
    step = FreeMotionStep(begun)
    qtbot.addWidget(step.page)
    looked.append(Looked(step))
    assert all(hip.isVisible() for hip in step.page.hips.values())
    qtbot.waitUntil(lambda: all(hip.face.is_met for hip in step.page.hips.values()))


@pytest.mark.endurance
def test_live_free_motion_ends_though_the_hips_are_open(
    qtbot: QtBot, begun: Visit, source: ReplaySource, looked: list[Looked]
) -> None:
    record(qtbot, begun, RecordingKind.STANDING, 4.0)
    source.ask(RecordingKind.FREE_MOTION)  # the lunges: the circling legs come next
    step = FreeMotionStep(begun)
    qtbot.addWidget(step.page)
    with qtbot.waitSignal(step.done):
        looked.append(Looked(step))
    assert not any(hip.face.is_met for hip in step.page.hips.values())


@pytest.mark.endurance
def test_live_standing_does_not_wait_for_a_silent_pelvis(
    qtbot: QtBot, visit: Visit, worn: dict[str, Site], source: ReplaySource, looked: list[Looked]
) -> None:
    begin(qtbot, visit, worn)
    source.silence("DEMO-pelvis")
    step = StandStillStep(visit)
    qtbot.addWidget(step.page)
    looked.append(Looked(step))
    with qtbot.waitSignal(visit.recordings.ended):
        press(step)
    assert set(visit.rests) == set(worn) - {"DEMO-pelvis"}


@pytest.mark.endurance
def test_live_motion_shows_who_wears_the_pelvis(
    qtbot: QtBot, visit: Visit, worn: dict[str, Site], source: ReplaySource, looked: list[Looked]
) -> None:
    begin(qtbot, visit, worn)
    sensors = SensorsStep(visit)
    qtbot.addWidget(sensors.page)
    sensors.enter()
    sensors.page.ways.segments[2].click()
    assert visit.sensors.is_left_to_motion
    sensors.leave()
    source.ask(RecordingKind.FREE_MOTION)
    step = FreeMotionStep(visit)
    qtbot.addWidget(step.page)
    looked.append(Looked(step))
    qtbot.waitUntil(lambda: bool(visit.sensors.site_of))
    assert visit.sensors.site_of == worn
