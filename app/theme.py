"""How does the window look? Colours, type and space of one scheme at one size."""

from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

from PySide6.QtCore import QByteArray, QEvent, QObject, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QFont, QFontDatabase, QPainter, QPalette, QPen
from PySide6.QtWidgets import QApplication, QStyle, QToolTip, QWidget

from app.colours import DARK as DARK
from app.colours import LIGHT as LIGHT
from app.colours import Colours as Colours
from app.style import ControlStyle
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

    def veil(self, is_pressed: bool, ink: QColor | None = None) -> QColor:
        """Give the thin layer of ink over a control under the mouse, twice as strong in the `ink` of a dark one."""
        colour = QColor(ink or self.colours.ink)
        colour.setAlphaF((0.10 if is_pressed else 0.04) * (2 if ink is not None else 1))
        return colour

    def paint_box(
        self,
        painter: QPainter,
        box: QRectF,
        fill: QColor | str | None,
        line: QColor | str | None = None,
        width: float = 1.25,
        radius: float = CONTROL_RADIUS,
    ) -> None:
        """Draw a box with round corners; without `fill` or `line` what is under it is seen."""
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(self.pen(line, width) if line is not None else Qt.PenStyle.NoPen)
        painter.setBrush(QColor(fill) if fill is not None else Qt.BrushStyle.NoBrush)
        painter.drawRoundedRect(box, radius * self.scale, radius * self.scale)

    def paint_cap(self, painter: QPainter, box: QRectF, key: str, ink: QColor | str, line: QColor | str) -> None:
        """Draw a key cap."""
        self.paint_box(painter, box, None, line, 1, CHIP_RADIUS)
        painter.setPen(QColor(ink))
        painter.setFont(self.font(12, QFont.Weight.Medium))
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, key)


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
        self._apply(Theme())

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
            self._put_on(app)
        self.changed.emit()

    def _put_on(self, app: QApplication) -> None:
        """Give the application style, palette and fonts, and tell every widget, those within others first.

        Qt itself would tell them in the order of their addresses, and what is laid out by hand measures its parts.
        """
        style = app.style()
        if isinstance(style, ControlStyle):
            style.theme = self.theme
        else:
            style = ControlStyle(self.theme)
            app.setStyle(style)
        palette = _palette(self.theme.colours)
        app.setPalette(palette)
        QToolTip.setPalette(palette)
        app.setFont(self.theme.font(14))
        choices = self.theme.font(16, QFont.Weight.DemiBold)
        app.setFont(choices, "QComboBox")  # type: ignore[arg-type]  # the stubs ask for bytes, which it refuses
        for window in app.topLevelWidgets():
            for change in (QEvent.Type.ApplicationFontChange, QEvent.Type.ApplicationPaletteChange):
                app.sendEvent(window, QEvent(change))  # which Qt would post, after the new style had been measured by
            _tell_style_changed(window, style)


def _tell_style_changed(widget: QWidget, style: QStyle) -> None:
    for child in widget.findChildren(QWidget, options=Qt.FindChildOption.FindDirectChildrenOnly):
        _tell_style_changed(child, style)
    style.polish(widget)
    QApplication.sendEvent(widget, QEvent(QEvent.Type.StyleChange))


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
