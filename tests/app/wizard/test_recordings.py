"""A recording begins and ends at once, whatever the library is doing meanwhile; what it holds comes when it can."""

import time
from collections.abc import Callable
from dataclasses import replace
from threading import Event

import pytest
from pytestqt.qtbot import QtBot

from app.acquisition.recorder import ROW_WAIT_S, Recorder
from app.editing.session_recording import SessionRecording
from app.storage.library import Library
from app.storage.opened import OpenedLibrary
from app.storage.recordings import Recordings
from app.storage.stored import LibraryFaultError, RecordingState
from app.wizard.visit import Visit
from app.workers.library_controller import LibraryController
from core.body import LEG_SITES, Side, Site
from core.session import RecordingKind
from tests.app.wizard.begun_visit import begin, record, start
from tests.app.wizard.present import present

FAULT = LibraryFaultError("The library file cannot be read or written", "Check the disk")


def hanging(until: Event) -> Callable[[OpenedLibrary], None]:
    """A call of the library that takes as long as it is let: a folder on the net, many samples."""

    def call(_opened: OpenedLibrary) -> None:
        until.wait(60)

    return call


@pytest.mark.endurance
def test_no_call_of_the_library_holds_up_a_recording(
    qtbot: QtBot, controller: LibraryController, begun: Visit, monkeypatch: pytest.MonkeyPatch
) -> None:
    """While a call hangs a walk begins and ends, then another; both come when it is over, worn as was stated before."""
    recordings, over = begun.recordings, Event()
    monkeypatch.setattr("app.wizard.recordings.WAITED_MS", 200)
    controller.run(hanging(over), None, None, controller)
    begun.place_sensors()  # behind it, and before the walk
    reported: list[tuple[str, str]] = []
    recordings.troubled.connect(lambda *words: reported.append(words))
    recordings.refused.connect(lambda *words: reported.append(words))
    ended: list[SessionRecording] = []
    recordings.ended.connect(ended.append)
    try:
        for _ in range(2):
            asked_s = time.monotonic()
            acquisition = start(qtbot, begun)
            assert time.monotonic() - asked_s < ROW_WAIT_S + 3.0  # on a busy machine; alone it is a second
            recordings.stop()
            qtbot.waitUntil(lambda: not recordings.is_recording)
            assert acquisition._writer is None
        assert ended == []
        assert [what for what, _ in reported] == [
            "The library does not respond.",
            "The recording is not loaded yet.",
        ] * 2
        assert ["The recording is still written to the disk" in then for _, then in reported] == [True, False] * 2
        assert ["safe on the disk" in then for _, then in reported] == [False, True] * 2
    finally:
        over.set()
    qtbot.waitUntil(lambda: recordings.is_idle)
    assert [recording.details.name for recording in ended] == ["walk 1", "walk 2"]
    assert [recording.stored.state for recording in ended] == [RecordingState.CLOSED] * 2
    for recording in ended:
        assert set(present(recording.read_back).imu) == set(LEG_SITES)
    assert [recording.stored.placement for recording in ended] == [present(begun.session).placements[-1]] * 2


def test_a_database_that_fails_in_whatever_way_costs_no_recording(
    qtbot: QtBot, begun: Visit, monkeypatch: pytest.MonkeyPatch
) -> None:
    is_broken = [True]
    for name in ("start", "add_journal", "close"):
        whole = getattr(Recordings, name)

        def call(*arguments: object, whole: Callable[..., object] = whole, **named: object) -> object:
            if is_broken[0]:
                raise FAULT
            return whole(*arguments, **named)

        monkeypatch.setattr(Recordings, name, call)
    recordings, acquisition = begun.recordings, present(begun.sensors.acquisition)
    monkeypatch.setattr("app.wizard.reading_back.READ_AGAIN_MS", 50)
    with qtbot.waitSignals([recordings.begun, recordings.troubled]):
        recordings.begin(acquisition, RecordingKind.WALKING)
    with qtbot.waitSignal(recordings.refused) as reported:
        recordings.stop()
    assert reported.args == [f"{FAULT.what}.", "The recording is safe on the disk. It is loaded as soon as possible."]
    assert not recordings.is_recording
    is_broken[0] = False
    with qtbot.waitSignal(recordings.ended) as ended:
        pass
    assert ended.args[0].details.name == "walk 1"


def test_the_name_of_one_that_could_not_be_read_back_is_not_given_again(
    qtbot: QtBot, visit: Visit, worn: dict[str, Site], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The library has it still, and would refuse another of this name at every start of a walk."""

    def unreadable(*_arguments: object) -> None:
        raise FAULT

    begin(qtbot, visit, worn)
    recordings = visit.recordings
    monkeypatch.setattr("app.wizard.reading_back.MOST_READINGS", 1)
    with monkeypatch.context() as broken:
        broken.setattr(Recorder, "stop", unreadable)
        start(qtbot, visit)
        with qtbot.waitSignal(recordings.refused):
            recordings.stop()
    assert recordings.is_idle
    assert record(qtbot, visit, RecordingKind.WALKING, 0.5).details.name == "walk 2"


def test_corrections_that_follow_each_other_quickly_all_hold(qtbot: QtBot, library: Library, begun: Visit) -> None:
    """The second is made before the library has answered the first."""
    walk = record(qtbot, begun, RecordingKind.WALKING, 0.5)
    recordings = begun.recordings
    recordings.keep(walk, is_kept=True)
    recordings.change(walk, lambda reported: replace(reported, condition="barefoot"))
    recordings.change(walk, lambda reported: replace(reported, left_out_s={Side.LEFT: (4.0,)}))
    recordings.keep(walk, is_kept=False)
    qtbot.waitUntil(lambda: not recordings.walks[0].details.is_kept)
    reported = recordings.walks[0].details
    assert (reported.condition, dict(reported.left_out_s)) == ("barefoot", {Side.LEFT: (4.0,)})
    for is_kept in (True, False):
        recordings.keep(recordings.walks[0], is_kept)
    passed = Event()
    begun.controller.run(lambda _opened: passed.set(), None, None, begun)
    assert passed.wait(20)
    stored = present(library.recordings.find(walk.id))
    assert not stored.details.is_kept


def test_what_was_broken_off_does_not_count(qtbot: QtBot, begun: Visit) -> None:
    recordings, acquisition = begun.recordings, present(begun.sensors.acquisition)
    recordings.begin(acquisition, RecordingKind.STANDING)
    recordings.stop(is_kept=False)  # before it has begun
    assert recordings.is_stopping
    recordings.stop()  # who reports it once more does not say that it counts
    qtbot.waitUntil(lambda: bool(recordings.every) and not recordings.every[0].details.is_kept)
    assert recordings.standing is None
    record(qtbot, begun, RecordingKind.STANDING, 2.0)
    assert recordings.standing is not None


def test_a_walk_that_ends_with_the_window_waits_to_be_kept_or_discarded(
    qtbot: QtBot, library: Library, begun: Visit
) -> None:
    start(qtbot, begun)
    with qtbot.waitSignal(begun.recordings.ended):
        begun.close()
    (walk,) = library.recordings.undecided()
    assert walk.recording.details.name == "walk 1"
    library.recordings.decide(walk.recording, is_kept=False)
    assert library.recordings.undecided() == ()
