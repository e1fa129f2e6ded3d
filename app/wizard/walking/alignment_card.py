"""The alignments walked so far, each with what was changed, and the next change as it is entered before its walk."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from PySide6.QtCore import QRectF, Qt, Signal
from PySide6.QtGui import QAccessible, QColor, QFontMetrics, QMouseEvent, QPainter, QResizeEvent
from PySide6.QtWidgets import QHBoxLayout, QSizePolicy, QVBoxLayout, QWidget

from app.theme.current import current_theme, on_theme, px, scaled
from app.theme.ground import Ground, set_ground
from app.theme.theme import CHIP_RADIUS
from app.widgets.card import Card
from app.widgets.chip import Chip
from app.widgets.key_cap import KeyCap
from app.widgets.lay_out import lay_out
from app.widgets.painted import Painted
from app.widgets.painted_text import LEFT, PaintedText, height_for
from app.widgets.reading_area import scrolled
from app.widgets.text import MEDIUM, SEMIBOLD, Text
from app.wizard.walking.badge import BADGE, Badge
from app.wizard.walking.bench import ChangeEntry
from app.wizard.walking.entry_fields import EntryFields
from app.wording.translation import tr
from core.body import Side

PADDING, LINE, GAP = 8, 18, 12
CAP = 20  # of a digit, beside its alignment
ENTRY_KEY = "C"
MOST_KEYS = 9  # as many as there are digits
LEAST_LIST, LEAST_LIST_COMPACT = 88, 56


class RowRole(StrEnum):
    """Which place an alignment has on the bench now."""

    SHOWN = "shown"
    BESIDE = "beside"
    NONE = ""


@dataclass(frozen=True, slots=True)
class AlignmentRow:
    """One alignment: its letter, what it is, strides and speed, and what was changed, part by part."""

    letter: str
    title: str
    note: str
    lines: tuple[tuple[str, str], ...]
    role: RowRole


class AlignmentCard(Card):
    """The alignments walked so far, and the entry for the next change."""

    chosen = Signal(int, bool)  # the number of an alignment from 0, and whether it is to stand beside the one shown

    def __init__(self, entry: ChangeEntry) -> None:
        super().__init__()
        self._rows: list[_AlignmentRow] = []
        self._list = QWidget()
        self._rows_column = QVBoxLayout(self._list)
        self._scroll = scrolled(self._list)
        self.next_title = Text(size=14, weight=SEMIBOLD, wraps=True)
        self._next_cap = KeyCap(ENTRY_KEY, tr("Key {key} enters the next change.").format(key=ENTRY_KEY))
        self.fields = EntryFields(entry)
        self.chip = Chip(Side.LEFT)  # until rows are shown
        self._head_row = QWidget()
        self._build()
        self._scroll.verticalScrollBar().rangeChanged.connect(self._show_the_shown)
        self.show_entry("")

    @property
    def rows(self) -> tuple[AlignmentRow, ...]:
        return tuple(row.reported for row in self._rows)

    def show_rows(self, rows: Sequence[AlignmentRow], side: Side) -> None:
        self.chip.set_side(side)
        while len(self._rows) > len(rows):
            self._rows.pop().deleteLater()
        while len(self._rows) < len(rows):
            row = _AlignmentRow(len(self._rows))
            row.pressed.connect(self.chosen)
            self._rows_column.insertWidget(len(self._rows), row)
            self._rows.append(row)
        for widget, reported in zip(self._rows, rows, strict=True):
            widget.show_row(reported)
        self._show_the_shown()

    def _show_the_shown(self) -> None:
        """Scroll the list to the alignment that is shown."""
        shown = [row for row in self._rows if row.reported.role is RowRole.SHOWN]
        if shown:
            top = sum(row.height() + self._rows_column.spacing() for row in self._rows[: self._rows.index(shown[0])])
            self._scroll.verticalScrollBar().setValue(top)

    def set_compact(self, is_compact: bool) -> None:
        """Show the entry of the change low where the card has the width of the window, and little height."""
        self._head_row.setVisible(not is_compact)  # the tab shows it, and the sentence above names whose it is
        scaled(self._scroll.setMinimumHeight, LEAST_LIST_COMPACT if is_compact else LEAST_LIST)
        self.fields.set_compact(is_compact)

    def show_entry(self, title: str) -> None:
        """Show the next change as it is entered; `title` names the alignment it starts from."""
        self.next_title.setText(title)
        self.fields.show_entry()

    def _build(self) -> None:
        title, word = Text(tr("Alignments"), size=16, weight=SEMIBOLD), Text(tr("prosthetic"), size=12, tone="ink2")
        lay_out(QHBoxLayout(self._head_row), title, 1, self.chip, word, margins=0)
        lay_out(self._rows_column, 1, margins=0, spacing=4)
        cap = self._next_cap, 0, Qt.AlignmentFlag.AlignTop
        following = lay_out(QHBoxLayout(), (self.next_title, 1), cap, margins=0, spacing=8)
        lay_out(self.column, self._head_row, (self._scroll, 1), following, self.fields)
        self.set_compact(False)  # with a parent: what is shown without one is a window, and takes the keys


class _AlignmentRow(Painted):
    """One alignment; a press shows it, with Shift beside the one shown."""

    accessible_role = QAccessible.Role.ListItem

    pressed = Signal(int, bool)

    def __init__(self, number: int) -> None:
        super().__init__()
        self._number = number
        self.reported = AlignmentRow("", "", "", (), RowRole.NONE)
        self._badge = Badge()
        self._badge.setParent(self)
        scaled(self._badge.move, PADDING, PADDING + 4)
        on_theme(self._apply_theme)
        scaled(self.setMinimumWidth, 200)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setCursor(Qt.CursorShape.PointingHandCursor)

    def show_row(self, reported: AlignmentRow) -> None:
        self.reported = reported
        lines = "; ".join(f"{name}: {words}" for name, words in reported.lines)
        role = {RowRole.SHOWN: tr("shown"), RowRole.BESIDE: tr("compared"), RowRole.NONE: ""}[reported.role]
        stated = [f"{reported.letter} {reported.title}", reported.note, lines, role]
        self.setAccessibleName(", ".join(filter(None, stated)))
        keys = tr("Key {key} shows it. Shift and {key} compare it with the one shown.").format(key=self._key)
        self.setAccessibleDescription(tr("Key {key}").format(key=self._key) if self._key else "")
        self.setToolTip(" ".join(filter(None, [f"{', '.join(filter(None, stated))}.", keys if self._key else ""])))
        is_shown = reported.role is RowRole.SHOWN
        set_ground(self, Ground("sunken", inset=0) if is_shown else None)
        fill, line, tone = ("inv", "", "inv_ink") if is_shown else ("surface", "ink", "ink")
        self._badge.show_letter(reported.letter, tone, Ground(fill, line, 1.75, CHIP_RADIUS, inset=1))
        self._apply_theme()

    def painted_texts(self) -> list[PaintedText]:
        theme = current_theme()
        left, width = px(PADDING + BADGE + GAP), self.width()
        role = {RowRole.SHOWN: tr("shown"), RowRole.BESIDE: tr("compared"), RowRole.NONE: ""}[self.reported.role]
        aside = QFontMetrics(theme.font(12, MEDIUM)).horizontalAdvance(role) + px(PADDING) + 2
        before_cap = width - px(PADDING + CAP + 4)
        right = QRectF(before_cap - aside, px(PADDING), aside - px(PADDING), px(LINE))
        texts = [
            PaintedText(
                self.reported.title,
                QRectF(left, px(PADDING), before_cap - aside - left, px(LINE)),
                theme.font(14, SEMIBOLD),
            ),
            PaintedText(
                self.reported.note,
                QRectF(left, px(PADDING + LINE), width - left - px(PADDING), px(LINE)),
                theme.font(12),
                "ink2",
            ),
            PaintedText(role, right, theme.font(12, MEDIUM), "ink2", Qt.AlignmentFlag.AlignRight),
        ]
        top = px(PADDING + 2 * LINE)
        for words, height in zip(self._line_words(), self._line_heights(), strict=True):
            box = QRectF(left, top, width - left - px(PADDING), height)
            texts.append(PaintedText(words, box, theme.font(12), align=LEFT, wraps=True))
            top += height
        return texts

    def draw(self, painter: QPainter) -> None:
        if self._key:
            theme, px = current_theme(), current_theme().px
            cap = QRectF(self.width() - px(PADDING + CAP), px(PADDING - 1), px(CAP), px(CAP))
            theme.paint_cap(painter, cap, self._key, QColor(theme.colours.ink2), QColor(theme.colours.control))

    @property
    def _key(self) -> str:
        return str(self._number + 1) if self._number < MOST_KEYS else ""

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._apply_theme()  # its lines may wrap otherwise

    def mousePressEvent(self, event: QMouseEvent) -> None:
        self.pressed.emit(self._number, bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier))

    def _line_words(self) -> list[str]:
        return [f"{name}: {words}" for name, words in self.reported.lines]

    def _line_heights(self) -> list[int]:
        px, font = current_theme().px, current_theme().font(12)
        width = max(self.width() - px(2 * PADDING + BADGE + GAP), px(140))
        return [max(px(LINE), height_for(words, font, width)) for words in self._line_words()]

    def _apply_theme(self) -> None:
        self.setFixedHeight(px(2 * PADDING + 2 * LINE) + sum(self._line_heights()))
        self.update()
