"""The thread that asks the library: in order, answered on the screen's thread, refused in words."""

import base64
import gc
import shutil
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import suppress
from datetime import UTC, datetime, timedelta
from pathlib import Path
from threading import Event, current_thread, main_thread
from types import CellType
from typing import cast

import pytest
from PySide6.QtCore import QThread
from pytestqt.qtbot import QtBot
from syrupy.assertion import SnapshotAssertion

from app.storage.data_key import LibraryLockedError
from app.storage.journal.disk import Room
from app.storage.journal.header import JournalRefusedError
from app.storage.keys import KeyRefusedError, KeySlots
from app.storage.layout import KEYS
from app.storage.library import Library
from app.storage.opened import OpenedLibrary, held_alone, open_library
from app.storage.stored import LibraryError, Operator, Role, StoredPatient
from app.system.progress import Report
from app.workers.library_controller import LibraryController
from app.workers.library_holder import LibraryHolder
from app.workers.library_state import Joined, LibraryPlace, OpenedState, Reopened, Unlocked
from app.workers.library_watch import LibraryWatch
from app.workers.refusals import refusal_of
from core.session import Patient
from tests.app.library_answers import Asker, asked, not_opened_by, opened, opened_by, opening
from tests.quick_library import CHEAP, PASSPHRASE, quick_library
from tests.waiting import PATIENCE_S


@pytest.fixture(autouse=True)
def quick_keys(monkeypatch: pytest.MonkeyPatch) -> None:
    """Keys that the program derives cost next to nothing, as those of `quick_library`."""
    monkeypatch.setattr(KeySlots.__init__, "__defaults__", (CHEAP,))


