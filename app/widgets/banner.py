"""What happened and what to do, in the page and never in a dialog. It stays until it is dismissed or made good."""

from PySide6.QtCore import QPointF, QRectF, Signal
from PySide6.QtGui import QAccessible, QAccessibleAnnouncementEvent, QColor, QPainter
from PySide6.QtWidgets import QHBoxLayout, QSizePolicy, QVBoxLayout

from app.theme.current import current_theme, scaled
from app.theme.icons import Icon, paint_icon
from app.widgets.button import Button, ButtonKind
from app.widgets.lay_out import lay_out
from app.widgets.painted import Painted
from app.widgets.text import SEMIBOLD, Text
from app.wording.translation import tr

HEIGHT = 64
MARK = 36
ABOVE = 12  # clear of the header; gone together with the banner


class Banner(Painted):
    """Hidden until it is given something to show."""

    accessible_role = QAccessible.Role.AlertMessage

    dismissed = Signal()
    acted = Signal()  # the way on that was offered

    def __init__(self) -> None:
        super().__init__()
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)
        self._what = Text(size=16, weight=SEMIBOLD, tone="caution_ink", wraps=True)
        self._next = Text(size=14, tone="caution_ink", wraps=True)
        self.act = Button("", ButtonKind.SECONDARY, height=44)
        self.dismiss = Button(tr("Dismiss"), ButtonKind.QUIET, height=44)
        words = lay_out(QVBoxLayout(), 1, self._what, self._next, 1, spacing=0)
        row = QHBoxLayout(self)
        lay_out(row, (words, 1), self.act, self.dismiss, margins=(16 + MARK + 12, ABOVE + 8, 8, 8), spacing=16)
        self.act.clicked.connect(self.acted)
        self.dismiss.clicked.connect(self._on_dismiss_clicked)
        scaled(self.setMinimumHeight, HEIGHT + ABOVE)
        self.hide()

    @property
    def text(self) -> str:
        return " ".join(filter(None, [self._what.text(), self._next.text()]))

    def show_message(self, what: str, then: str = "", verb: str = "") -> None:
        """Show what happened, in bold, and what follows or what to do; `verb` names a way on, which `acted` signals."""
        self.act.setText(verb)
        self.act.setVisible(bool(verb))
        self._what.setText(what)
        self._next.setText(then)
        self._next.setVisible(bool(then))
        self.setAccessibleName(self.text)
        self.show()
        QAccessible.updateAccessibility(QAccessibleAnnouncementEvent(self, self.text))

    def draw(self, painter: QPainter) -> None:
        theme = current_theme()
        c, px = theme.colours, theme.px
        box = QRectF(self.rect()).adjusted(0.5, px(ABOVE) + 0.5, -0.5, -0.5)
        theme.paint_box(painter, box, c.caution, c.caution_edge, 1)
        centre = QPointF(px(16 + MARK / 2), (self.height() + px(ABOVE)) / 2)
        painter.setPen(theme.pen(c.caution_edge, 1))
        painter.setBrush(QColor(c.caution_mark))
        painter.drawEllipse(centre, MARK / 2 * theme.scale, MARK / 2 * theme.scale)
        side = px(MARK) * 0.6
        mark = QRectF(centre.x() - side / 2, centre.y() - side * 0.55, side, side)
        paint_icon(painter, Icon.WARNING, mark, c.caution_mark_ink)

    def _on_dismiss_clicked(self) -> None:
        self.hide()
        self.dismissed.emit()
