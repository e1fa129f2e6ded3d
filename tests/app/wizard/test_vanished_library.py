"""The library's folder is renamed amid a visit: what is recorded is kept, stated where, and in its session in the
end."""

import shutil
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from PySide6.QtCore import QSettings, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from app.acquisition.acquisition import Acquisition
from app.editing.session_recording import SessionRecording
from app.main_window import MainWindow
from app.storage.stored import RecordingState
from app.system.settings import Settings
from app.wizard import wizard as wizard_module
from app.wizard.step import StepId
from app.wizard.visit import Visit
from app.wizard.walking.step import WalkingStep
from app.wizard.wizard import Wizard
from app.wizard.worn_sensors import SourceChoice
from app.workers.library_controller import LibraryController
from core.body import LEG_SITES, Site
from core.session import RecordingKind
from devices.simulation.replay import ReplaySource
from tests.app.wizard.begun_visit import begin, record
from tests.app.wizard.conftest import PASSPHRASE, SPEED
from tests.app.wizard.present import present


@pytest.fixture(autouse=True)
def _own_data_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.storage.root.platformdirs.user_data_path", lambda *_, **__: tmp_path / "data")
    monkeypatch.setattr("app.wizard.reading_back.READ_AGAIN_MS", 50)


def start_walk(qtbot: QtBot, visit: Visit) -> None:
    acquisition = present(visit.sensors.acquisition)
    acquisition.ask(RecordingKind.WALKING)
    with qtbot.waitSignal(visit.recordings.begun):
        visit.recordings.begin(acquisition, RecordingKind.WALKING)


def is_whole(recording: SessionRecording, seconds: float) -> bool:
    """Whether each sensor has that much without a gap longer than two samples."""
    blocks = present(recording.read_back).imu.values()
    steps_s = [float((block.time_s[1:] - block.time_s[:-1]).max()) for block in blocks]
    return (
        len(steps_s) == len(LEG_SITES) and max(steps_s) < 0.05 and all(block.time_s[-1] >= seconds for block in blocks)
    )


@pytest.mark.endurance
def test_renamed_amid_a_walk_it_goes_on_and_is_read_back_whole(
    qtbot: QtBot, controller: LibraryController, looked_at: Visit, tmp_path: Path
) -> None:
    recordings, folder, elsewhere = looked_at.recordings, tmp_path / "library", tmp_path / "renamed"
    start_walk(qtbot, looked_at)
    qtbot.wait(200)
    stated: list[tuple[str, str]] = []
    recordings.troubled.connect(lambda *words: stated.append(words))
    with qtbot.waitSignals([recordings.troubled, controller.gone]):
        folder.rename(elsewhere)
    assert recordings.is_recording
    qtbot.waitUntil(lambda: len(stated) == 2)  # by the journal, and by who looks for the folder
    assert controller.state is not None
    assert all(str(present(controller.state.library.shelter).folder) in then for _, then in stated)
    qtbot.wait(200)
    refused: list[tuple[str, str]] = []
    recordings.refused.connect(lambda *words: refused.append(words))
    recordings.stop()
    qtbot.waitUntil(lambda: bool(refused))
    assert refused[0][0] == f"The library is no longer in {folder}."
    qtbot.wait(100)
    assert not recordings.is_idle
    assert not folder.exists()
    with qtbot.waitSignals([recordings.ended, controller.back]):
        elsewhere.rename(folder)
    (walk,) = recordings.walks
    assert (walk.stored.state, len(walk.stored.journals)) == (RecordingState.CLOSED, 2)
    assert is_whole(walk, 0.4 * SPEED)
    assert not list((tmp_path / "data").rglob("*.journal"))
    assert record(qtbot, looked_at, RecordingKind.WALKING, 2.0).stored.state is RecordingState.CLOSED