@pytest.fixture(scope="session")
def untouched(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A closed library whose operators are `hk` and the viewer `vi`."""
    folder = tmp_path_factory.mktemp("controller")
    with quick_library(folder) as opened:
        assert opened.data_key is not None
        KeySlots(folder / KEYS, CHEAP).add(opened.data_key, "vi", PASSPHRASE)
        opened.library.operators.add(Operator("vi", "V. Iten", Role.VIEWER))
    return folder


@pytest.fixture
def folder(untouched: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(untouched, tmp_path / "library"))


@pytest.fixture
def controller(qtbot: QtBot) -> Iterator[LibraryController]:
    controller = LibraryController()
    yield controller
    controller.finish()


def test_the_passphrase_is_not_held_by_a_library_that_is_open(
    qtbot: QtBot, controller: LibraryController, folder: Path
) -> None:
    slots, own = KeySlots(folder / KEYS), "words that only this test types"
    slots.set_passphrase(slots.open("hk", PASSPHRASE), "hk", own)

    def let_go_of(passphrase: str) -> None:
        # the thread may be about to let go of it
        qtbot.waitUntil(lambda text=passphrase: not is_held(text))  # type: ignore[misc]  # pytest-qt's types

    for passphrase, signal in (("words of somebody else", controller.not_opened), (own, controller.opened)):
        with qtbot.waitSignal(signal):
            controller.open(opening(folder, passphrase, "hk"))
        let_go_of(passphrase)
    asker = Asker()
    controller.lock()
    controller.call(unlocking(own), *asker.ears)
    qtbot.waitUntil(lambda: bool(asker.results))
    let_go_of(own)


def unlocking(passphrase: str) -> Callable[[LibraryHolder], Unlocked]:
    return lambda holder: holder.unlock("hk", passphrase, None)


def is_held(text: str) -> bool:
    """Whether a function that is kept would pass this text on."""
    gc.collect()
    for one in gc.get_objects():
        if type(one) is CellType:
            with suppress(ValueError):  # it is empty
                if type(one.cell_contents) is str and one.cell_contents == text:
                    return True
    return False


def test_calls_are_answered_in_order_on_the_screens_thread(
    qtbot: QtBot, controller: LibraryController, folder: Path
) -> None:
    opened(qtbot, controller, folder, PASSPHRASE, "hk")
    asker = Asker()
    worked_in = []

    def adding(code: str) -> Callable[[OpenedLibrary], str]:
        def add(library: OpenedLibrary) -> str:
            worked_in.append(current_thread())
            return library.library.patients.create(Patient(code=code)).details.code

        return add

    for code in ("P-1", "P-2", "P-3"):
        controller.run(adding(code), *asker.ears)
    qtbot.waitUntil(lambda: len(asker.results) == 3)
    assert asker.results == ["P-1", "P-2", "P-3"]
    assert asker.threads == {main_thread()}
    assert main_thread() not in worked_in
    assert len(set(worked_in)) == 1


def test_a_recording_waits_for_no_call_and_the_library_for_the_recording(
    qtbot: QtBot, controller: LibraryController, folder: Path
) -> None:
    asker, slow = Asker(), Event()
    controller.record(lambda _library, _turn: "too early", *asker.ears)
    assert asker.refusals == [("No library is open.", "Log in, then try again.")]
    opened(qtbot, controller, folder, PASSPHRASE, "hk")
    controller.run(lambda _library: slow.wait(60), None, None, asker)
    turns: list[bool] = []

    def begin(_library: OpenedLibrary, turn: Future[None]) -> str:
        turns.append(turn.done())
        return "begun"

    def end(library: OpenedLibrary, turn: Future[None]) -> int:
        turn.result()
        return len(library.library.patients.search())  # it is still open

    controller.record(begin, *asker.ears)
    qtbot.waitUntil(lambda: asker.results == ["begun"])
    assert turns == [False]
    controller.record(end, *asker.ears)
    with qtbot.waitSignal(controller.closed):
        controller.close()
        slow.set()
    assert asker.results == ["begun", 0]
    assert asker.threads == {main_thread()}


def test_a_refusal_is_reported_in_two_sentences(qtbot: QtBot, controller: LibraryController, folder: Path) -> None:
    opened(qtbot, controller, folder, PASSPHRASE, "hk")
    asker = Asker()
    for _ in range(2):
        controller.run(lambda library: library.library.patients.create(Patient(code="P-1")), *asker.ears)
    qtbot.waitUntil(lambda: bool(asker.refusals))
    assert asker.refusals == [
        ("Another patient has this code.", "Open the other patient, or choose another code."),
    ]
    assert len(asker.results) == 1


def test_a_refusal_begins_with_what_happened_and_ends_with_where(tmp_path: Path) -> None:
    with pytest.raises(JournalRefusedError) as caught:
        Room(start_bytes=10**18).check(tmp_path, 0.0)
    what, remedy = refusal_of(caught.value)
    assert what.startswith("Not enough disk space to record: 1000000000000 MB needed, ")
    assert remedy == f"Delete or move files you do not need. Where: {tmp_path}."


@pytest.mark.usefixtures("pseudo_language")
def test_what_the_library_refuses_is_reported_in_the_users_language(tmp_path: Path) -> None:
    with pytest.raises(JournalRefusedError) as caught:
        Room(start_bytes=10**18).check(tmp_path, 0.0)
    for error in (caught.value, LibraryError("Another patient has this code", "Open that patient")):
        assert all(sentence.startswith("[") for sentence in refusal_of(error))


def test_what_nobody_foresaw_is_logged_and_reported_plainly(
    qtbot: QtBot, controller: LibraryController, folder: Path, caplog: pytest.LogCaptureFixture
) -> None:
    opened(qtbot, controller, folder, PASSPHRASE, "hk")

    def call(_library: OpenedLibrary) -> None:
        raise ZeroDivisionError("P-0147")

    with qtbot.waitSignal(controller.refused) as reported:
        controller.run(call, None, None, controller)
    assert reported.args is not None
    assert "P-0147" not in " ".join(reported.args)
    assert "ZeroDivisionError" in caplog.text


def test_nothing_arrives_for_an_owner_that_is_gone(qtbot: QtBot, controller: LibraryController, folder: Path) -> None:
    opened(qtbot, controller, folder, PASSPHRASE, "hk")
    go_on, asker = Event(), Asker()
    received = asker.results
    controller.run(lambda _library: go_on.wait(5), *asker.ears)
    del asker
    go_on.set()
    last = Asker()
    controller.run(lambda _library: "after it", *last.ears)
    qtbot.waitUntil(lambda: bool(last.results))
    assert received == []


def test_calls_before_opening_and_after_closing_are_refused(
    qtbot: QtBot, controller: LibraryController, folder: Path
) -> None:
    asker = Asker()
    controller.run(lambda library: library.library.patients.search(), *asker.ears)
    qtbot.waitUntil(lambda: len(asker.refusals) == 1)
    opened(qtbot, controller, folder, PASSPHRASE, "hk")
    with qtbot.waitSignal(controller.closed):
        controller.close()
    controller.run(lambda library: library.library.patients.search(), *asker.ears)
    qtbot.waitUntil(lambda: len(asker.refusals) == 2)
    assert asker.results == []
    assert controller.state is None


@pytest.mark.parametrize("passphrase", [PASSPHRASE, "no words of theirs"])
def test_of_an_opening_that_another_or_a_closing_followed_nothing_is_reported(
    qtbot: QtBot, controller: LibraryController, folder: Path, passphrase: str
) -> None:
    reported: list[object] = []
    controller.opened.connect(reported.append)
    controller.not_opened.connect(lambda *words: reported.append(words))
    with qtbot.waitSignal(controller.closed):
        controller.open(opening(folder, passphrase, "hk"))
        controller.close()
    assert reported == []
    state = controller.state
    assert state is None
    with qtbot.waitSignal(controller.opened):
        controller.open(opening(folder, passphrase, "hk"))
        controller.open_demonstration()
    assert [type(one) for one in reported] == [OpenedState]
    state = controller.state
    assert state is not None
    assert state.is_demonstration


def test_a_wrong_passphrase_is_reported_apart_from_other_trouble(
    qtbot: QtBot, controller: LibraryController, folder: Path, tmp_path: Path
) -> None:
    for place, is_key in ((folder, True), (tmp_path / "nothing", False)):
        what, remedy, is_of_key = not_opened_by(qtbot, controller, opening(place, "not this one", "hk"))
        assert is_of_key is is_key
        assert what.endswith(".")
        assert remedy.endswith(".")


@pytest.mark.endurance
def test_a_new_library_comes_with_its_recovery_key_which_lets_in_again(
    qtbot: QtBot, controller: LibraryController, tmp_path: Path
) -> None:
    state = opened_by(qtbot, controller, lambda holder: holder.create(tmp_path / "new", "hk", "H. Keller", PASSPHRASE))
    assert state.operator.role is Role.ADMINISTRATOR
    key = state.recovery_key
    assert key
    assert key not in repr(state)
    controller.close()
    state = opened_by(
        qtbot, controller, lambda holder: holder.open_recovered(tmp_path / "new", key, "hk", "another four words")
    )
    assert state.recovery_key == ""
    controller.close()
    opened_by(qtbot, controller, lambda holder: holder.open(tmp_path / "new", "another four words"))


def test_the_folder_states_who_may_open_it(
    qtbot: QtBot, controller: LibraryController, folder: Path, tmp_path: Path
) -> None:
    asker = Asker()
    controller.call(lambda holder: holder.look(folder), *asker.ears)
    controller.call(lambda holder: holder.look(tmp_path / "nothing"), *asker.ears)
    qtbot.waitUntil(lambda: len(asker.results) == 2)
    there, nothing = asker.results
    assert isinstance(there, LibraryPlace)
    assert (there.exists, there.codes, there.remembered) == (True, ("hk", "vi"), ())
    assert isinstance(nothing, LibraryPlace)
    assert not nothing.exists


def test_a_keyring_without_the_key_sends_back_to_the_passphrase(
    qtbot: QtBot, controller: LibraryController, folder: Path
) -> None:
    _, remedy, _ = not_opened_by(qtbot, controller, lambda holder: holder.open_remembered(folder, "hk"))
    assert remedy == "Enter the passphrase."


def test_a_library_that_another_program_holds_is_not_opened(
    qtbot: QtBot, controller: LibraryController, folder: Path
) -> None:
    with held_alone(folder):
        what, _, _ = not_opened_by(qtbot, controller, opening(folder, PASSPHRASE, "hk"))
    assert "This library is already open in Gaitwright" in what
    opened(qtbot, controller, folder, PASSPHRASE, "hk")


def test_what_is_overdue_is_destroyed_after_opening_but_not_for_a_viewer(
    qtbot: QtBot, controller: LibraryController, folder: Path
) -> None:
    data_key = KeySlots(folder / KEYS).open("hk", PASSPHRASE)
    for days in range(40, 0, -6):  # in use since, so that no clock is in doubt
        then = datetime.now(UTC) - timedelta(days=days)
        with Library.open(folder, data_key, lambda then=then: then) as library:  # type: ignore[misc]  # of this turn
            library.log_in("hk")
            if days == 40:
                library.patients.delete(library.patients.create(Patient(code="P-9")))
    asker = Asker()
    for code, left in (("vi", 1), ("hk", 0)):
        opened(qtbot, controller, folder, PASSPHRASE, code)
        asker.results.clear()
        controller.run(deleted, *asker.ears)
        qtbot.waitUntil(lambda: bool(asker.results))
        assert asker.results == [left]


def deleted(library: OpenedLibrary) -> int:
    return len(library.library.patients.search(is_deleted=True))


def test_the_demonstration_holds_patients_who_have_no_visit_yet_and_leaves_nothing(
    qtbot: QtBot, controller: LibraryController
) -> None:
    with qtbot.waitSignal(controller.opened) as reported:
        controller.open_demonstration()
    (state,) = reported.args or []
    assert state.is_demonstration
    folder = state.library.folder
    asker = Asker()
    controller.run(lambda library: library.library.patients.search(), *asker.ears)
    qtbot.waitUntil(lambda: bool(asker.results))
    (patients,) = asker.results
    assert isinstance(patients, tuple)
    assert all(isinstance(one, StoredPatient) for one in patients)
    assert [(one.details.code, one.sessions) for one in patients] == [
        ("DEMO-KNEE", 0),
        ("DEMO-STROKE", 0),
        ("DEMO-AK", 0),
        ("DEMO-BK", 0),
    ]
    with qtbot.waitSignal(controller.closed):
        controller.close()
    assert not folder.exists()


def stored(library: OpenedLibrary) -> list[str]:
    return [one.details.code for one in library.library.patients.search()]


def begun_demonstration(qtbot: QtBot, controller: LibraryController, monkeypatch: pytest.MonkeyPatch) -> OpenedState:
    monkeypatch.setattr("app.demonstration.patients.simulated_patients", lambda _now: ())  # nobody waits for visits
    with qtbot.waitSignal(controller.opened) as reported:
        controller.open_demonstration()
    (state,) = reported.args or []
    assert state.is_demonstration
    return cast(OpenedState, state)


def test_after_the_demonstration_the_library_opens_without_its_passphrase_for_the_same_user(
    qtbot: QtBot, controller: LibraryController, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened(qtbot, controller, folder, PASSPHRASE, "vi")
    begun_demonstration(qtbot, controller, monkeypatch)
    kept = controller.kept
    assert kept is not None
    state = opened_by(qtbot, controller, lambda holder: holder.open_kept())
    assert (state.operator.code, state.library.folder, state.is_continued) == ("vi", folder, True)
    assert controller.kept is None
    asker = Asker()
    controller.run(stored, *asker.ears)
    qtbot.waitUntil(lambda: bool(asker.results))


def test_the_key_that_is_kept_meanwhile_is_one_and_in_no_file(
    qtbot: QtBot, controller: LibraryController, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    state = opened(qtbot, controller, folder, PASSPHRASE, "hk")
    data_key = state.library.data_key
    assert data_key is not None
    key = bytes(data_key)
    shown = begun_demonstration(qtbot, controller, monkeypatch)
    assert bytes(data_key) == b""  # moved, not copied
    kept = controller.kept
    assert kept is not None
    assert bytes(kept.data_key) == key
    assert key.hex() not in repr(kept)
    files = [one for place in (tmp_path, shown.library.folder) for one in place.rglob("*") if one.is_file()]
    assert files
    written = (key, key.hex().encode(), base64.b64encode(key))
    assert [one for one in files if any(form in one.read_bytes() for form in written)] == []


def test_who_logs_out_or_left_the_desk_is_not_kept_behind_the_demonstration(
    qtbot: QtBot, controller: LibraryController, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for is_closed in (False, True):
        opened(qtbot, controller, folder, PASSPHRASE, "hk")
        begun_demonstration(qtbot, controller, monkeypatch)
        kept = controller.kept
        assert kept is not None
        if is_closed:
            controller.close()
        else:
            controller.call(lambda holder: holder.forget(), None, None, controller)
        assert not_opened_by(qtbot, controller, lambda holder: holder.open_kept())[0] == "The library is locked."
        assert not kept.data_key  # wiped
    opened(qtbot, controller, folder, PASSPHRASE, "hk")
    controller.lock()
    begun_demonstration(qtbot, controller, monkeypatch)
    assert controller.kept is None


def test_the_next_window_opens_the_library_of_whoever_is_logged_in_and_no_locked_one(
    qtbot: QtBot, controller: LibraryController, folder: Path
) -> None:
    opened(qtbot, controller, folder, PASSPHRASE, "vi")
    kept = controller.finish(must_keep=True)
    assert kept is not None
    following = LibraryController()
    try:
        state = opened_by(qtbot, following, lambda holder: holder.open_kept(kept))
        assert (state.operator.code, state.is_continued) == ("vi", True)
        following.lock()
        assert following.finish(must_keep=True) is None
    finally:
        following.finish()


def test_at_the_programs_end_nobody_is_kept(qtbot: QtBot, controller: LibraryController, folder: Path) -> None:
    opened(qtbot, controller, folder, PASSPHRASE, "hk")
    assert controller.finish() is None
    assert controller.kept is None


def test_long_work_shows_progress_and_is_stopped(qtbot: QtBot, controller: LibraryController, folder: Path) -> None:
    opened(qtbot, controller, folder, PASSPHRASE, "hk")
    asker, ended = Asker(), Event()

    def work(_library: OpenedLibrary, report: Report) -> None:
        try:
            while True:
                report(0.5, "walk 1")
        finally:
            ended.set()

    controller.run_long(work, *asker.all_ears)
    qtbot.waitUntil(lambda: asker.shares[:1] == [0.5])
    controller.run_long(work, *asker.all_ears)
    assert asker.refusals == [("Another task is still running.", "Wait until it has finished, or stop it.")]
    with qtbot.waitSignal(controller.closed):
        controller.close()  # stops it first
    assert ended.is_set()
    assert asker.results == []


def test_quiet_work_gives_way_to_what_is_asked_and_begins_again_afterwards(
    qtbot: QtBot, controller: LibraryController, folder: Path
) -> None:
    opened(qtbot, controller, folder, PASSPHRASE, "hk")
    asker, began, may_end = Asker(), [], Event()

    def quiet(_library: OpenedLibrary, report: Report) -> str:
        began.append("quiet")
        while not may_end.is_set():
            report(0.5, "an earlier visit")
        return "quiet"

    def asked_for(_library: OpenedLibrary, _report: Report) -> str:
        may_end.set()
        return "asked for"

    controller.run_long(quiet, asker.on_done, asker.on_failed, None, asker, is_quiet=True)
    qtbot.waitUntil(lambda: began == ["quiet"])
    controller.run_long(asked_for, asker.on_done, asker.on_failed, None, asker)
    qtbot.waitUntil(lambda: len(asker.results) == 2)
    assert asker.results == ["asked for", "quiet"]
    assert began == ["quiet", "quiet"]
    assert asker.refusals == []


def test_quiet_work_waits_for_what_was_asked_before(qtbot: QtBot, controller: LibraryController, folder: Path) -> None:
    opened(qtbot, controller, folder, PASSPHRASE, "hk")
    asker, may_end = Asker(), Event()

    def asked_for(_library: OpenedLibrary, _report: Report) -> str:
        may_end.wait(PATIENCE_S)
        return "asked for"

    controller.run_long(asked_for, asker.on_done, asker.on_failed, None, asker)
    controller.run_long(lambda *_: "quiet", asker.on_done, asker.on_failed, None, asker, is_quiet=True)
    may_end.set()
    qtbot.waitUntil(lambda: asker.results == ["asked for", "quiet"])
    assert asker.refusals == []


def test_long_work_gives_its_result_or_its_refusal(qtbot: QtBot, controller: LibraryController, folder: Path) -> None:
    opened(qtbot, controller, folder, PASSPHRASE, "hk")
    asker = Asker()
    controller.run_long(lambda library, _report: library.folder, asker.on_done, asker.on_failed, None, asker)
    qtbot.waitUntil(lambda: bool(asker.results))
    assert asker.results == [folder]

    def refused(_library: OpenedLibrary, _report: Report) -> None:
        raise LibraryError("There is no room", "Make some")

    qtbot.waitUntil(lambda: controller._long.is_idle)
    controller.run_long(refused, asker.on_done, asker.on_failed, None, asker)
    qtbot.waitUntil(lambda: bool(asker.refusals))
    assert asker.refusals == [("There is no room.", "Make some.")]


def test_a_passphrase_that_is_remembered_opens_next_time(
    qtbot: QtBot, controller: LibraryController, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    kept: dict[str, str] = {}

    class Keyring:
        priority = 5

        def set_password(self, _service: str, name: str, secret: str) -> None:
            kept[name] = secret

        def get_password(self, _service: str, name: str) -> str | None:
            return kept.get(name)

    monkeypatch.setattr("app.storage.keyring_slot._keyring", Keyring)
    opened_by(qtbot, controller, lambda holder: holder.open(folder, PASSPHRASE, "hk", must_remember=True))
    assert len(kept) == 1
    controller.close()
    state = opened_by(qtbot, controller, lambda holder: holder.open_remembered(folder, "hk"))
    assert state.operator.code == "hk"


def test_a_refusing_keyring_is_no_reason_not_to_open(
    qtbot: QtBot, controller: LibraryController, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = []

    def refuse(_slots: object, _key: object, code: str) -> None:
        asked.append(code)
        raise KeyRefusedError("The keyring does not accept the key", "Unlock it")

    monkeypatch.setattr("app.workers.library_opening.remember", refuse)
    state = opened_by(qtbot, controller, lambda holder: holder.open(folder, PASSPHRASE, "hk", must_remember=True))
    assert asked == ["hk"]
    assert state.operator.code == "hk"


def test_under_the_lock_there_is_no_key_and_what_is_asked_comes_after_it(
    qtbot: QtBot, controller: LibraryController, folder: Path
) -> None:
    asker = Asker()
    state = opened(qtbot, controller, folder, PASSPHRASE, "hk")
    key = state.library.data_key
    assert key is not None
    before = bytes(key)
    controller.lock()
    qtbot.waitUntil(lambda: not key)
    with pytest.raises(LibraryLockedError):
        state.library.library.patients.search()
    controller.run(lambda library: len(library.library.patients.search()), *asker.ears)
    controller.call(unlocking("not this passphrase"), *asker.ears)
    qtbot.waitUntil(lambda: bool(asker.refusals))
    assert not asker.results
    assert not key
    controller.call(unlocking(PASSPHRASE), *asker.ears)
    qtbot.waitUntil(lambda: len(asker.results) == 2)
    assert asker.results == [Unlocked(), len(state.library.library.patients.search())]
    assert bytes(key) == before


def test_a_lock_waits_for_long_work(qtbot: QtBot, controller: LibraryController, folder: Path) -> None:
    asker, slow = Asker(), Event()
    state = opened(qtbot, controller, folder, PASSPHRASE, "hk")
    key = state.library.data_key
    assert key is not None

    def work(library: OpenedLibrary, _report: Report) -> int:
        slow.wait(60)
        return len(library.library.patients.search())

    controller.run_long(work, asker.on_done, asker.on_failed, None, asker)
    controller.lock()
    assert key
    slow.set()
    qtbot.waitUntil(lambda: bool(asker.results) and not key)


def test_a_lock_waits_for_long_work_that_was_stopped_and_has_not_ended(
    qtbot: QtBot, controller: LibraryController, folder: Path
) -> None:
    asker, begun, slow = Asker(), Event(), Event()
    state = opened(qtbot, controller, folder, PASSPHRASE, "hk")
    key = state.library.data_key
    assert key is not None

    def work(library: OpenedLibrary, _report: Report) -> int:
        begun.set()
        slow.wait(60)
        return len(library.library.patients.search())

    controller.run_long(work, asker.on_done, asker.on_failed, None, asker)
    assert begun.wait(60)
    controller.stop_long()
    controller.lock()
    controller.call(lambda holder: holder.look(folder), *asker.ears)  # is asked after what locks
    qtbot.waitUntil(lambda: bool(asker.results))
    assert key
    slow.set()
    qtbot.waitUntil(lambda: not key)


def test_an_unlock_that_comes_before_a_waiting_lock_leaves_the_library_open(
    qtbot: QtBot, controller: LibraryController, folder: Path
) -> None:
    asker, slow, unlocked, answers = Asker(), Event(), Event(), Event()
    state = opened(qtbot, controller, folder, PASSPHRASE, "hk")
    others = set(controller.findChildren(QThread))

    def unlock(holder: LibraryHolder) -> Unlocked:
        found = unlocking(PASSPHRASE)(holder)
        unlocked.set()
        answers.wait(60)
        return found

    controller.run_long(lambda _library, _report: slow.wait(60), None, None, None, asker)
    (working,) = set(controller.findChildren(QThread)) - others
    controller.lock()
    controller.call(unlock, *asker.ears)
    assert unlocked.wait(60)
    with qtbot.waitSignal(working.destroyed):  # now nothing keeps the lock from coming
        slow.set()
    answers.set()
    controller.run(lambda library: len(library.library.patients.search()), *asker.ears)
    qtbot.waitUntil(lambda: len(asker.results) == 2)
    assert asker.refusals == []
    assert state.library.data_key


def test_the_key_is_changed_and_who_left_opens_nothing(
    qtbot: QtBot, controller: LibraryController, folder: Path
) -> None:
    asker = Asker()
    state = opened(qtbot, controller, folder, PASSPHRASE, "hk")
    before = state.library.data_key
    assert before is not None
    slots = KeySlots(folder / KEYS)
    slots.add(before, "ab", "another four short words")
    controller.run(
        lambda library: library.library.operators.add(Operator("ab", "A. Bauer", Role.CLINICIAN)), None, None, asker
    )
    controller.reopen(
        lambda holder, report: holder.change_key("ab", report),
        *asker.all_ears,
    )
    assert not controller.state  # nothing is begun meanwhile
    qtbot.waitUntil(lambda: bool(asker.results or asker.refusals))
    assert asker.refusals == []
    assert not before
    now = controller.state
    assert now is not None
    assert now.library.data_key == slots.open("hk", PASSPHRASE)
    assert slots.codes == ("hk", "vi")
    controller.run(lambda library: library.library.operators.list(), *asker.ears)
    qtbot.waitUntil(lambda: len(asker.results) == 2)
    operators = asker.results[1]
    assert isinstance(operators, tuple)
    assert [one.is_active for one in operators if one.code == "ab"] == [False]


def test_what_is_no_address_is_refused_and_leaves_nothing(
    qtbot: QtBot, controller: LibraryController, tmp_path: Path
) -> None:
    asker = Asker()
    controller.call(lambda holder: holder.join(tmp_path / "station", "nowhere", "", ""), *asker.ears)
    qtbot.waitUntil(lambda: bool(asker.results))
    (joined,) = asker.results
    assert isinstance(joined, Joined)
    assert joined.refusal is not None
    assert "This is not the address of a PostgreSQL server" in joined.refusal.what
    assert not (tmp_path / "station").exists()


def test_a_change_of_the_key_or_a_move_that_is_refused_leaves_the_library_open(
    qtbot: QtBot, controller: LibraryController, folder: Path, snapshot: SnapshotAssertion
) -> None:
    state = opened(qtbot, controller, folder, PASSPHRASE, "hk")

    def refused(ask: Callable[[LibraryHolder, Report], Reopened]) -> list[tuple[str, str]]:
        asker = Asker()
        controller.reopen(ask, *asker.all_ears)
        qtbot.waitUntil(lambda: bool(asker.results or asker.refusals))
        assert controller.state is not None
        return asker.refusals

    found = {
        "moved to what is no server": refused(
            lambda holder, report: holder.move_to_server("nowhere", "", str(folder), report)
        )
    }
    assert controller.state is not None
    assert controller.state.library is state.library
    found["brought back from a folder"] = refused(lambda holder, report: holder.bring_back(report))
    with open_library(folder, PASSPHRASE, "hk"):
        found["a new key where another program has it open"] = refused(
            lambda holder, report: holder.change_key("", report)
        )
    assert found == snapshot
    assert asked(qtbot, controller, lambda library: library.library.patients.search()) == ()


def test_a_watch_that_waits_for_a_server_holds_nobody_up(
    qtbot: QtBot, controller: LibraryController, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    answers, asked, answered = Event(), Event(), Event()

    def listen(_watch: LibraryWatch) -> bool:
        asked.set()
        has_answer = answers.wait(PATIENCE_S)
        answered.set()
        return has_answer

    monkeypatch.setattr(LibraryWatch, "_listen", listen)
    opened(qtbot, controller, folder, PASSPHRASE, "hk")
    qtbot.waitUntil(asked.is_set)
    controller.close()
    assert not answered.is_set()
    answers.set()
    with qtbot.waitSignal(controller.closed):
        pass
