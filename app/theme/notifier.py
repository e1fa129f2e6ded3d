"""The theme in force, and how it reaches the application: style, palette and fonts."""

from dataclasses import replace
from functools import cache
from importlib.resources import files

from PySide6.QtCore import QByteArray, QEvent, QObject, Qt, Signal
from PySide6.QtGui import QColor, QFont, QFontDatabase, QGuiApplication, QPalette
from PySide6.QtWidgets import QApplication, QStyle, QToolTip, QWidget

from app.theme.colours import DARK, LIGHT, Colours
from app.theme.style import ControlStyle
from app.theme.theme import Theme

FONT_FILES = ("Inter-Regular.otf", "Inter-Medium.otf", "Inter-SemiBold.otf", "InterDisplay-SemiBold.otf")

POINTS_PER_INCH = 72.0
SCALES = (0.8, 0.9, 1.0, 1.1, 1.25, 1.5, 1.75, 2.0)


class ThemeNotifier(QObject):
    """The theme in force. Widgets are given it, draw with `theme`, and draw again on `changed`."""

    changed = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._apply(Theme())

    def set_dark(self, is_dark: bool) -> None:
        self._apply(replace(self.theme, colours=DARK if is_dark else LIGHT))

    def set_scale(self, scale: float) -> None:
        """Set the size of everything, between 0.8 and 2."""
        self._apply(replace(self.theme, scale=min(max(scale, SCALES[0]), SCALES[-1])))

    def set_less_motion(self, has_less_motion: bool) -> None:
        self._apply(replace(self.theme, has_less_motion=has_less_motion))

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
        """Give the application style, palette and fonts, and notify every widget, those within others first.

        Qt itself would notify them in the order of their addresses, and what is laid out by hand measures its parts.
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
        app.setFont(_in_points(self.theme.font(14)))
        choices = _in_points(self.theme.font(16, QFont.Weight.DemiBold))
        if self.theme.has_less_motion:  # menus that fade, where the desktop lets them; back with the next start
            app.setEffectEnabled(Qt.UIEffect.UI_General, False)
        app.setFont(choices, "QComboBox")  # type: ignore[arg-type]  # the stubs ask for bytes, which it refuses
        for window in app.topLevelWidgets():
            for change in (QEvent.Type.ApplicationFontChange, QEvent.Type.ApplicationPaletteChange):
                app.sendEvent(window, QEvent(change))  # which Qt would post, after the new style had been measured by
            _show_style_changed(window, style)


def _in_points(font: QFont) -> QFont:
    """The same font, of the same height: Qt's own dialogs reckon with points, of which one in pixels has none."""
    font = QFont(font)
    font.setPointSizeF(font.pixelSize() * POINTS_PER_INCH / QGuiApplication.primaryScreen().logicalDotsPerInchY())
    return font


def _show_style_changed(widget: QWidget, style: QStyle) -> None:
    for child in widget.findChildren(QWidget, options=Qt.FindChildOption.FindDirectChildrenOnly):
        _show_style_changed(child, style)
    style.polish(widget)
    QApplication.sendEvent(widget, QEvent(QEvent.Type.StyleChange))


@cache  # each time more, Qt keeps them once more
def load_fonts() -> None:
    """Make the bundled fonts known to Qt.

    Raises
    ------
    FileNotFoundError
        The installation is incomplete.
    """
    folder = files("resources") / "fonts"
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