@pytest.mark.endurance
def test_renamed_between_two_walks_the_next_begins_all_the_same(
    qtbot: QtBot, controller: LibraryController, looked_at: Visit, tmp_path: Path
) -> None:
    recordings, folder, elsewhere = looked_at.recordings, tmp_path / "library", tmp_path / "renamed"
    record(qtbot, looked_at, RecordingKind.WALKING, 2.0)
    with qtbot.waitSignal(controller.gone):
        folder.rename(elsewhere)
    with qtbot.waitSignal(recordings.troubled) as stated:
        start_walk(qtbot, looked_at)
    assert stated.args is not None
    assert stated.args[0] == "The library folder is no longer available; recording continues."
    qtbot.wait(200)
    recordings.stop()
    qtbot.waitUntil(lambda: recordings._reading_back._readings > 16)  # more than it is patient with a busy library
    assert not recordings.is_idle
    with qtbot.waitSignals([recordings.ended, controller.back]):
        elsewhere.rename(folder)
    assert [(recording.details.name, recording.stored.state) for recording in recordings.walks] == [
        ("walk 1", RecordingState.CLOSED),
        ("walk 2", RecordingState.CLOSED),
    ]
    assert is_whole(recordings.walks[1], 0.2 * SPEED)
    files = sorted(path.name for path in (folder / "recordings").iterdir())
    assert files == sorted(journal.file for recording in recordings.walks for journal in recording.stored.journals)


Opened = Callable[[], MainWindow]


@pytest.fixture
def open_window(
    qtbot: QtBot,
    qapp: QApplication,
    source: ReplaySource,
    untouched_library: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> Opened:
    """Open the program on the library that is in a folder of its own, and log in where it asks for that."""
    choice = SourceChoice("fast", "Fast patient", lambda: Acquisition([source], source.now_ns), is_simulated=True)
    monkeypatch.setattr(wizard_module, "choices", lambda: (choice,))
    shutil.copytree(untouched_library, tmp_path / "library")

    def end(window: MainWindow) -> None:
        window.close()
        window.finish()

    def open_it() -> MainWindow:
        settings = Settings(QSettings(str(tmp_path / "settings.ini"), QSettings.Format.IniFormat))
        window = MainWindow(settings, tmp_path / "library")
        qtbot.addWidget(window, before_close_func=end)
        window.resize(1280, 800)
        window.show()
        return window

    return open_it


def log_in(qtbot: QtBot, window: MainWindow) -> None:
    page = present(window.entry).log_in
    qtbot.waitUntil(lambda: page.isVisible() and page.operator.count() == 1)
    page.passphrase.set_text(PASSPHRASE)
    QTest.keyClick(page.passphrase.line_edit, Qt.Key.Key_Return)
    qtbot.waitUntil(lambda: window.controller.state is not None and window.home is not None)


def notice_of(wizard: Wizard) -> str:
    step = wizard.current
    assert isinstance(step, WalkingStep)
    return step.page.notice.text


@pytest.mark.endurance
def test_a_whole_day_on_which_the_disk_comes_and_goes(
    qtbot: QtBot, open_window: Opened, worn: dict[str, Site], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Gone amid a walk, closed while it is gone, started without it, back: both walks are in their session, once."""
    folder, elsewhere = tmp_path / "library", tmp_path / "renamed"
    window = open_window()
    log_in(qtbot, window)
    present(window.home).session_requested.emit(None)
    wizard = present(window.wizard)
    visit = present(wizard.visit)
    monkeypatch.setattr("app.wizard.reading_back.READ_AGAIN_MS", 100)
    begin(qtbot, visit, worn)
    wizard._go_to(StepId.WALKING)
    start_walk(qtbot, visit)
    qtbot.wait(300)
    began_s = time.monotonic()
    folder.rename(elsewhere)
    qtbot.waitUntil(lambda: "stored encrypted on this computer" in notice_of(wizard))
    assert time.monotonic() - began_s < 2.0
    qtbot.wait(300)
    visit.recordings.stop()
    qtbot.waitUntil(lambda: not visit.recordings.is_recording)
    start_walk(qtbot, visit)
    qtbot.wait(300)
    window.close()  # amid the second walk, with the library gone
    window.finish()

    again = open_window()
    assert again.entry is not None
    assert again.entry.first_start.look_again.isVisible()
    assert "2 recordings stay on this computer" in again.entry.first_start.missing_lead.text()
    assert not folder.exists()
    elsewhere.rename(folder)
    log_in(qtbot, again)
    home = present(again.home)
    qtbot.waitUntil(lambda: "while the library was missing" in home.banner.text)
    library = present(again.controller.state).library.library
    (line,) = library.sessions.list()
    recordings = library.sessions.get(line.id).recordings
    assert [(one.details.name, one.state) for one in recordings] == [
        ("walk 1", RecordingState.CLOSED),
        ("walk 2", RecordingState.CLOSED),
    ]
    assert not list((tmp_path / "data").rglob("*.journal"))
    assert "backup" not in home.banner.text
