"""Questions over many sessions: a measure by groups, as a chart and as a table, from the table of a batch."""

from collections.abc import Sequence

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import QBoxLayout, QHBoxLayout, QVBoxLayout, QWidget

from app.cohort.study.groups import GroupAnswer, Grouping, GroupQuestion, GroupRow
from app.cohort.study.measures import in_order, measure_words
from app.home.cohort.cohort_table import MOST_ROWS, groups_table
from app.home.cohort.cohort_text import group_name, grouping_word, notes, sentence
from app.plots.group_plot import GroupLine, GroupPlot
from app.theme.current import px
from app.theme.icons import Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.card import Card
from app.widgets.choice import Choice
from app.widgets.lay_out import lay_out
from app.widgets.notice import Notice
from app.widgets.segmented import Segmented
from app.widgets.table import CellTable
from app.widgets.text import MEDIUM, SEMIBOLD, Text
from app.widgets.toggle import Toggle
from app.wording.translation import figure_text, tr, tr_n

READ, WITH_CARE = "read", "care"
LEAST_CHOICE, MOST_CHOICE = 150, 320  # px; a parameter that nobody named may be long
MARGIN, GAP = 24, 16
NARROW_BELOW = 860  # px of the design: the table leaves columns out
MOST_DRAWN = 16  # groups; those with most sessions


