"""The alignments walked so far, each with what was changed, and the next change as it is entered before its walk."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from PySide6.QtCore import QRectF, Qt, Signal
from PySide6.QtGui import QAccessible, QFontMetrics, QMouseEvent, QResizeEvent
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QSizePolicy, QVBoxLayout, QWidget

from app.theme.current import current_theme, on_theme, px, scaled
from app.theme.ground import Ground, set_ground
from app.theme.theme import CHIP_RADIUS
from app.widgets.card import Card
from app.widgets.chip import Chip
from app.widgets.choice import Choice
from app.widgets.field import Field
from app.widgets.lay_out import lay_out
from app.widgets.painted import Painted
from app.widgets.painted_text import LEFT, PaintedText, height_for
from app.widgets.reading_area import scrolled
from app.widgets.text import MEDIUM, SEMIBOLD, Text
from app.wizard.walking.badge import BADGE, Badge
from app.wizard.walking.bench import ChangeEntry
from app.wizard.walking.stepper import Stepper
from app.wording.alignment import change_in_words, direction_words, part_name, turns_words
from app.wording.numbers import MINUS
from app.wording.translation import figure_text, tr
from core.alignment import FIGURES, MOST_TEXT, ProsthesisPart
from core.body import Side

PADDING, LINE, GAP = 8, 18, 12
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
    reported = Signal()  # something of the next change was entered: `entry` holds it

    def __init__(self, entry: ChangeEntry) -> None:
        super().__init__()
        self._entry = entry
        self._rows: list[_AlignmentRow] = []
        self._list = QWidget()
        self._rows_column = QVBoxLayout(self._list)
        self._scroll = scrolled(self._list)
        self.next_title = Text(size=14, weight=SEMIBOLD, wraps=True)
        self.parts = Choice(tr("Part"))
        self.steppers = {name: Stepper() for name in FIGURES}
        self.words = Field(tr("In words"), has_label=False, placeholder=tr("Free text, optional"), most=MOST_TEXT)
        self.written = Text(size=12, tone="ink2", wraps=True)
        self._grid = QGridLayout()
        self.chip = Chip(Side.LEFT)  # until rows are shown
        self._head_row = QWidget()
        for part in ProsthesisPart:
            self.parts.addItem(part_name(part), part)
        self._build()
        self._connect()
        self.show_entry("")

    @property
    def rows(self) -> tuple[AlignmentRow, ...]:
        return tuple(row.reported for row in self._rows)

    @property
    def tab_order(self) -> list[QWidget]:
        return [self.parts, *self.steppers.values(), self.words.line_edit]

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
        """Show the entry of the change in two rows where the card has the width of the window, and little height."""
        self._head_row.setVisible(not is_compact)  # the tab shows it, and the sentence above names whose it is
        scaled(self._scroll.setMinimumHeight, LEAST_LIST_COMPACT if is_compact else LEAST_LIST)
        steppers = [*self.steppers.values()]
        bottom = Qt.AlignmentFlag.AlignBottom
        for widget in (self.parts, *steppers, self.words, self.written):
            self._grid.removeWidget(widget)
        if is_compact:
            self._grid.addWidget(self.parts, 0, 0, bottom)
            for k, stepper in enumerate(steppers):
                self._grid.addWidget(stepper, 0, k + 1)
            self._grid.addWidget(self.words, 1, 0, 1, 2)
            self._grid.addWidget(self.written, 1, 2, 1, 3)
        else:
            self._grid.addWidget(self.parts, 0, 0, 1, 2)
            for k, stepper in enumerate(steppers):
                self._grid.addWidget(stepper, 1 + k // 2, k % 2)
            self._grid.addWidget(self.words, 3, 0, 1, 2)
            self._grid.addWidget(self.written, 4, 0, 1, 2)

    def show_entry(self, title: str) -> None:
        """Show the next change as `entry` holds it; `title` names the alignment it starts from."""
        entry = self._entry
        self.next_title.setText(title)
        if self.parts.currentData() != entry.part:
            self.parts.setCurrentIndex(list(ProsthesisPart).index(entry.part))
        angle_words, shift_words = direction_words(entry.part)
        shown = {
            "angle_deg": (angle_words, "°"),
            "turns": (tr("Screw turns"), ""),
            "shift_mm": (shift_words, tr(" mm")),
            "height_mm": (tr("Height, longer +"), tr(" mm")),
        }
        for name, stepper in self.steppers.items():
            caption, unit = shown[name]
            value = entry.figure(name)
            sign = "+" if value > 0 else MINUS if value < 0 else ""
            stated = turns_words(value) if name == "turns" and value else sign + figure_text(abs(value), "g") + unit
            stepper.show_value(caption, stated)
        self.words.set_text(entry.text)
        line = change_in_words(entry.parts)
        self.written.setText(tr("Recorded as: {change}").format(change=line) if line else tr("Nothing changed yet."))

    def _build(self) -> None:
        title, word = Text(tr("Alignments"), size=16, weight=SEMIBOLD), Text(tr("prosthetic"), size=12, tone="ink2")
        lay_out(QHBoxLayout(self._head_row), title, 1, self.chip, word, margins=0)
        lay_out(self._rows_column, 1, margins=0, spacing=4)
        scaled(self._grid.setSpacing, 8)
        lay_out(self.column, self._head_row, (self._scroll, 1), self.next_title, self._grid)
        self.set_compact(False)  # with a parent: what is shown without one is a window, and takes the keys

    def _connect(self) -> None:
        self.parts.activated.connect(self._on_part_chosen)
        self.parts.currentIndexChanged.connect(self._on_part_chosen)
        for stepper in self.steppers.values():
            stepper.stepped.connect(self._on_stepped)
        self.words.edited.connect(self._on_words_edited)
        self._scroll.verticalScrollBar().rangeChanged.connect(self._show_the_shown)

    def _on_part_chosen(self, index: int) -> None:
        self._entry.part = list(ProsthesisPart)[index]
        self.reported.emit()

    def _on_stepped(self, by: int) -> None:
        name = next(name for name, stepper in self.steppers.items() if stepper is self.sender())
        self._entry.step(name, by)
        self.reported.emit()

    def _on_words_edited(self, text: str) -> None:
        self._entry.say(text)
        self.reported.emit()


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
        self.setAccessibleDescription(tr("Key {key}").format(key=str(self._number + 1)))
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
        right = QRectF(width - aside, px(PADDING), aside - px(PADDING), px(LINE))
        texts = [
            PaintedText(
                self.reported.title, QRectF(left, px(PADDING), width - left - aside, px(LINE)), theme.font(14, SEMIBOLD)
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
