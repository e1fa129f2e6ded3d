"""The session's clinical comment on the report's page: drafted, typed, confirmed, and kept with the session."""

from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

from app.wizard.report.comment_editor import CommentEditor, CommentState

if TYPE_CHECKING:
    from app.wizard.visit import Visit


class CommentControl(QObject):
    """Shows the words of another station too, unless somebody types."""

    changed = Signal()  # what is printed may be another comment

    def __init__(self, visit: "Visit", parent: QObject) -> None:
        super().__init__(parent)
        self._visit = visit
        self._editor: CommentEditor | None = None
        self._shown = ("", "", False)  # as the page has it: words, who confirmed them, whether they are
        self._draft = ""  # from the findings
        self._has_cleared = False  # somebody wants no draft
        visit.changed.connect(self._on_visit_changed)

    @property
    def words(self) -> str:
        """As they are kept with the session, confirmed or not."""
        return self._visit.record.comment

    @property
    def printed(self) -> tuple[str, str]:
        """The words that are printed, and who confirmed them; empty where nobody has."""
        words, by, is_confirmed = self._held
        return (words, by) if is_confirmed else ("", "")

    @property
    def is_unconfirmed(self) -> bool:
        """Whether words were typed that will not be printed."""
        return self._editor is not None and self._editor.state is CommentState.TYPED

    def show_on(self, editor: CommentEditor) -> None:
        self._editor = editor
        editor.edited.connect(self._on_edited)
        editor.confirmed.connect(self._on_confirmed)

    def begin(self) -> None:
        """Show the session's words as the page is entered."""
        self._has_cleared = False
        self._show()

    def flush(self) -> None:
        if self._editor is not None:
            self._editor.flush()

    def take_draft(self, draft: str) -> None:
        """Offer a draft where nobody has typed or cleared anything."""
        self._draft = draft
        if draft and not self.words and self._editor is not None and not self._editor.is_typing:
            self._show()

    @property
    def _held(self) -> tuple[str, str, bool]:
        record = self._visit.record
        return record.comment, record.comment_by, record.is_comment_confirmed

    def _show(self) -> None:
        """Show the session's words, else the draft unless somebody has cleared it."""
        self._shown = words, by, is_confirmed = self._held
        state = CommentState.CONFIRMED if is_confirmed else CommentState.TYPED
        if not words:
            words = "" if self._has_cleared else self._draft
            state = CommentState.DRAFT if words else CommentState.EMPTY
        if self._editor is not None:
            self._editor.show_comment(words, state, by)

    def _on_edited(self, words: str) -> None:
        self._has_cleared = not words
        self._visit.record.set_comment(words, self._shown[0])
        self._show()
        self.changed.emit()

    def _on_confirmed(self, words: str) -> None:
        self._visit.record.confirm_comment(words, self._shown[0])
        self._show()
        self.changed.emit()

    def _on_visit_changed(self) -> None:
        if self._editor is not None and self._held != self._shown and not self._editor.is_typing:
            self._show()
            self.changed.emit()
