"""Chooser of the next walk's name: a label from the list, each with its digit, or words of one's own."""

from PySide6.QtCore import QRect, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QFontMetrics, QKeyEvent, QPainter, QPaintEvent, QResizeEvent
from PySide6.QtWidgets import QAbstractButton, QSizePolicy, QWidget

from app.theme.current import current_theme, px
from app.theme.theme import CHIP_RADIUS
from app.widgets.chips import flow
from app.widgets.field import Field
from app.widgets.painted_text import CENTRE, LEFT, PaintedText
from app.widgets.text import MEDIUM, SEMIBOLD
from app.widgets.themed import Themed
from app.wording.translation import tr

HEIGHT = 48  # as high as the field beside them
PADDING, GAP, CAP = 14, 8, 22
FIELD_WIDTH = 200
DIGITS = 9
STEPS = {Qt.Key.Key_Right: 1, Qt.Key.Key_Down: 1, Qt.Key.Key_Left: -1, Qt.Key.Key_Up: -1}


class LabelChooser(Themed):
    """The labels wrap into as many lines as they need, the field for other words last. Arrows move and choose."""

    chosen = Signal(str)  # by the user

    def __init__(self) -> None:
        super().__init__()
        self._options: list[_Option] = []
        self._choice = ""
        self.own = Field(tr("Other condition for the next walk"), placeholder=tr("Other"), has_label=False)
        self.own.setParent(self)
        # it was made before the labels: Tab would come to its box in its place
        self.own.setFocusProxy(None)  # type: ignore[arg-type]  # the stubs know no None, which takes the proxy away
        self.setAccessibleName(tr("Next condition"))
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.own.committed.connect(self._on_own_committed)
        self._arrange()

    @property
    def choice(self) -> str:
        return self._choice

    @property
    def buttons(self) -> list[QAbstractButton]:
        return list(self._options)

    @property
    def stops(self) -> list[QWidget]:
        """Where the tabulator stops among the labels."""
        return [option for option in self._options if option.focusPolicy() is Qt.FocusPolicy.TabFocus]

    def show_labels(self, labels: tuple[str, ...], choice: str) -> None:
        """Offer `labels`; a choice that is none of them is shown in the field."""
        while len(self._options) > len(labels):
            self._options.pop().deleteLater()
        while len(self._options) < len(labels):
            option = _Option(self)
            option.clicked.connect(self._on_clicked)
            option.show()
            self._options.append(option)
        for number, (option, label) in enumerate(zip(self._options, labels, strict=True), start=1):
            option.show_label(label, str(number) if number <= DIGITS else "")
        self._choice = choice
        self._mark()
        self.own.set_text("" if choice in labels else choice)
        self.own.raise_()
        self._arrange()

    def choose_digit(self, digit: int) -> bool:
        """Choose the label with this digit on its cap; False where there is none."""
        if not 1 <= digit <= min(len(self._options), DIGITS):
            return False
        self._take(self._options[digit - 1].text())
        return True

    def step(self, option: "_Option", by: int) -> None:
        """Go on to the label before or after, and round at the end."""
        to = self._options[(self._options.index(option) + by) % len(self._options)]
        self._take(to.text())
        to.setFocus(Qt.FocusReason.TabFocusReason)

    def sizeHint(self) -> QSize:
        return QSize(self.minimumSizeHint().width(), self._height_for(self.width()))

    def minimumSizeHint(self) -> QSize:
        widths = [option.sizeHint().width() for option in self._options]
        return QSize(max([px(FIELD_WIDTH), *widths]), px(HEIGHT))

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._arrange()

    def _take(self, label: str) -> None:
        self._choice = label
        self._mark()
        if label in [option.text() for option in self._options]:
            self.own.set_text("")
        self.chosen.emit(label)

    def _mark(self) -> None:
        """Mark the choice, and let the tabulator stop there, or at the first label.

        The mouse leaves the focus where it is: Space must start the walk, not press the label again.
        """
        chosen = [option for option in self._options if option.text() == self._choice]
        before, stops = self.stops, (chosen or self._options)[:1]
        for stop in stops:
            stop.setFocusPolicy(Qt.FocusPolicy.TabFocus)
            for one in before:
                QWidget.setTabOrder(one, stop)  # in whose place it comes; Qt chains nothing that takes no focus
        for option in self._options:
            option.setChecked(option in chosen)
            if option not in stops:
                option.setFocusPolicy(Qt.FocusPolicy.NoFocus)

    def _flow(self, width: int) -> list[QRect]:
        """Where each label lies, and the field last, in lines of `width`."""
        px = current_theme().px
        required = [*(option.sizeHint().width() for option in self._options), px(FIELD_WIDTH)]
        return flow(required, width, px(GAP), px(HEIGHT))

    def _height_for(self, width: int) -> int:
        return self._flow(width)[-1].bottom() + 1

    def _apply_theme(self) -> None:
        self._arrange()

    def _arrange(self) -> None:
        for widget, place in zip([*self._options, self.own], self._flow(self.width()), strict=True):
            widget.setGeometry(place)
        self.setFixedHeight(self._height_for(self.width()))  # layouts ask for no height of a width
        self.updateGeometry()

    def _on_clicked(self) -> None:
        clicked = self.sender()
        assert isinstance(clicked, _Option)
        self._take(clicked.text())

    def _on_own_committed(self) -> None:
        stated = self.own.text.strip()
        if stated:
            self._take(stated)


