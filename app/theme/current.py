"""The theme in force, which the style holds, and how it reaches the application: style, palette and fonts."""

from collections.abc import Callable, Iterable
from dataclasses import replace
from importlib.resources import files

from PySide6.QtCore import QByteArray, QEvent, Qt
from PySide6.QtGui import QColor, QFont, QFontDatabase, QGuiApplication, QPalette
from PySide6.QtWidgets import QApplication, QLayout, QStyle, QToolTip, QWidget

from app.theme.colours import DARK, LIGHT, Colours
from app.theme.style import ControlStyle
from app.theme.theme import Theme

FONT_FILES = ("Inter-Regular.otf", "Inter-Medium.otf", "Inter-SemiBold.otf", "InterDisplay-SemiBold.otf")

POINTS_PER_INCH = 72.0
SCALED = "scaled"  # property of widgets and layouts: their setters with lengths of the design, in order
NO_LIMIT = 8_000_000  # px of the design, Qt's own at 200 %: a length that was scaled is replaced, never taken back
SCALES = (0.8, 0.9, 1.0, 1.1, 1.25, 1.5, 1.75, 2.0)


def current_theme() -> Theme:
    """Give the theme that the application's style paints with; the usual one before `set_theme`."""
    style = QApplication.style()
    return style.theme if isinstance(style, ControlStyle) else Theme()


def px(length: float) -> int:
    """Give a length of the design in pixels at the size in force, at least one."""
    return current_theme().px(length)


def scaled(setter: Callable[..., object], *lengths: float) -> None:
    """Call a setter of a widget or layout with lengths of the design in pixels, now and whenever the theme changes.

    `setter` is a bound method, as `row.setSpacing`; a further call of the same one takes the place of the one before.
    """
    owner = setter.__self__  # type: ignore[attr-defined]  # of a bound method
    others = [one for one in owner.property(SCALED) or () if one[0] != setter.__name__]
    owner.setProperty(SCALED, [*others, (setter.__name__, lengths)])
    setter(*_in_pixels(lengths))


def on_theme(method: Callable[[], object]) -> None:
    """Call a method of a widget now and whenever the theme changes, after its lengths, for what it measures by hand."""
    scaled(method)


def set_dark(is_dark: bool) -> None:
    set_theme(replace(current_theme(), colours=DARK if is_dark else LIGHT))


def set_scale(scale: float) -> None:
    """Set the size of everything, between 0.8 and 2."""
    set_theme(replace(current_theme(), scale=min(max(scale, SCALES[0]), SCALES[-1])))


def grow(steps: int) -> None:
    """Go up or down the table of sizes; 0 goes back to 100 %."""
    if steps == 0:
        set_scale(1.0)
        return
    nearest = min(range(len(SCALES)), key=lambda i: abs(SCALES[i] - current_theme().scale))
    set_scale(SCALES[min(max(nearest + steps, 0), len(SCALES) - 1)])


def set_theme(theme: Theme) -> None:
    """Give the application style, palette and fonts, and notify every widget, those within others first.

    Qt itself would notify them in the order of their addresses, and what is laid out by hand measures its parts.
    """
    app = QApplication.instance()
    assert isinstance(app, QApplication)
    style = app.style()
    if isinstance(style, ControlStyle):
        style.theme = theme
    else:
        style = ControlStyle(theme)
        app.setStyle(style)
    palette = _palette(theme.colours)
    app.setPalette(palette)
    QToolTip.setPalette(palette)
    app.setFont(_in_points(theme.font(14)))
    choices = _in_points(theme.font(16, QFont.Weight.DemiBold))
    if theme.has_less_motion:  # menus that fade, where the desktop lets them; back with the next start
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
        if not child.isWindow():  # which has its own turn
            _show_style_changed(child, style)
    _scale_again(widget)
    style.polish(widget)
    QApplication.sendEvent(widget, QEvent(QEvent.Type.StyleChange))


def _scale_again(one: QWidget | QLayout) -> None:
    """Repeat what `scaled` was asked of the layouts within a widget, then of itself; what measures them comes last."""
    for layout in one.findChildren(QLayout, options=Qt.FindChildOption.FindDirectChildrenOnly):
        _scale_again(layout)
    for name, lengths in sorted(one.property(SCALED) or (), key=lambda asked: not asked[1]):
        getattr(one, name)(*_in_pixels(lengths))


def _in_pixels(lengths: Iterable[float]) -> list[int]:
    """Nothing stays nothing; what is there has a pixel at least."""
    return [px(length) if length else 0 for length in lengths]


def load_fonts() -> None:
    """Register the bundled fonts with Qt; raises FileNotFoundError where the installation is incomplete."""
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
