"""What every edited record does with what two stations changed: it reports, asks, and settles as was chosen."""

import datetime
from collections.abc import Iterator

import pytest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from app.editing.edited_record import EditedRecord
from app.editing.question import EditQuestion
from app.storage.three_way import Edited, MergeConflict, OtherChange, Values
from app.workers.library_controller import LibraryController

AT = datetime.datetime(2026, 1, 5, 10, 32, tzinfo=datetime.UTC)
MASS = MergeConflict("mass_kg", 80.0, 82.0, "B. Berger", AT)
HEIGHT = MergeConflict("height_m", 1.8, 1.81, "B. Berger", AT)


class Record(EditedRecord[str]):
    """The least that an edited record is."""

    chosen: tuple[str, Values, Values] | None = None

    def answer(self, edited: Edited[str]) -> None:
        self._show_message(edited)
        self._ask(edited)

    def _called(self, stored: str) -> str:
        return stored

    def _choose(self, stored: str, base: Values, stated: Values) -> None:
        self.chosen = stored, base, stated


@pytest.fixture
def record(qapp: QApplication) -> Iterator[Record]:
    controller = LibraryController()
    yield Record(controller, controller)
    controller.finish()


def question(qtbot: QtBot, record: Record, *contests: MergeConflict) -> EditQuestion:
    with qtbot.waitSignal(record.asked) as asked, qtbot.assertNotEmitted(record.merged):
        record.answer(Edited("P-001", contests))
    (found,) = asked.args or (None,)
    assert isinstance(found, EditQuestion)
    assert (found.subject, found.contests) == ("P-001", contests)
    return found


def test_what_only_another_station_changed_is_reported_and_not_asked_about(qtbot: QtBot, record: Record) -> None:
    with qtbot.waitSignal(record.merged) as merged, qtbot.assertNotEmitted(record.asked):
        record.answer(Edited("P-001", others=(OtherChange("aids", "stick", "B. Berger", AT),)))
    what, values = merged.args or ("", "")
    assert "P-001" in what
    assert "stick" in values


def test_of_two_fields_the_one_that_was_chosen_is_saved_base_what_the_question_showed(
    qtbot: QtBot, record: Record
) -> None:
    question(qtbot, record, MASS, HEIGHT).settle(frozenset({"mass_kg"}))
    assert record.chosen == ("P-001", {"mass_kg": 82.0}, {"mass_kg": 80.0})


def test_where_theirs_stays_nothing_is_saved_and_the_screen_goes_on(qtbot: QtBot, record: Record) -> None:
    asked = question(qtbot, record, MASS)
    with qtbot.waitSignal(record.changed):
        asked.settle(frozenset())
    assert record.chosen is None


def test_an_edit_that_nobody_else_touched_is_neither_reported_nor_asked_about(qtbot: QtBot, record: Record) -> None:
    with qtbot.assertNotEmitted(record.merged), qtbot.assertNotEmitted(record.asked):
        record.answer(Edited("P-001"))
