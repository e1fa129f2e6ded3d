"""Tables that nobody knows, one after the other: each is shown as it would be read, confirmed or changed, and kept."""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, QTimer, Signal

from app.home.importing.table_form import TableForm
from app.home.importing.table_words import stated_of
from app.importing.untrusted_files import nobody_waits, preview_foreign_table
from app.system.known_tables import keep_table, known_tables
from app.theme.icons import Icon
from app.widgets.action_bar import BarAction, BarState
from app.wording.translation import tr
from app.workers.library_controller import LibraryController
from devices.files.refusal import FileRefusedError
from devices.files.table_choices import NO_CHOICES, NONE, TableChoices, TablePreview

if TYPE_CHECKING:
    from app.storage.opened import OpenedLibrary

SETTLES_MS = 150  # after a choice: whoever goes through many by the arrows waits for the last


@dataclass(frozen=True, slots=True)
class OpenTable:
    """A table to be explained; `why`: it was not recognised."""

    path: Path
    why: FileRefusedError | None = None


class Explaining(QObject):
    """`choices`: what was confirmed since `begin`, by path."""

    asked = Signal()  # another table is in the form
    changed = Signal()  # what can be done with it is different
    ended = Signal()  # none is left
    reported = Signal(str, str)

    def __init__(self, controller: LibraryController, form: TableForm, parent: QObject) -> None:
        super().__init__(parent)
        self._controller, self._form = controller, form
        self._waiting: deque[OpenTable] = deque()
        self._table: OpenTable | None = None
        self._accepted: dict[tuple[Path, str], TableChoices] = {}
        self._preview: TablePreview | None = None  # of what is stated now; None: it is being read
        self._number = 0  # of the last preview that was asked for
        self._is_shown = self._is_first = False
        self._count = self._at = 0
        self.choices: dict[str, TableChoices] = {}
        self._settling = QTimer(self)
        self._settling.setSingleShot(True)
        self._settling.setInterval(SETTLES_MS)
        self._settling.timeout.connect(self._read)
        form.changed.connect(self._on_changed)
        form.confirmed.connect(self.accept)

    @property
    def where(self) -> str:
        """The table in the form, and how many there are."""
        which = tr("Table {number} of {count}: ").format(number=self._at, count=self._count) if self._count > 1 else ""
        return f"{which}{self._table.path}" if self._table is not None else ""

    @property
    def is_on(self) -> bool:
        """Whether a table is in the form."""
        return self._table is not None and self._is_shown

    @property
    def bar(self) -> BarState:
        """What can be done with the table in the form."""
        use = BarAction(tr("Use these columns"), self.accept, tr("Enter"), Icon.CHECK, is_enabled=self._may_be_read)
        return BarState(use, quiet=(BarAction(tr("Leave this table out"), self.leave_out),))

    def begin(self, tables: Sequence[OpenTable]) -> None:
        """Show the first of these tables."""
        self.forget()
        self._waiting.extend(tables)
        self._count = len(tables)
        self._next()

    def accept(self) -> None:
        """Read the table, and others of its program, as it is shown."""
        if self._table is None or self._preview is None or not self._may_be_read:
            return
        preview, path = self._preview, self._table.path
        self.choices[str(path)] = preview.choices
        if not _is_half(preview.choices):
            self._accepted[path.parent, preview.fingerprint] = preview.choices
        try:
            keep_table(preview.fingerprint, preview.choices, preview.columns)
        except OSError as problem:
            why = problem.strerror or type(problem).__name__
            self.reported.emit(
                tr("The meaning of the columns could not be stored ({why}).").format(why=why),
                tr("It is used now, and has to be entered again next time."),
            )
        self._next()

    def leave_out(self) -> None:
        """Go on to the next table."""
        self._next()

    def forget(self) -> None:
        """Explain nothing."""
        self._waiting.clear()
        self._accepted.clear()
        self.choices = {}
        self._leave()
        self._count = self._at = 0

    @property
    def _may_be_read(self) -> bool:
        return self._preview is not None and self._form.may_be_read

    def _leave(self) -> None:
        self._settling.stop()
        self._number += 1  # what is still being read is of no use
        self._table = self._preview = None
        self._is_shown = False

    def _next(self) -> None:
        self._leave()
        if not self._waiting:
            self.ended.emit()
            return
        self._table = self._waiting.popleft()
        self._at += 1
        self._is_first = True
        self._form.begin(self._table.why, NO_CHOICES)
        self._read()

    def _on_changed(self) -> None:
        if self._table is not None:
            self._preview = None
            self._number += 1
            self._settling.start()
            self.changed.emit()

    def _read(self) -> None:
        if self._table is None:
            return
        self._number += 1
        number, path, stated = self._number, self._table.path, self._form.stated

        def work(_opened: "OpenedLibrary") -> tuple[int, TablePreview]:
            return number, _previewed(path, stated)

        self._controller.run(work, self._on_read, self._on_refused, self)

    def _on_read(self, read: tuple[int, TablePreview]) -> None:
        number, preview = read
        if number != self._number or self._table is None:
            return
        if self._is_first:
            self._is_first = False
            alike = self._accepted.get((self._table.path.parent, preview.fingerprint))
            if alike is not None:
                self.choices[str(self._table.path)] = alike
                self._next()
                return
            kept = known_tables().get(preview.fingerprint)
            if kept is not None and not (_is_half(kept) and stated_of(preview).may_be_read):
                self._form.begin(self._table.why, kept)
                self._read()
                return
        self._preview = preview
        self._form.show_preview(preview)
        was_shown, self._is_shown = self._is_shown, True
        (self.changed if was_shown else self.asked).emit()

    def _on_refused(self, what: str, remedy: str) -> None:
        self.reported.emit(what, remedy)
        self._next()


def _is_half(choices: TableChoices) -> bool:
    """Whether a second file has the other quantity; its columns may be called alike."""
    return NONE in (*choices.acc, *choices.gyr)


def _previewed(path: Path, stated: TableChoices) -> TablePreview:
    """How a table is read, or that reading it was ended."""
    try:
        return preview_foreign_table(path, stated, nobody_waits)
    except FileRefusedError as refusal:
        return TablePreview("", (), (), (), stated, stated, (), is_by_values=False, is_cut=False, refusal=refusal)
