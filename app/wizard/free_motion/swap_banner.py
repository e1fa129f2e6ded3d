"""Banner in the place of the hint while sensors move like those of other places, with its two ways on."""

from PySide6.QtCore import QPointF, QRectF, QSize
from PySide6.QtGui import (
    QAccessible,
    QAccessibleAnnouncementEvent,
    QColor,
    QFontMetrics,
    QPainter,
    QResizeEvent,
)
from PySide6.QtWidgets import QBoxLayout, QHBoxLayout, QSizePolicy, QVBoxLayout, QWidget

from app.theme.current import current_theme, on_theme, px, scaled
from app.theme.ground import Ground, set_ground
from app.theme.icons import Icon, paint_icon
from app.theme.theme import CARD_RADIUS
from app.widgets.action_bar import BarAction, VerbButton
from app.widgets.button import ButtonKind
from app.widgets.lay_out import lay_out
from app.widgets.painted import Painted
from app.widgets.painted_text import height_for
from app.widgets.text import SEMIBOLD, Text

HEIGHT, COMPACT_HEIGHT = 120, 96
MARK, COMPACT_MARK = 64, 40
SENTENCES, COMPACT_SENTENCES = (32, 28, 24, 20), (22, 20, 18)  # the largest that takes two lines at most
BUTTONS = 324
STACKED_BELOW = 620  # px of the design: the buttons stand below the words


class SwapBanner(Painted):
    """Hidden until sensors look swapped."""

    accessible_role = QAccessible.Role.AlertMessage

    def __init__(self) -> None:
        super().__init__()
        self._is_compact = False
        set_ground(self, Ground("caution", "caution_edge", radius=CARD_RADIUS))
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Minimum)
        self._what = Text(size=SENTENCES[0], weight=SEMIBOLD, tone="caution_ink", wraps=True)
        self._then = Text(size=15, tone="caution_ink", wraps=True)
        self.use = VerbButton(self, is_primary=True)
        self.check = VerbButton(self)
        words = lay_out(QVBoxLayout(), 1, self._what, self._then, 1, spacing=0)
        self._beside = lay_out(QVBoxLayout(), *self.buttons)
        for button in (self.use, self.check):
            button.clicked.connect(self._on_clicked)
        self._row = lay_out(QHBoxLayout(self), (words, 1), self._beside, spacing=12)
        on_theme(self._fit_sentence)
        self.set_compact(False)
        self.hide()

    @property
    def text(self) -> str:
        return " ".join(filter(None, [self._what.text(), self._then.text()]))

    @property
    def buttons(self) -> tuple[QWidget, ...]:
        """The two ways on, in the order of reading."""
        return (self.use, self.check)

    def show_message(self, what: str, then: str, use: BarAction, check: BarAction) -> None:
        """Show which places look swapped and what that costs; whoever cannot see it is notified once."""
        is_news = self.isHidden() or what != self._what.text()
        self.use.show_verb(use, ButtonKind.PRIMARY, is_inverse=False)
        self.check.show_verb(check, ButtonKind.QUIET, is_inverse=False)
        self.show()
        if is_news:
            self._what.setText(what)
            self._then.setText(then)
            self._then.setVisible(bool(then))
            self._fit_sentence()
            self.setAccessibleName(self.text)
            QAccessible.updateAccessibility(QAccessibleAnnouncementEvent(self, self.text))

    def set_compact(self, is_compact: bool) -> None:
        self._is_compact = is_compact
        self._then.set_size(14 if is_compact else 15)
        left, down = self._inset + self._mark + (16 if is_compact else 20), 6 if is_compact else 10
        scaled(self._row.setContentsMargins, left, down, 16 if is_compact else 24, down)
        scaled(self._beside.setSpacing, 0.4 if is_compact else 4)  # the former is one px at every size
        scaled(self.use.setMinimumWidth, 0 if is_compact else BUTTONS)
        self._fit_sentence()
        self.updateGeometry()
        self.update()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        is_stacked = self.width() < px(STACKED_BELOW)
        self._row.setDirection(QBoxLayout.Direction.TopToBottom if is_stacked else QBoxLayout.Direction.LeftToRight)
        self._fit_sentence()

    def minimumSizeHint(self) -> QSize:
        hint = super().minimumSizeHint()
        return QSize(hint.width(), max(hint.height(), px(COMPACT_HEIGHT if self._is_compact else HEIGHT)))

    def draw(self, painter: QPainter) -> None:
        theme = current_theme()
        c, px = theme.colours, theme.px
        mark = self._mark * theme.scale
        centre = QPointF(px(self._inset) + mark / 2, self.height() / 2)
        if self._row.direction() is QBoxLayout.Direction.TopToBottom:
            centre.setY(px(12) + mark / 2)
        painter.setPen(theme.pen(c.caution_mark, 1))
        painter.setBrush(QColor(c.caution_mark))
        painter.drawEllipse(centre, mark / 2, mark / 2)
        side = mark * 0.5
        icon = QRectF(centre.x() - side / 2, centre.y() - side / 2, side, side)
        paint_icon(painter, Icon.SWAP, icon, c.caution_mark_ink)

    @property
    def _mark(self) -> int:
        return COMPACT_MARK if self._is_compact else MARK

    @property
    def _inset(self) -> int:
        return 16 if self._is_compact else 24

    def _fit_sentence(self) -> None:
        theme, margins = current_theme(), self._row.contentsMargins()
        room = self.width() - margins.left() - margins.right()
        if self._row.direction() is QBoxLayout.Direction.LeftToRight:
            room -= self._row.spacing() + max(button.sizeHint().width() for button in self.buttons)
        sizes = COMPACT_SENTENCES if self._is_compact else SENTENCES
        for size in sizes:
            font = theme.font(size, SEMIBOLD)
            if height_for(self._what.text(), font, room) <= 2.1 * QFontMetrics(font).lineSpacing():
                break
        self._what.set_size(size)

    def _on_clicked(self) -> None:
        button = self.sender()
        assert isinstance(button, VerbButton)
        button.verb.run()
