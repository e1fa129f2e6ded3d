"""A stored session, of the library or of a folder, is offered as a source, and plays as if it were measured now."""

import shutil
from dataclasses import replace
from pathlib import Path

import pytest
from PySide6.QtWidgets import QFileDialog
from pytestqt.qtbot import QtBot

from app.storage.exchange import import_session
from app.storage.opened import OpenedLibrary
from app.storage.stored import LibraryError
from app.wizard.sensors.replays import offered, replay_of
from app.wizard.sensors.step import REPLAY, SensorsStep
from app.wizard.visit import Visit
from app.workers.library_controller import LibraryController
from core.body import LEG_SITES
from core.samples import SensorInfo
from core.session import Patient, RecordingKind, Session
from devices.files.session_folder import write_session
from tests.app.library_answers import asked
from tests.app.wizard.present import present
from tests.app.wizard.pressing import press
from tests.safety.live_material import numbered, numbered_session


@pytest.fixture(scope="module")
def short_session() -> Session:
    """Every kind of recording, a second each."""
    one = numbered_session("S", 6).recordings[0]
    short = {site: numbered(block.sensor, 200) for site, block in one.imu.items()}
    known = {site: SensorInfo(serial=block.sensor, rate_hz=200.0) for site, block in short.items()}
    kinds = zip(("standing", "free motion", "walk 1"), RecordingKind, strict=True)
    recordings = tuple(replace(one, name=name, folder=kind, kind=kind, imu=short) for name, kind in kinds)
    return Session(recordings, Patient(code="P-7"), known, started="2026-10-24T09:00:00+02:00")


@pytest.fixture(scope="module")
def folder(short_session: Session, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("stored") / "last_week"
    write_session(short_session, folder)
    return folder


def stored(controller: LibraryController, session: Session) -> None:
    """Let the library hold the session, of another patient."""

    def keep(opened: OpenedLibrary) -> None:
        import_session(opened, session, lambda _share, _what: None, session.patient.code)

    controller.run(keep, None, None, controller)


def test_a_folder_becomes_the_sensors_with_their_places(
    qtbot: QtBot, visit: Visit, step: SensorsStep, folder: Path
) -> None:
    assert step.page.nothing.buttons[-1].text() == "Replay of a stored session"
    step.page.nothing.buttons[-1].click()
    assert step.page.stored.isVisible()
    with qtbot.waitSignal(visit.sensors.opened):
        step.stored.replay_folder(folder)
    assert visit.sensors.site_of == {f"S-{site}": site for site in LEG_SITES}, "as the folder tells it"
    assert visit.is_simulated, "it was not measured now"
    assert step.page.list.isVisible()
    assert step.page.sources.currentText() == "Replay of last_week: 6 found"
    assert step.state.name == "DONE"
    sending = visit.sensors.acquisition
    step.page.source_chosen.emit(REPLAY)
    for _ in range(16):
        step.tick()
    assert step.page.stored.isVisible()
    step.page.stored.back.click()
    assert step.page.list.isVisible()
    assert visit.sensors.acquisition is sending, "it goes on while another one is looked for"


@pytest.mark.endurance
def test_a_session_of_the_library_is_chosen_by_code_and_date(
    qtbot: QtBot, controller: LibraryController, visit: Visit, step: SensorsStep, short_session: Session
) -> None:
    stored(controller, short_session)
    step.page.source_chosen.emit(REPLAY)
    qtbot.waitUntil(lambda: bool(step.page.stored.sessions.lines))
    (line,) = step.page.stored.sessions.lines
    assert (line.code, line.when, line.sessions) == ("P-7", "24 Oct 2026", "3 recordings")  # type: ignore[union-attr]  # lines of patients only
    bar = step.bar()
    assert bar.primary is not None
    assert (bar.primary.text, bar.primary.is_enabled) == ("Replay", True)
    with qtbot.waitSignal(visit.sensors.opened):
        press(step)
    assert visit.sensors.site_of == {f"S-{site}": site for site in LEG_SITES}
    assert present(visit.sensors.choice).name == "Replay of P-7, 24 Oct 2026"
    found = asked(qtbot, controller, lambda opened: offered(opened, line.id))
    assert found == [], "neither the session itself, nor one without recordings"


def test_a_folder_is_chosen_beside_the_page(qtbot: QtBot, visit: Visit, step: SensorsStep, folder: Path) -> None:
    step.page.source_chosen.emit(REPLAY)
    step.page.stored.folder.click()
    dialog = present(step.stored.dialog)
    assert dialog.fileMode() is QFileDialog.FileMode.Directory
    with qtbot.waitSignal(visit.sensors.opened):
        dialog.fileSelected.emit(str(folder))
        dialog.close()


def test_what_cannot_be_read_is_stated_in_the_page(
    qtbot: QtBot, visit: Visit, step: SensorsStep, folder: Path, tmp_path: Path
) -> None:
    step.page.source_chosen.emit(REPLAY)
    step.stored.replay_folder(tmp_path)
    qtbot.waitUntil(lambda: "is not a session folder" in step.page.stored.notice.text)
    assert step.page.stored.isVisible()
    broken = shutil.copytree(folder, tmp_path / "broken")
    (broken / "walking" / "left_foot.csv").write_text("time_s,left\n1,2\n")
    step.stored.replay_folder(broken)
    qtbot.waitUntil(lambda: "left_foot.csv" in step.page.stored.notice.text)
    assert visit.sensors.acquisition is None
    step.page.stored.back.click()
    assert step.page.nothing.isVisible()


def test_a_reading_is_stopped(qtbot: QtBot, visit: Visit, step: SensorsStep, folder: Path) -> None:
    step.page.source_chosen.emit(REPLAY)
    step.stored.replay_folder(folder)
    assert step.page.searching.isVisible()
    step.page.searching.stop.click()
    assert step.page.stored.isVisible()
    qtbot.wait(100)
    assert visit.sensors.choice is None


def test_whoever_chooses_other_sensors_meanwhile_has_those(
    qtbot: QtBot, visit: Visit, step: SensorsStep, folder: Path
) -> None:
    step.page.source_chosen.emit(REPLAY)
    step.stored.replay_folder(folder)
    with qtbot.waitSignal(visit.sensors.opened):
        step.page.source_chosen.emit("fast")
    assert step.page.list.isVisible()
    qtbot.wait(300)  # longer than it takes to read the folder
    assert present(visit.sensors.choice).key == "fast"


def test_only_demonstration_patients_are_offered_a_replay(qtbot: QtBot, visit: Visit) -> None:
    visit.patient.edit(Patient(code="P-7"))
    step = SensorsStep(visit)
    qtbot.addWidget(step.page)
    step.page.show()
    step.enter()
    assert [step.page.sources.itemText(k) for k in range(step.page.sources.count())] == []
    assert "codes that begin with DEMO" in step.page.nothing.left_out
    step.leave()
    step.deleteLater()


def test_discarded_walks_are_not_played(short_session: Session) -> None:
    """Nor is a session of which nothing is left."""
    discarded = tuple(replace(recording, is_kept=False) for recording in short_session.recordings)
    with pytest.raises(LibraryError, match="This session has no recording that can be replayed"):
        replay_of(replace(short_session, recordings=discarded), "it")
    empty = replace(short_session.recordings[2], name="walk 2", imu={})
    choice = replay_of(replace(short_session, recordings=(*discarded[:2], short_session.recordings[2], empty)), "it")
    acquisition = choice.make()
    assert acquisition.is_simulated
    assert choice.is_simulated
