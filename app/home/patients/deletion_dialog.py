"""What goes with a patient, until when it can be restored and who works with it, before the patient is deleted."""

import datetime

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QDialog, QHBoxLayout, QVBoxLayout, QWidget

from app.editing.words import by_words
from app.storage.stored import KEPT_DELETED, WhatGoes
from app.theme.current import px
from app.theme.ground import Ground, set_ground
from app.theme.icons import Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.lay_out import lay_out
from app.widgets.notice import Notice
from app.widgets.text import SEMIBOLD, Text
from app.wording.dates import date
from app.wording.translation import tr, tr_n

WIDTH, EDGE = 520, 24


class DeletionDialog(QDialog):
    """Enter and Escape both leave the patient where it is: deleting is pressed, or reached by Tab."""

    confirmed = Signal()

    def __init__(self, goes: WhatGoes, now: datetime.datetime, parent: QWidget) -> None:
        super().__init__(parent)
        title = tr("Delete patient {code}?").format(code=goes.code)
        self.setWindowTitle(title)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self._title = Text(title, size=20, weight=SEMIBOLD, wraps=True)
        self.goes = Text(_what_goes(goes), wraps=True)
        until = tr(
            "You can undo the deletion right afterwards, or restore the data in Settings until {day}. "
            "After that, the data are destroyed."
        ).format(day=date((now + KEPT_DELETED).date()))
        self.until = Text(f"{until} {tr('Earlier backups keep the data longer.')}", wraps=True)
        self.others = Notice(16)
        self.others.setVisible(bool(words := _others(goes, now)))
        if words:
            self.others.show_message(Icon.WARNING, words, tr("Ask the other users before you delete."), is_caution=True)
        self.delete = Button(tr("Delete patient"), ButtonKind.SECONDARY, Icon.DELETE)
        self.cancel = Button(tr("Cancel"), ButtonKind.PRIMARY, key=tr("Esc"))
        self._build(parent)
        self.delete.clicked.connect(self._on_delete)
        self.cancel.clicked.connect(self.reject)
        self.cancel.setFocus()

    def _build(self, parent: QWidget) -> None:
        buttons = lay_out(QHBoxLayout(), self.delete, 1, self.cancel)
        column = lay_out(QVBoxLayout(self), self._title, self.goes, self.others, self.until, buttons)
        lay_out(column, margins=(EDGE, 20, EDGE, 20), spacing=12)
        set_ground(self, Ground("surface", radius=0, inset=0))
        width = min(px(WIDTH), parent.window().width() - px(EDGE))
        self.resize(width, column.totalHeightForWidth(width))

    def _on_delete(self) -> None:
        self.accept()
        self.confirmed.emit()


def _what_goes(goes: WhatGoes) -> str:
    sessions = tr_n("{count} session", "{count} sessions", goes.sessions).format(count=goes.sessions)
    recordings = tr_n("{count} recording", "{count} recordings", goes.recordings).format(count=goes.recordings)
    return tr("This also deletes {sessions} and {recordings}.").format(sessions=sessions, recordings=recordings)


def _others(goes: WhatGoes, now: datetime.datetime) -> str:
    """Say what speaks for somebody who works with the patient now."""
    if goes.is_being_recorded:
        return tr("A recording of this patient is running or was not stopped.")
    if goes.seen_by:
        return tr("Opened by another user: {who}.").format(who=by_words(goes.seen_by, goes.seen_at, now))
    return ""
