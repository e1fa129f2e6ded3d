"""What is shown in place of patients while there are none: how to begin, what a session needs and how it goes."""

from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QFontMetrics, QPainter
from PySide6.QtWidgets import QBoxLayout, QGridLayout, QHBoxLayout, QSizePolicy, QVBoxLayout, QWidget

from app.theme.current import current_theme, px, scaled
from app.theme.icons import Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.card import Card
from app.widgets.heard_order import hear_as_laid_out
from app.widgets.icons import IconMark
from app.widgets.lay_out import lay_out
from app.widgets.painted import Painted
from app.widgets.painted_text import CENTRE, PaintedText
from app.widgets.text import SEMIBOLD, Text
from app.wording.translation import tr

CIRCLE = 26
NARROW_BELOW = 760  # px of the design: what a session needs is listed one below another
WIDE_FROM = 960
PAGE_EDGE, EDGE, NARROW_EDGE, GAP = 24, 80, 24, 16  # from the page's edge to the card, and from that to the words
LINE = 20
WIDEST_WORDS = 600


class EmptyLibrary(Card):
    """Passive: whoever holds it connects its buttons."""

    def __init__(self) -> None:
        self._ways, self._needs = QBoxLayout(QBoxLayout.Direction.LeftToRight), QGridLayout()
        super().__init__(spacing=GAP)
        self.new_patient = Button(tr("New patient"), ButtonKind.PRIMARY, Icon.ADD, tr("Ctrl N"), height=56)
        self.demonstration = Button(tr("Open demonstration"), ButtonKind.SECONDARY, Icon.PLAY, height=56)
        self.importing = Button(tr("Import recordings"), ButtonKind.SECONDARY, Icon.IMPORT, height=56)
        self.steps = StepsPreview()
        begin = tr(
            "Start with a code instead of a name. A first session takes about five minutes. The "
            "demonstration guides you through one, without sensors."
        )
        lay_out(self._ways, *self.buttons, 1, spacing=GAP)
        self._need_parts = [
            self._need(Icon.WAVE, tr("Six sensors"), tr("thigh, shank, foot; any orientation")),
            self._need(Icon.ARROW, tr("Eight-metre walkway"), tr("ten strides per leg")),
            self._need(Icon.CHECK, tr("No poses, no tape measure"), tr("the patient moves the legs freely")),
        ]
        lay_out(self.column, 2, Text(tr("No patients yet"), size=38, weight=SEMIBOLD, wraps=True))
        self._begin = Text(begin, size=16, tone="ink2", wraps=True)
        scaled(self._begin.setMaximumWidth, WIDEST_WORDS)
        begin_row = QHBoxLayout()  # which knows how high the words are at their greatest width
        lay_out(begin_row, (self._begin, 1), 0)
        needs = Text(tr("What a session needs"), size=16, weight=SEMIBOLD, wraps=True)
        lay_out(self.column, begin_row, self._ways, 2, needs, self._needs, 1, self.steps, 2)
        scaled(self._needs.setSpacing, GAP)
        self.set_room(1000)

    @property
    def buttons(self) -> list[QWidget]:
        return [self.new_patient, self.demonstration, self.importing]

    def set_room(self, width: float) -> None:
        """Lay out for a page of this width, in px of the design."""
        edge = EDGE if width >= WIDE_FROM else NARROW_EDGE
        scaled(self.column.setContentsMargins, edge, 24, edge, 24)
        room = px(width - 2 * PAGE_EDGE) - 2 * px(edge)
        beside = sum(button.sizeHint().width() for button in self.buttons) + (len(self.buttons) - 1) * px(GAP)
        way = QBoxLayout.Direction.LeftToRight if beside <= room else QBoxLayout.Direction.TopToBottom
        self._ways.setDirection(way)
        is_narrow = width < NARROW_BELOW
        for number, part in enumerate(self._need_parts):
            self._needs.addWidget(part, number if is_narrow else 0, 0 if is_narrow else number)
        hear_as_laid_out(self)
        self.steps.set_room(room)

    def _need(self, icon: Icon, what: str, more: str) -> QWidget:
        part = QWidget()
        words = lay_out(
            QVBoxLayout(), Text(what, weight=SEMIBOLD, wraps=True), Text(more, tone="ink2", wraps=True), spacing=0
        )
        lay_out(QHBoxLayout(part), (IconMark(icon, size=24), 0, Qt.AlignmentFlag.AlignTop), (words, 1), margins=0)
        return part


class StepsPreview(Painted):
    """The seven steps of a session on a line, and how long each takes."""

    def __init__(self) -> None:
        super().__init__()
        self._rows = 1
        self.steps = (
            (tr("Patient"), tr("{count} s").format(count=30)),
            (tr("Sensors"), tr("{count} s").format(count=90)),
            (tr("Stand still"), tr("{count} s").format(count=3)),
            (tr("Free motion"), tr("{count} s").format(count=20)),
            (tr("Walking"), tr("{count} s").format(count=60)),
            (tr("Results"), tr("immediately")),
            (tr("Report"), tr("immediately")),
        )
        self.setSizePolicy(QSizePolicy.Policy.MinimumExpanding, QSizePolicy.Policy.Fixed)
        self.setAccessibleName(tr("Steps of a session"))
        self.setAccessibleDescription(", ".join(f"{name} {time}" for name, time in self.steps))

    def set_room(self, width: int) -> None:
        """Take as many rows as the words need in a width, in px of the screen."""
        self._rows = next((rows for rows in (1, 2, 4) if self._wide(rows) <= width), len(self.steps))
        self.updateGeometry()
        self.update()

    def sizeHint(self) -> QSize:
        return QSize(self._wide(self._rows), self._rows * px(CIRCLE + 8 + 2 * LINE) + (self._rows - 1) * px(12))

    def painted_texts(self) -> list[PaintedText]:
        theme, texts = current_theme(), []
        width, circle, line = self.width() / self._in_row, theme.px(CIRCLE), theme.px(LINE)
        for number, (name, time) in enumerate(self.steps):
            left, top = self._place(number).x(), self._place(number).y()
            under = top + theme.px(CIRCLE + 8)
            in_circle, plain = QRectF(left, top, circle, circle), theme.font(14)
            texts += [
                PaintedText(str(number + 1), in_circle, plain, align=CENTRE),
                PaintedText(name, QRectF(left, under, width, line), theme.font(14, SEMIBOLD)),
                PaintedText(time, QRectF(left, under + line, width, line), plain, "ink2"),
            ]
        return texts

    def draw(self, painter: QPainter) -> None:
        theme, half = current_theme(), px(CIRCLE) / 2
        painter.setPen(theme.pen(theme.colours.control, 1.25))
        for number in range(len(self.steps)):
            centre = self._place(number) + QPointF(half, half)
            painter.drawEllipse(centre, half - 1, half - 1)
            if number + 1 < len(self.steps) and (number + 1) % self._in_row:
                following = self._place(number + 1) + QPointF(0, half)
                painter.drawLine(centre + QPointF(half, 0), following)

    def _wide(self, rows: int) -> int:
        """How wide so many rows are."""
        metrics = QFontMetrics(current_theme().font(14, SEMIBOLD))
        widest = max(metrics.horizontalAdvance(name) for name, _ in self.steps) + px(12)
        return widest * -(-len(self.steps) // rows)

    @property
    def _in_row(self) -> int:
        return -(-len(self.steps) // self._rows)

    def _place(self, number: int) -> QPointF:
        """The upper left corner of a step."""
        row, column = divmod(number, self._in_row)
        return QPointF(column * self.width() / self._in_row, row * px(CIRCLE + 8 + 2 * LINE + 12))
