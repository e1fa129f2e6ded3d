"""A recovery key stands in even columns, whatever its letters are, and leaves nothing behind."""

from pytestqt.qtbot import QtBot

from app.theme import ThemeNotifier
from app.widgets.key_groups import COLUMNS, KeyGroups
from app.widgets.text import Text
from tests.app.room import words_cut

GROUPS = ["7ATX", "CTM1", "NEMQ", "0PG8", "MMPN", "YTHB", "DZ7F", "Z1CR", "X"]


def test_groups_stand_in_even_columns(qtbot: QtBot) -> None:
    key = KeyGroups(ThemeNotifier())
    qtbot.addWidget(key)
    key.show_groups(GROUPS)
    key.resize(key.sizeHint())
    key.show()
    texts = key.findChildren(Text)
    assert [one.text() for one in texts] == GROUPS
    for column in range(COLUMNS):
        assert len({one.x() for one in texts[column::COLUMNS]}) == 1
    assert words_cut(key) == []
    assert key.accessibleName() == " ".join(GROUPS)
    assert key.text.split("\n")[1] == "0PG8 MMPN YTHB"


def test_nothing_of_a_key_stays(qtbot: QtBot) -> None:
    key = KeyGroups(ThemeNotifier())
    qtbot.addWidget(key)
    key.show_groups(GROUPS)
    before = key.findChildren(Text)
    key.show_groups([])
    assert (key.text, key.accessibleName()) == ("", "")
    assert {one.text() for one in before} == {""}
