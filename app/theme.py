"""How does the window look? Colours, type and space of one scheme at one size."""

from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

from PySide6.QtCore import QByteArray, QObject, Qt, Signal
from PySide6.QtGui import QColor, QFont, QFontDatabase, QPalette, QPen
from PySide6.QtWidgets import QApplication

from app.colours import DARK as DARK
from app.colours import LIGHT as LIGHT
from app.colours import Colours as Colours
from core.body import Side

FONT_FILES = ("Inter-Regular.otf", "Inter-Medium.otf", "Inter-SemiBold.otf", "InterDisplay-SemiBold.otf")
DISPLAY_FROM_PX = 24  # from here on the letters are drawn for size

SCALES = (0.8, 0.9, 1.0, 1.1, 1.25, 1.5, 1.75, 2.0)

CHIP_RADIUS = 4
CONTROL_RADIUS = 8
CARD_RADIUS = 10


@dataclass(frozen=True, slots=True)
class Theme:
    """One scheme at one size. Every length on the screen goes through `px`."""

    colours: Colours = LIGHT
    scale: float = 1.0

    @property
    def is_dark(self) -> bool:
        return self.colours is DARK

    def px(self, length: float) -> int:
        return max(1, round(length * self.scale))

    def font(self, size: float, weight: QFont.Weight = QFont.Weight.Normal, is_code: bool = False) -> QFont:
        """Give the font of `size` px of the type table, with figures of one width; codes tell 0 from O."""
        return QFont(_font("Inter Display" if size >= DISPLAY_FROM_PX else "Inter", self.px(size), weight, is_code))

    def curve(self, side: Side) -> QColor:
        return QColor(self.colours.left if side is Side.LEFT else self.colours.right)

    def text(self, side: Side) -> QColor:
        return QColor(self.colours.left_text if side is Side.LEFT else self.colours.right_text)

    def pale(self, side: Side) -> QColor:
        return QColor(self.colours.left_pale if side is Side.LEFT else self.colours.right_pale)

    def soft(self, side: Side) -> QColor:
        return QColor(self.colours.left_soft if side is Side.LEFT else self.colours.right_soft)

    def band(self, side: Side) -> QColor:
        """Give the fill of a band of certainty, clear enough for the other leg's band to show through."""
        colour = self.soft(side)
        colour.setAlphaF(0.55 if self.is_dark else 0.45)
        return colour

    def pen(self, colour: QColor | str, width: float) -> QPen:
        pen = QPen(QColor(colour), width * self.scale)
        pen.setCapStyle(Qt.PenCapStyle.RoundCap)
        pen.setJoinStyle(Qt.PenJoinStyle.RoundJoin)
        return pen

    def side_pen(self, side: Side, width: float) -> QPen:
        """Give the pen of one leg's curve: left solid, right dashed."""
        pen = self.pen(self.curve(side), width)
        pen.setCosmetic(True)
        if side is Side.RIGHT:
            pen.setCapStyle(Qt.PenCapStyle.FlatCap)
            pen.setDashPattern([4.0, 2.2])
        return pen

    def veil(self, is_pressed: bool) -> QColor:
        """Give the thin layer of ink over a control under the mouse."""
        colour = QColor(self.colours.ink)
        colour.setAlphaF(0.10 if is_pressed else 0.04)
        return colour


@cache
def _font(family: str, pixels: int, weight: QFont.Weight, is_code: bool) -> QFont:
    """Kept, since painters ask for the same few thousands of times a second."""
    font = QFont(family)
    font.setPixelSize(pixels)
    font.setWeight(weight)
    font.setHintingPreference(QFont.HintingPreference.PreferNoHinting)
    font.setFeature(QFont.Tag("tnum"), 1)
    if is_code:
        font.setFeature(QFont.Tag("zero"), 1)
    return font


class Look(QObject):
    """The theme in force. Widgets are given it, draw with `theme`, and draw anew on `changed`."""

    changed = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.theme = Theme()

    def set_dark(self, is_dark: bool) -> None:
        self._apply(replace(self.theme, colours=DARK if is_dark else LIGHT))

    def set_scale(self, scale: float) -> None:
        """Set the size of everything, between 0.8 and 2."""
        self._apply(replace(self.theme, scale=min(max(scale, SCALES[0]), SCALES[-1])))

    def grow(self, steps: int) -> None:
        """Go up or down the table of sizes; 0 goes back to 100 %."""
        if steps == 0:
            self.set_scale(1.0)
            return
        nearest = min(range(len(SCALES)), key=lambda i: abs(SCALES[i] - self.theme.scale))
        self.set_scale(SCALES[min(max(nearest + steps, 0), len(SCALES) - 1)])

    def _apply(self, theme: Theme) -> None:
        self.theme = theme
        app = QApplication.instance()
        if isinstance(app, QApplication):
            app.setPalette(_palette(theme.colours))
            app.setFont(theme.font(14))
            app.setStyleSheet(_style_sheet(theme))
        self.changed.emit()


