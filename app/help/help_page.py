"""Manual page on what the current page is for and what a message means.

Shown in the window, without leaving the session.
"""

from PySide6.QtCore import QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QColor,
    QFontMetrics,
    QKeyEvent,
    QPainter,
    QPaintEvent,
)
from PySide6.QtWidgets import (
    QAbstractButton,
    QBoxLayout,
    QButtonGroup,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from app.help.help_reader import HelpReader
from app.help.help_topics import Topic, TopicGroup, group_title, topic_title
from app.help.topic_text import markdown_of, plain_words_of
from app.theme.current import NO_LIMIT, current_theme, scaled
from app.theme.icons import Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.card import Card
from app.widgets.choice import Choice
from app.widgets.field import Field
from app.widgets.lay_out import lay_out
from app.widgets.reading_area import scrolled
from app.widgets.text import MEDIUM, REGULAR, SEMIBOLD, Text
from app.wording.translation import tr, tr_n

LIST_WIDTH = 264
ROW = 44
PADDING = 12
SHORTEST_SEARCH = 2


class HelpPage(QWidget):
    """Topics at the left, or above where room is short; what is searched for is marked in the text."""

    closed = Signal()

    def __init__(self) -> None:
        super().__init__()
        self._is_compact = False
        self._topic = Topic.HOME
        self.search = Field(tr("Search the help"), placeholder=tr("Search the help"), has_label=False)
        self.found = Text(size=14, tone="ink2", wraps=True)
        self.topics = _TopicList()
        self.choice = Choice(tr("Topic"))
        self.choice.addItems([topic_title(topic) for topic in Topic])
        self.text = HelpReader()
        self.back = Button(tr("Back"), ButtonKind.SECONDARY, Icon.BACK, tr("Esc"))
        self._build()
        self.topics.chosen.connect(self.show_topic)
        self.text.page_required.connect(self._on_page_required)
        self.choice.currentIndexChanged.connect(self._on_choice_changed)
        self.search.edited.connect(self._on_search_edited)
        self.back.clicked.connect(self.closed)
        self.show_topic(Topic.HOME)
        self.set_compact(is_compact=False)

    @property
    def topic(self) -> Topic:
        return self._topic

    @property
    def tab_order(self) -> list[QWidget]:
        """What takes the focus, in the order of reading."""
        return [self.search.line_edit, *self.topics.rows, self.choice, self.text, self.back]

    def show_topic(self, topic: Topic) -> None:
        """Open the manual at `topic`, with what is searched for marked in it."""
        self._topic = topic
        self.text.show_markdown(markdown_of(topic), topic_title(topic))
        self.topics.choose(topic)
        self.choice.blockSignals(True)
        self.choice.setCurrentIndex(list(Topic).index(topic))
        self.choice.blockSignals(False)
        self._mark()

    def set_compact(self, is_compact: bool) -> None:
        """Fold the list of topics into one choice above the text."""
        self._is_compact = is_compact
        self._scroll.setVisible(not is_compact)
        self.choice.setVisible(is_compact)
        way = QBoxLayout.Direction.TopToBottom if is_compact else QBoxLayout.Direction.LeftToRight
        self._row.setDirection(way)
        above = QBoxLayout.Direction.LeftToRight if is_compact else QBoxLayout.Direction.TopToBottom
        self._side.setDirection(above)
        top = Qt.AlignmentFlag.AlignTop
        self._side.setAlignment(self.choice, top)
        self._side.setAlignment(self.back, top if is_compact else Qt.AlignmentFlag.AlignLeft)
        scaled(self._row.setContentsMargins, *[16 if is_compact else 24] * 4)
        scaled(self._beside.setMinimumWidth, 0 if is_compact else LIST_WIDTH)
        scaled(self._beside.setMaximumWidth, NO_LIMIT if is_compact else LIST_WIDTH)

    def focus(self) -> None:
        """Give the focus to the text, so that the keys scroll it."""
        self.text.setFocus()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        match event.key():
            case Qt.Key.Key_Escape:
                self.closed.emit()
            case Qt.Key.Key_Return | Qt.Key.Key_Enter if self.search.line_edit.hasFocus():
                self._go_on()
            case _:
                super().keyPressEvent(event)

    def _build(self) -> None:
        self._scroll = scrolled(self.topics)
        self._beside = QWidget()
        self._side = QBoxLayout(QBoxLayout.Direction.TopToBottom, self._beside)
        searching = lay_out(QVBoxLayout(), self.search, self.found)
        lay_out(self._side, searching, (self._scroll, 1), self.choice, self.back, margins=0, spacing=12)
        page = Card(padding=16)
        page.column.addWidget(self.text)
        self._row = lay_out(QBoxLayout(QBoxLayout.Direction.LeftToRight, self), self._beside, (page, 1), spacing=16)

    def _mark(self) -> None:
        """Mark what is searched for, and show at every topic how often it has it."""
        words = self.search.text.strip()
        required = words if len(words) >= SHORTEST_SEARCH else ""
        counts = {topic: plain_words_of(topic).count(required.casefold()) if required else None for topic in Topic}
        self.topics.show_counts(counts)
        self.text.mark(required)
        total = sum(count or 0 for count in counts.values())
        stated = ""
        if required and total:
            stated = tr_n("1 match.", "{count} matches. Enter goes to the next.", total).format(count=total)
        elif required:
            stated = tr("No matches. Try another word.")
        self.found.setText(stated)
        self.found.setVisible(bool(stated))

    def _go_on(self) -> None:
        """Go to the next place that is found, in this topic or a later one."""
        if self.text.go_to_next():
            return
        topics = list(Topic)
        here = topics.index(self._topic)
        later = [*topics[here + 1 :], *topics[: here + 1]]
        required = self.search.text.strip().casefold()
        following = next((topic for topic in later if required and required in plain_words_of(topic)), None)
        if following is not None:
            self.show_topic(following)
            self.text.go_to_next()

    def _on_search_edited(self) -> None:
        self._mark()
        if self.text.has_marks:
            self.text.go_to_next()

    def _on_page_required(self, name: str) -> None:
        """Follow a link of the text, if it leads to a page of the manual: nothing leads out of this computer."""
        if name in set(Topic):
            self.show_topic(Topic(name))
            self.focus()

    def _on_choice_changed(self, index: int) -> None:
        self.show_topic(list(Topic)[index])


class _TopicList(QWidget):
    """Groups of topics under their titles. One stop for Tab; the arrows go from topic to topic."""

    chosen = Signal(object)

    def __init__(self) -> None:
        super().__init__()
        self.setAccessibleName(tr("Topics"))
        self._group = QButtonGroup(self)
        self._by_topic = {topic: _TopicRow(topic_title(topic)) for topic in Topic}
        column = QVBoxLayout(self)
        column.setSpacing(2)
        begun = {Topic(group): group for group in TopicGroup}
        for topic, row in self._by_topic.items():
            if topic in begun:
                column.addWidget(_GroupTitle(group_title(begun[topic])))
            self._group.addButton(row)
            column.addWidget(row)
        lay_out(column, 1, margins=0)
        self._group.buttonClicked.connect(self._on_clicked)
        self._group.buttonToggled.connect(self._on_toggled)

    @property
    def rows(self) -> list[QAbstractButton]:
        return list(self._by_topic.values())

    def choose(self, topic: Topic) -> None:
        self._by_topic[topic].setChecked(True)

    def show_counts(self, counts: dict[Topic, int | None]) -> None:
        for topic, row in self._by_topic.items():
            row.show_count(counts[topic])

    def _on_clicked(self, button: QAbstractButton) -> None:
        self.chosen.emit(next(topic for topic, row in self._by_topic.items() if row is button))

    def _on_toggled(self, button: QAbstractButton, is_checked: bool) -> None:
        if is_checked and button.hasFocus():  # the arrows choose without a click
            self._on_clicked(button)


class _GroupTitle(Text):
    def __init__(self, title: str) -> None:
        super().__init__(title, size=12, weight=SEMIBOLD, tone="ink2")
        self.setContentsMargins(PADDING, PADDING, PADDING, 0)


class _TopicRow(QAbstractButton):
    def __init__(self, title: str) -> None:
        super().__init__()
        self._count: int | None = None
        self.setText(title)
        self.setCheckable(True)
        self.setAutoExclusive(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setAttribute(Qt.WidgetAttribute.WA_Hover)
        self.setSizePolicy(QSizePolicy.Policy.MinimumExpanding, QSizePolicy.Policy.Fixed)
        self.show_count(None)

    def show_count(self, count: int | None) -> None:
        """Show how often the topic has what is searched for; None while nothing is."""
        self._count = count
        found = "" if count is None else tr_n("{count} match", "{count} matches", count).format(count=count)
        self.setAccessibleName(", ".join(filter(None, [self.text(), found])))
        self.updateGeometry()
        self.update()

    def sizeHint(self) -> QSize:
        theme = current_theme()
        width = QFontMetrics(theme.font(14, SEMIBOLD)).horizontalAdvance(self.text())
        return QSize(width + self._count_width() + theme.px(3 * PADDING), theme.px(ROW))

    def paintEvent(self, _event: QPaintEvent) -> None:
        theme = current_theme()
        c, px = theme.colours, theme.px
        painter = QPainter(self)
        box = QRectF(self.rect())
        if self.isChecked() or self.underMouse():
            theme.paint_box(painter, box, c.sunken if self.isChecked() else theme.veil(self.isDown()))
        is_without = self._count == 0
        painter.setPen(QColor(c.ink3 if is_without else c.ink))
        painter.setFont(theme.font(14, SEMIBOLD if self.isChecked() else REGULAR))
        room = box.adjusted(px(PADDING), 0, -px(PADDING), 0)
        middle = Qt.AlignmentFlag.AlignVCenter
        painter.drawText(room, Qt.AlignmentFlag.AlignLeft | middle, self.text())
        if self._count:
            painter.setFont(theme.font(14, MEDIUM))
            painter.drawText(room, Qt.AlignmentFlag.AlignRight | middle, str(self._count))

    def _count_width(self) -> int:
        return QFontMetrics(current_theme().font(14, MEDIUM)).horizontalAdvance(str(self._count or ""))
