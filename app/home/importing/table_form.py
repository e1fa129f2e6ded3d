"""A table that nobody knows: how it is laid out and what its columns are, beside what it looks like when read so.

Whatever is not stated is found. A choice that somebody makes is stated; all others follow it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QBoxLayout, QGridLayout, QHBoxLayout, QSizePolicy, QVBoxLayout, QWidget

from app.home.importing.axes_curves import AXES, AxesCurves
from app.home.importing.table_words import (
    ACC_UNIT_WORDS,
    DECIMAL_WORDS,
    ENCODING_WORDS,
    GYR_UNIT_WORDS,
    SEPARATOR_WORDS,
    TIME_UNIT_WORDS,
    column_words,
    findings_of,
    refused_line,
    stated_of,
    why_shown,
)
from app.theme.current import on_theme, scaled
from app.theme.icons import Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.card import Card
from app.widgets.choice import Choice
from app.widgets.field import NumberField
from app.widgets.lay_out import lay_out
from app.widgets.notice import Notice
from app.widgets.reading_area import scrolled
from app.widgets.table import CellTable, TableColumn, TableRow
from app.widgets.table_cells import TextCell
from app.widgets.text import SEMIBOLD, Text
from app.wording.findings import sentence
from app.wording.translation import tr
from devices.files.refusal import FileRefusedError
from devices.files.table_choices import COUNT, NO_CHOICES, NONE, TableChoices, TablePreview

MOST_SHOWN_LINES = 20  # of the beginning, to choose the header from
MOST_SHOWN_COLUMNS = 60
LONGEST_CELL = 24
NARROWEST, WIDEST, CHOICE = 120, 260, 40  # px of a choice, and its height


class TableForm(QWidget):
    """`stated` is what somebody chose; whoever reads the table shows what comes of it by `show_preview`."""

    changed = Signal()  # something else is stated
    confirmed = Signal()  # by Enter

    def __init__(self) -> None:
        super().__init__()
        self.stated = NO_CHOICES
        self._preview: TablePreview | None = None
        self._refusal: FileRefusedError | None = None  # why it was not recognised
        self.encoding = self._choice(tr("Encoding"), "encoding")
        self.header_line = self._choice(tr("Line with the names"), "header_line")
        self.separator = self._choice(tr("Separator"), "separator")
        self.decimal = self._choice(tr("Decimal sign"), "decimal")
        self.time = self._choice(tr("Time"), "time")
        self.time_unit = self._choice(tr("Unit of time"), "time_unit")
        self.sensor = self._choice(tr("Sensor's name"), "sensor")
        self.acc = [self._choice(tr("Acceleration {axis}").format(axis=axis), "acc", axis) for axis in AXES]
        self.acc_unit = self._choice(tr("Unit of acceleration"), "acc_unit")
        self.gyr = [self._choice(tr("Angular rate {axis}").format(axis=axis), "gyr", axis) for axis in AXES]
        self.gyr_unit = self._choice(tr("Unit of angular rate"), "gyr_unit")
        self.rate = NumberField(tr("Sampling rate"), low=1.0, high=2000.0, decimals=1, unit=tr("Hz"))
        self.detect = Button(tr("Detect again"), ButtonKind.SECONDARY, Icon.REPEAT, height=40)
        self.notice = Notice(size=16)
        self._why = Text(tone="ink2", wraps=True)
        self.shown = Choice(tr("Sensor shown"))
        self.shown.set_height(CHOICE)
        self.acc_curves = AxesCurves(tr("Acceleration, m/s²"))
        self.gyr_curves = AxesCurves(tr("Angular rate, rad/s"))
        self._noticed = Text(size=12, tone="ink2", wraps=True)
        self.rows = CellTable(tr("First rows"))
        self._build()

    @property
    def may_be_read(self) -> bool:
        """Whether what is shown can be read, and is what is stated."""
        return self._preview is not None and stated_of(self._preview).may_be_read

    @property
    def tab_order(self) -> list[QWidget]:
        layout = [self.encoding, self.header_line, self.separator, self.decimal]
        columns = [self.time, self.time_unit, self.rate.line_edit, self.sensor]
        axes = [*self.acc, self.acc_unit, *self.gyr, self.gyr_unit]
        return [*layout, *columns, *axes, self.detect, self.shown, self.rows]

    def focus(self) -> None:
        """Give the focus to the first choice that is open, else to the first of all, below what is stated of them."""
        choices = [*self.acc, self.acc_unit, *self.gyr, self.gyr_unit, self.time, self.time_unit]
        open_ones = (one for one in choices if one.isEnabled() and one.currentData() == "")
        next(open_ones, self.encoding).setFocus()

    def begin(self, why: FileRefusedError | None, stated: TableChoices) -> None:
        """Begin with another table, of which this is known; `why`: it was not recognised."""
        self.stated, self._preview, self._refusal = stated, None, why
        self._why.hide()
        self.notice.show_message(None, "")

    def show_preview(self, preview: TablePreview) -> None:
        """Show how the table is read with what is stated."""
        self._preview = preview
        self._show_choices(preview)
        self._why.setText(column_words(why_shown(self._refusal, preview)))
        self._why.setVisible(bool(self._why.text()))
        stated = stated_of(preview)
        icon = Icon.WARNING if stated.is_caution else Icon.CHECK
        what, then = column_words(stated.what), column_words(stated.then)
        self.notice.show_message(icon, what, then, is_caution=stated.is_caution)
        names = [(one.name, number) for number, one in enumerate(preview.sensors)]
        self.shown.offer(names, self.shown.currentData())
        for part in (self._shown_label, self.shown):
            part.setVisible(len(names) > 1)
        self._show_curves()
        self._noticed.setText(
            column_words("\n".join([*map(refused_line, preview.unread), *map(sentence, findings_of(preview))]))
        )
        self._noticed.setVisible(bool(self._noticed.text()))
        self._show_rows(preview)

    def set_narrow(self, is_narrow: bool) -> None:
        """Put the curves under the choices."""
        scaled(self._row.setSpacing, 16)
        way = QBoxLayout.Direction.TopToBottom if is_narrow else QBoxLayout.Direction.LeftToRight
        self._row.setDirection(way)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self.confirmed.emit()
        else:
            super().keyPressEvent(event)

    def _choice(self, name: str, field: str, axis: str = "") -> Choice:
        choice = Choice(name)
        choice.let_shrink(NARROWEST, WIDEST)
        choice.set_height(CHOICE)
        choice.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        choice.currentIndexChanged.connect(lambda _index: self._on_chosen(choice, field, axis))
        return choice

    def _on_chosen(self, choice: Choice, field: str, axis: str) -> None:
        chosen = choice.currentData()
        if field in ("acc", "gyr"):
            axes: dict[str, Any] = {field: self._axes(field, axis, str(chosen))}
            known = self._preview.choices if self._preview is not None else self.stated  # what was guessed stays
            stated = replace(known, **axes)
        elif field in ("encoding", "header_line", "separator"):  # other columns, which have other names
            columns: dict[str, Any] = {"acc": (), "gyr": (), "time": "", "sensor": ""}
            stated = replace(self.stated, **{**columns, field: chosen})
        elif field == "time":
            stated = replace(self.stated, time=chosen, time_unit="")
        else:
            stated = replace(self.stated, **{field: chosen})
        self._state(stated)

    def _axes(self, field: str, axis: str, chosen: str) -> tuple[str, ...]:
        """The columns of a quantity: those after x follow it."""
        names = self._preview.columns if self._preview is not None else ()
        if chosen in ("", NONE):
            return (chosen,) if chosen else ()
        number = AXES.index(axis)
        before = [str(one.currentData()) for one in (self.acc if field == "acc" else self.gyr)]
        before = [name if name in names else "" for name in before]
        place = names.index(chosen)
        if number == 0 and place + 2 < len(names):
            return names[place : place + 3]
        before[number] = chosen
        return tuple(name or chosen for name in before)

    def _state(self, stated: TableChoices) -> None:
        self.stated = stated
        self.changed.emit()

    def _on_rate_edited(self, _text: str) -> None:
        self._state(replace(self.stated, rate_hz=self.rate.value))

    def _on_detect(self) -> None:
        self._state(NO_CHOICES)

    def _show_choices(self, preview: TablePreview) -> None:
        found = preview.found
        lines = [(f"{number}: {line}", number) for number, line in enumerate(preview.lines[:MOST_SHOWN_LINES], 1)]
        _offer(self.header_line, [(tr("none"), 0), *lines], found.header_line)
        for choice, words, value in (
            (self.encoding, ENCODING_WORDS, found.encoding),
            (self.separator, SEPARATOR_WORDS, found.separator),
            (self.decimal, DECIMAL_WORDS, found.decimal),
            (self.time_unit, TIME_UNIT_WORDS, found.time_unit),
            (self.acc_unit, ACC_UNIT_WORDS, found.acc_unit),
            (self.gyr_unit, GYR_UNIT_WORDS, found.gyr_unit),
        ):
            _offer(choice, [(tr(word), key) for key, word in words.items()], value)
        columns = [(column_words(name), name) for name in preview.columns]
        none = (tr("not in this file"), NONE)
        _offer(self.time, [none, *columns], found.time)
        _offer(self.sensor, [(tr("one sensor"), NONE), *columns], found.sensor)
        by_name = tr("by their names") if preview.sensors else tr("Choose")
        for choices, unit, chosen in ((self.acc, self.acc_unit, found.acc), (self.gyr, self.gyr_unit, found.gyr)):
            three = chosen if len(chosen) == len(AXES) else (chosen or ("",))[:1] * len(AXES)
            for choice, name in zip(choices, three, strict=True):
                _offer(choice, [none, *columns], name, by_name)
                choice.setEnabled(choice is choices[0] or len(chosen) == len(AXES))
            unit.setEnabled(chosen != (NONE,))
        self.time_unit.setEnabled(found.time != NONE)
        self.rate.setVisible(found.time == NONE or found.time_unit == COUNT)
        if not self.rate.line_edit.hasFocus():
            self.rate.set_value(found.rate_hz)

    def _show_curves(self) -> None:
        sensors = self._preview.sensors if self._preview is not None else ()
        number = int(self.shown.currentData() or 0)
        one = sensors[number] if number < len(sensors) else None
        self._curves.setVisible(one is not None)
        if one is not None:
            self.acc_curves.show_curves(one.time_s, one.acc_m_s2)
            self.gyr_curves.show_curves(one.time_s, one.gyr_rad_s)

    def _show_rows(self, preview: TablePreview) -> None:
        roles = _roles(preview.found)
        names = preview.columns[:MOST_SHOWN_COLUMNS]
        heads = [TextCell(_short(column_words(name)), roles.get(name, ""), weight=SEMIBOLD) for name in names]
        rows = [
            TableRow(tuple(TextCell(_short(row[k]) if k < len(row) else "") for k in range(len(names))))
            for row in preview.rows
        ]
        self.rows.show_rows([TableColumn(head) for head in heads], rows)
        self._rows_part.setVisible(bool(names))
        self._fit_rows()

    def _fit_rows(self) -> None:
        """Be as high as the rows, which are scrolled sideways alone."""
        bar = self._sideways.horizontalScrollBar().sizeHint().height()
        self._sideways.setFixedHeight(self.rows.minimumSizeHint().height() + bar)

    def _build(self) -> None:
        of_table, of_columns = Card(padding=20, spacing=12), Card(padding=20, spacing=12)
        lay_out(of_table.column, Text(tr("Table"), size=16, weight=SEMIBOLD))
        of_table.column.addLayout(_grid((self.encoding, self.header_line, self.separator, self.decimal)))
        columns = _grid((self.time, self.time_unit, self.sensor, *self.acc, self.acc_unit, *self.gyr, self.gyr_unit))
        lay_out(of_columns.column, Text(tr("Columns"), size=16, weight=SEMIBOLD), columns, self.rate)
        again = lay_out(QHBoxLayout(), self.detect, 1)
        lay_out(of_columns.column, again)
        left = lay_out(QVBoxLayout(), of_table, of_columns, 1)
        scaled(left.setSpacing, 16)
        preview = Card(padding=20, spacing=12)
        self._shown_label = Text(tr("Sensor shown"))
        which = lay_out(QHBoxLayout(), self._shown_label, self.shown, 1, spacing=12)
        self._curves = QWidget()
        lay_out(QVBoxLayout(self._curves), self.acc_curves, self.gyr_curves, margins=0, spacing=12)
        self._rows_part = QWidget()
        title = Text(tr("First rows"), size=14, weight=SEMIBOLD)
        self._sideways = scrolled(self.rows, is_upright=False)
        self._sideways.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        lay_out(QVBoxLayout(self._rows_part), title, self._sideways, margins=0, spacing=8)
        heading = Text(tr("As it is read"), size=16, weight=SEMIBOLD)
        lay_out(preview.column, heading, which, self._curves, self._noticed, self._rows_part, 1)
        self._row = lay_out(QBoxLayout(QBoxLayout.Direction.LeftToRight), (left, 2), (preview, 3), margins=0)
        lay_out(QVBoxLayout(self), self._why, self.notice, self._row, 1, margins=0, spacing=16)
        self.rate.edited.connect(self._on_rate_edited)
        self.detect.clicked.connect(self._on_detect)
        self.shown.currentIndexChanged.connect(self._show_curves)
        on_theme(self._fit_rows)


def _offer(choice: Choice, lines: Sequence[tuple[str, object]], chosen: object, open_words: str = "") -> None:
    """Offer lines; what is in force and none of them has a line of its own before all others."""
    offered = [*lines]
    if not any(data == chosen for _, data in lines):
        words = str(chosen) if chosen not in ("", None) else open_words or tr("Choose")
        offered.insert(0, (words, chosen))
    if offered != [(choice.itemText(row), choice.itemData(row)) for row in range(choice.count())]:
        choice.offer(offered, chosen)
        return
    with QSignalBlocker(choice):
        choice.setCurrentIndex([data for _, data in offered].index(chosen))
    choice.update()


def _grid(choices: Sequence[Choice]) -> QGridLayout:
    """Each choice behind its name."""
    grid = QGridLayout()
    grid.setColumnStretch(0, 2)
    grid.setColumnStretch(1, 3)
    scaled(grid.setHorizontalSpacing, 12)
    scaled(grid.setVerticalSpacing, 8)
    for row, choice in enumerate(choices):
        grid.addWidget(Text(choice.accessibleName(), wraps=True), row, 0)
        grid.addWidget(choice, row, 1)
    return grid


def _roles(found: TableChoices) -> Mapping[str, str]:
    """What columns are read as."""
    acc = {name: tr("acceleration {axis}").format(axis=axis) for name, axis in zip(found.acc, AXES, strict=False)}
    gyr = {name: tr("angular rate {axis}").format(axis=axis) for name, axis in zip(found.gyr, AXES, strict=False)}
    return {found.sensor: tr("sensor"), **acc, **gyr, found.time: tr("time")}


def _short(cell: str) -> str:
    return cell if len(cell) <= LONGEST_CELL else f"{cell[:LONGEST_CELL]}…"