class QuestionsPage(QWidget):
    """Questions to a table of many sessions, and their answers as tables and plots."""

    table_requested = Signal()  # another table is to be chosen
    making_requested = Signal()  # a table is to be made from the library
    question_changed = Signal(object)  # what is asked now, a `GroupQuestion`

    def __init__(self) -> None:
        super().__init__()
        self._width = 1000.0
        self.found: GroupAnswer | None = None
        self._title = Text(tr("Cohort"), size=26, weight=SEMIBOLD)
        self._name = Text(tone="ink2", wraps=True)
        self.choose_table = Button(tr("Choose a table"), ButtonKind.SECONDARY, Icon.FOLDER)
        self.refusal = Notice(size=16)
        self._empty = Card(padding=20, spacing=16)
        self.make_table = Button(tr("Create a table from this library"), ButtonKind.PRIMARY, Icon.PLAY, height=56)
        self.first_table = Button(tr("Choose a table"), ButtonKind.SECONDARY, Icon.FOLDER, height=56)
        self._controls = QWidget()
        self.measure = Choice(tr("Measure"))
        self.grouping = Choice(tr("Group by"))
        for choice in (self.measure, self.grouping):
            choice.let_shrink(LEAST_CHOICE, MOST_CHOICE)
        self.included = Segmented(tr("Include"), [(READ, tr("Good"), ""), (WITH_CARE, tr("Good and caution"), "")])
        self.simulated = Toggle(tr("Include simulated"), "", is_on=False)
        self.simulated.set_face(height=48)
        self.answer = QWidget()
        self.sentence = Text(size=22, weight=SEMIBOLD, wraps=True)
        self.notes = Text(tone="ink2", wraps=True)
        self.plot = GroupPlot()
        self._legend = Text(
            tr(
                "Dot: mean of the sessions (walks averaged per leg, then both legs). Bar: 95 % interval of "
                "that mean. Hollow dot: no interval. Groups are not tested for differences."
            ),
            size=12,
            tone="ink2",
            wraps=True,
        )
        self.table = CellTable(tr("Groups"))
        self.more = Text(size=12, tone="ink2", wraps=True)
        self._build()
        self._connect()
        self.show_nothing()

    @property
    def question(self) -> GroupQuestion | None:
        """What is asked now; None without a table."""
        if self.measure.currentData() is None or self.grouping.currentData() is None:
            return None
        return GroupQuestion(
            str(self.measure.currentData()),
            Grouping(self.grouping.currentData()),
            has_care=self.included.choice == WITH_CARE,
            has_simulated=self.simulated.isChecked(),
        )

    def focus(self) -> None:
        (self.make_table if not self._empty.isHidden() else self.measure).setFocus()

    def set_room(self, width: float) -> None:
        """Lay out for a page of this width, in px of the design."""
        self._width = width
        room = px(width) - 2 * px(MARGIN)
        halves = (self._first_half, self._second_half)
        beside = sum(half.sizeHint().width() for half in halves) + px(GAP)
        is_row = beside <= room
        self._halves.setDirection(QBoxLayout.Direction.LeftToRight if is_row else QBoxLayout.Direction.TopToBottom)
        for half in halves:
            needed = half.sizeHint().width()
            half.setDirection(
                QBoxLayout.Direction.LeftToRight if needed <= room or is_row else QBoxLayout.Direction.TopToBottom
            )
        self._show_table()

    def show_nothing(self) -> None:
        """Say how a table comes to be, and let one be chosen."""
        self.found = None
        self._name.setText("")
        self._show_parts(self._empty)

    def show_refused(self, what: str, remedy: str) -> None:
        """Say why there is no answer; without a table, above how one comes to be."""
        self.found = None
        self.refusal.show_message(Icon.WARNING, what, remedy, is_caution=True)
        self._show_parts(self.refusal, self._controls if self.question is not None else self._empty)

    def show_table(self, name: str, measures: Sequence[str], groupings: Sequence[Grouping]) -> None:
        """Offer what this table can be asked; what was chosen stays where it can."""
        self._name.setText(name)
        choices = (
            (self.measure, [(measure_words(one).name, one) for one in in_order(tuple(measures))]),
            (self.grouping, [(grouping_word(one), one.value) for one in groupings]),
        )
        for choice, offered in choices:
            before = choice.currentData()
            with QSignalBlocker(choice):
                choice.clear()
                for words, key in offered:
                    choice.addItem(words, key)
                choice.setCurrentIndex(max(choice.findData(before), 0) if offered else -1)
            choice.updateGeometry()
        self._show_parts(self._controls)

    def show_reading(self, name: str) -> None:
        """Say which table is being read; its answer is here in a moment."""
        self.found = None
        self._name.setText(name)
        self._show_parts()

    def forget_table(self) -> None:
        """Offer nothing any more."""
        for choice in (self.measure, self.grouping):
            with QSignalBlocker(choice):
                choice.clear()
        self.show_nothing()

    def show_answer(self, found: GroupAnswer) -> None:
        """Show what was found; nothing is stated about what it means."""
        self.found = found
        words, grouping = measure_words(found.question.measure), found.question.grouping
        stated = notes(found)
        self.sentence.setText(sentence(found))
        self.notes.setText(" ".join(stated))
        self.notes.setVisible(bool(stated))
        drawn = _drawn(found)
        lines = [
            GroupLine(group_name(grouping, row.group), row.mean, row.half_interval, _sessions(row)) for row in drawn
        ]
        in_words = ". ".join(_line_in_words(line, words.decimals, words.unit) for line in lines)
        self.plot.show_groups(lines, words.with_unit, tr("Group means"), in_words)
        self.plot.setVisible(bool(lines))
        self._legend.setVisible(bool(lines))
        self._show_table()
        self.more.setText(_more(found, len(drawn)))
        self.more.setVisible(bool(self.more.text()))
        self._show_parts(self._controls, self.answer)

    def _show_table(self) -> None:
        if self.found is not None:
            is_narrow = self._width < NARROW_BELOW
            self.table.show_rows(*groups_table(self.found, is_narrow=is_narrow))
            self.table.setAccessibleDescription(self.sentence.text())

    def _show_parts(self, *shown: QWidget) -> None:
        for part in (self._empty, self.refusal, self._controls, self.answer):
            part.setVisible(part in shown)
        self.choose_table.setVisible(self._empty not in shown)
        self._name.setVisible(self._empty not in shown and bool(self._name.text()))

    def _build(self) -> None:
        head = lay_out(QHBoxLayout(), self._title, (self._name, 1), self.choose_table)
        how = (
            tr("A table combines many sessions without names."),
            tr("All sessions of this library are analysed into a folder. Their results there are not encrypted."),
            tr("For session folders run gaitwright batch FOLDER --out OUT, then choose OUT/parameters.parquet here."),
        )
        self._empty.column.addWidget(Text(tr("No table yet"), size=26, weight=SEMIBOLD, wraps=True))
        for words in how[:2]:
            self._empty.column.addWidget(Text(words, size=16, tone="ink2", wraps=True))
        self._empty.column.addWidget(self.make_table, 0, Qt.AlignmentFlag.AlignLeft)
        self._empty.column.addWidget(Text(how[2], size=16, tone="ink2", wraps=True))
        self._empty.column.addWidget(self.first_table, 0, Qt.AlignmentFlag.AlignLeft)
        self._first_half, self._second_half = (
            QBoxLayout(QBoxLayout.Direction.LeftToRight),
            QBoxLayout(QBoxLayout.Direction.LeftToRight),
        )
        for half, named in (
            (self._first_half, ((tr("Measure"), self.measure), (tr("Group by"), self.grouping))),
            (self._second_half, ((tr("Include"), self.included), ("", self.simulated))),
        ):
            for label, control in named:
                part = lay_out(QVBoxLayout(), Text(label, weight=MEDIUM), (control, 1, Qt.AlignmentFlag.AlignVCenter))
                part.setSpacing(4)
                half.addLayout(part)
            lay_out(half, 1, spacing=GAP)
        self._halves = QBoxLayout(QBoxLayout.Direction.LeftToRight, self._controls)
        lay_out(self._halves, self._first_half, self._second_half, margins=0, spacing=GAP)
        self._chart = Card()
        lay_out(self._chart.column, self.plot, self._legend)
        self._figures = Card()
        lay_out(self._figures.column, self.table, self.more)
        answers = (self.sentence, self.notes, self._chart, self._figures)
        lay_out(QVBoxLayout(self.answer), *answers, margins=0, spacing=8)
        column = lay_out(QVBoxLayout(self), head, self.refusal, self._empty, self._controls, self.answer, 1)
        lay_out(column, margins=(MARGIN, 16, MARGIN, 20), spacing=12)

    def _connect(self) -> None:
        self.make_table.clicked.connect(self.making_requested)
        self.choose_table.clicked.connect(self.table_requested)
        self.first_table.clicked.connect(self.table_requested)
        self.measure.currentIndexChanged.connect(self._on_changed)
        self.grouping.currentIndexChanged.connect(self._on_changed)
        self.included.chosen.connect(self._on_changed)
        self.simulated.toggled.connect(self._on_changed)

    def _on_changed(self, _value: object = None) -> None:
        if (question := self.question) is not None:
            self.question_changed.emit(question)


