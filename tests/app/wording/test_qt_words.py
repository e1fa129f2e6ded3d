"""Qt's own dialogs speak the application's language, and another one once that is chosen."""

import pytest
from PySide6.QtWidgets import QApplication, QFileDialog
from pytestqt.qtbot import QtBot

from app.wording.qt import qt_speaks
from app.wording.translation import languages


def cancel_of() -> str:
    return QApplication.translate("QPlatformTheme", "Cancel")


@pytest.mark.parametrize("language", languages())
def test_every_language_of_ours_is_one_of_qt(qapp: QApplication, language: str) -> None:
    with qt_speaks(language):
        assert (cancel_of() == "Cancel") == (language == "en")


def test_german_ends_with_it(qapp: QApplication, qtbot: QtBot) -> None:
    with qt_speaks("de"):
        assert cancel_of() == "Abbrechen"
        dialog = QFileDialog()
        qtbot.addWidget(dialog)
        dialog.setOption(QFileDialog.Option.DontUseNativeDialog)
        assert dialog.labelText(QFileDialog.DialogLabel.Reject) == "Abbrechen"
    assert cancel_of() == "Cancel"


def test_a_language_that_qt_has_not_is_english(qapp: QApplication) -> None:
    with qt_speaks("xx"):
        assert cancel_of() == "Cancel"