class _Option(QAbstractButton):
    """A label with the digit that chooses it."""

    def __init__(self, chooser: LabelChooser) -> None:
        super().__init__(chooser)
        self._chooser, self._digit = chooser, ""
        self.setCheckable(True)
        self.setAttribute(Qt.WidgetAttribute.WA_Hover)

    def show_label(self, label: str, digit: str) -> None:
        self._digit = digit
        self.setText(label)
        self.setAccessibleName(label)
        self.setAccessibleDescription(tr("Key {key}").format(key=digit) if digit else "")
        self.update()

    def sizeHint(self) -> QSize:
        px = current_theme().px
        cap = px(GAP) + px(CAP) if self._digit else 0
        return QSize(2 * px(PADDING) + self._word_width + cap, px(HEIGHT))

    def painted_texts(self) -> list[PaintedText]:
        """Give what is painted now, each in its box."""
        theme = current_theme()
        weight = SEMIBOLD if self.isChecked() else MEDIUM
        word = QRectF(theme.px(PADDING), 0, self._word_width, self.height())
        texts = [PaintedText(self.text(), word, theme.font(14, weight), "ink", LEFT)]
        if self._digit:
            texts.append(PaintedText(self._digit, self._cap, theme.font(12, MEDIUM), "ink", CENTRE))
        return texts

    def keyPressEvent(self, event: QKeyEvent) -> None:
        by = STEPS.get(Qt.Key(event.key()))
        if by is not None:
            self._chooser.step(self, by)
            return
        super().keyPressEvent(event)

    def nextCheckState(self) -> None:  # noqa: N802  Qt calls it
        """Leave it to the chooser, which marks one of all."""

    def paintEvent(self, _event: QPaintEvent) -> None:
        theme = current_theme()
        c = theme.colours
        painter = QPainter(self)
        box = QRectF(self.rect()).adjusted(1, 1, -1, -1)
        line, width = (c.ink, 1.75) if self.isChecked() else (c.control, 1.25)
        theme.paint_box(painter, box, c.surface, line, width)
        if self.underMouse() or self.isDown():
            theme.paint_box(painter, box, theme.veil(self.isDown()))
        if self._digit:
            theme.paint_box(painter, self._cap, None, c.control, 1, CHIP_RADIUS)
        for text in self.painted_texts():
            text.paint(painter, c)

    @property
    def _cap(self) -> QRectF:
        px = current_theme().px
        return QRectF(self.width() - px(PADDING) - px(CAP), (self.height() - px(CAP)) / 2, px(CAP), px(CAP))

    @property
    def _word_width(self) -> int:
        """As wide as the word is when chosen, so that nothing moves."""
        return QFontMetrics(current_theme().font(14, SEMIBOLD)).horizontalAdvance(self.text()) + 1