def load_fonts() -> None:
    """Make the bundled fonts known to Qt.

    Raises
    ------
    FileNotFoundError
        The installation is incomplete.
    """
    folder = Path(__file__).parents[1] / "resources" / "fonts"
    for name in FONT_FILES:
        QFontDatabase.addApplicationFontFromData(QByteArray((folder / name).read_bytes()))


def _palette(colours: Colours) -> QPalette:
    """Give Qt's own palette, which native dialogs and everything without a style of ours follow."""
    role = QPalette.ColorRole
    palette = QPalette()
    for one, colour in {
        role.Window: colours.ground,
        role.WindowText: colours.ink,
        role.Base: colours.surface,
        role.AlternateBase: colours.sunken,
        role.Text: colours.ink,
        role.PlaceholderText: colours.ink3,
        role.Button: colours.surface,
        role.ButtonText: colours.ink,
        role.Highlight: colours.inv,
        role.HighlightedText: colours.inv_ink,
        role.ToolTipBase: colours.inv,
        role.ToolTipText: colours.inv_ink,
        role.Link: colours.ink,
        role.Mid: colours.line,
    }.items():
        palette.setColor(one, QColor(colour))
    for one in (role.WindowText, role.Text, role.ButtonText):
        palette.setColor(QPalette.ColorGroup.Disabled, one, QColor(colours.disabled))
    return palette


def _style_sheet(theme: Theme) -> str:
    """Give the style of lists, tables and scroll bars; all else paints itself."""
    c, px = theme.colours, theme.px
    return f"""
    QTableView {{ background: transparent; border: none; color: {c.ink}; outline: none; }}
    QTableView QTableCornerButton::section, QTableView QHeaderView {{ background: transparent; border: none; }}
    QTableView::item:selected {{ background: {c.sunken}; color: {c.ink}; }}
    QPlainTextEdit {{ background: {c.surface}; color: {c.ink}; border: {px(1.25)}px solid {c.control};
        border-radius: {px(8)}px; padding: {px(8)}px;
        selection-background-color: {c.inv}; selection-color: {c.inv_ink}; }}
    QScrollArea, QScrollArea > QWidget > QWidget {{ background: transparent; border: none; }}
    QComboBox QAbstractItemView {{ background: {c.surface}; color: {c.ink}; border: 1px solid {c.control};
        selection-background-color: {c.inv}; selection-color: {c.inv_ink}; outline: none; }}
    QComboBox QAbstractItemView::item {{ min-height: {px(44)}px; padding: 0 {px(12)}px; }}
    QMenu {{ background: {c.surface}; color: {c.ink}; border: 1px solid {c.control}; padding: {px(4)}px; }}
    QMenu::item {{ background: transparent; padding: {px(12)}px {px(28)}px {px(12)}px {px(16)}px; }}
    QMenu::item:selected {{ background: {c.inv}; color: {c.inv_ink}; }}
    QMenu::indicator {{ width: 0; }}
    QProgressBar {{ background: {c.track}; border: none; border-radius: {px(4)}px; }}
    QProgressBar::chunk {{ background: {c.ink}; border-radius: {px(4)}px; }}
    QScrollBar:vertical {{ background: transparent; width: {px(12)}px; }}
    QScrollBar:horizontal {{ background: transparent; height: {px(12)}px; }}
    QScrollBar::handle {{ background: {c.control}; border-radius: {px(3)}px; margin: {px(3)}px;
        min-height: {px(32)}px; min-width: {px(32)}px; }}
    QScrollBar::add-line, QScrollBar::sub-line {{ width: 0; height: 0; }}
    QScrollBar::add-page, QScrollBar::sub-page {{ background: transparent; }}
    QAbstractScrollArea::corner {{ background: transparent; border: none; }}
    QToolTip {{ background: {c.inv}; color: {c.inv_ink}; border: none; padding: {px(8)}px; }}
    """