def _drawn(found: GroupAnswer) -> list[GroupRow]:
    """The groups with most sessions, in their order."""
    most = sorted(found.reported, key=lambda row: -row.sessions)[:MOST_DRAWN]
    return [row for row in found.reported if row in most]


def _sessions(row: GroupRow) -> str:
    return tr_n("{count} session", "{count} sessions", row.sessions).format(count=row.sessions)


def _line_in_words(line: GroupLine, decimals: int, unit: str) -> str:
    mean = f"{figure_text(line.mean, f'.{decimals}f')} {unit}".rstrip()
    if line.half != line.half:
        return f"{line.label}: {mean}, {line.count}"
    half = tr("plus or minus {half}").format(half=figure_text(line.half, f".{decimals}f"))
    return f"{line.label}: {mean}, {half}, {line.count}"


def _more(found: GroupAnswer, drawn: int) -> str:
    """How many groups are not in sight, and where they are."""
    stated = []
    if len(found.reported) > drawn:
        reported = tr("Of {count} groups, the chart shows the {drawn} with the most sessions.")
        stated.append(reported.format(drawn=drawn, count=len(found.reported)))
    if len(found.rows) > MOST_ROWS:
        stated.append(
            tr("The table shows the first {shown} groups of {count}. The CSV has all groups.").format(
                shown=MOST_ROWS, count=len(found.rows)
            )
        )
    return " ".join(stated)
