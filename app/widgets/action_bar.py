"""Bar of the actions possible now.

Back is at the left, the primary verb at the right, and its consequence in words beside it.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from PySide6.QtCore import QPoint, QRect, QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QAccessible,
    QAccessibleAnnouncementEvent,
    QFontMetrics,
    QMouseEvent,
    QPainter,
    QResizeEvent,
)
from PySide6.QtWidgets import QSizePolicy, QWidget

from app.theme.current import current_theme, on_theme, px
from app.theme.ground import Ground, set_ground
from app.theme.icons import Icon, paint_icon
from app.widgets.button import HEIGHT, Button, ButtonKind
from app.widgets.grid import LEAST, NARROW_BELOW, side_margin
from app.widgets.painted import Painted
from app.widgets.painted_text import PaintedText
from app.widgets.text import SEMIBOLD, Text
from app.wording.numbers import clock
from app.wording.translation import tr

BAR = 72
STOP_HEIGHT = 56  # what stops a recording is found first
PRIMARY_WIDTH = 208
NOTE_WIDTH = 300  # longer words beside a verb take a second line
NOTE_AT_LEAST = 170
DOT = 16
BAR_GROUND = Ground("surface", "line", edge=Qt.Edge.TopEdge)
INVERSE = Ground("inv", edge=Qt.Edge.TopEdge)

Row = Sequence[QWidget]


@dataclass(frozen=True, slots=True)
class BarAction:
    """The words on a button, and what is done when it is pressed.

    `run` is a bound method, not a new function each time: what is equal is not shown again. `key` is what its cap
    shows. `is_requested`: pressing it is what we want, so it is filled.
    """

    text: str
    run: Callable[[], object]
    key: str = ""
    icon: Icon | None = None
    is_requested: bool = True
    is_enabled: bool = True


@dataclass(frozen=True, slots=True)
class RecordingNote:
    """What is being recorded; while there is one, the bar is inverse, to be seen across the room."""

    title: str
    note: str
    elapsed_s: float
    has_sound: bool


@dataclass(frozen=True, slots=True)
class BarState:
    """`others` stand left of the primary verb, `quiet` ones after Back; without Back the first takes its place.

    `on_page`: whose buttons are on the page itself; their keys are the bar's, and go before those of its own buttons.
    """

    primary: BarAction | None = None
    others: tuple[BarAction, ...] = ()
    quiet: tuple[BarAction, ...] = ()
    note: str = ""
    recording: RecordingNote | None = None
    has_back: bool = True
    on_page: tuple[BarAction, ...] = ()


class ActionBar(QWidget):
    """Grows by a line where a narrow window or a long language leaves no room; nothing in it is ever cut."""

    accessible_role = QAccessible.Role.ToolBar

    back_pressed = Signal()
    pressed = Signal(object)  # the BarAction that is to be run: whether it is, who shows it decides
    sound_pressed = Signal()
    recording_changed = Signal(bool)

    def __init__(self) -> None:
        super().__init__()
        self._state = BarState()
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setAccessibleName(tr("Actions"))
        self._clock = _Clock(self)
        self.back = VerbButton(self)
        self._quiet: list[VerbButton] = []
        self._title = Text(size=15, weight=SEMIBOLD, wraps=True, parent=self)
        self._note = Text(size=14, tone="ink2", wraps=True, parent=self)
        self.sound = VerbButton(self)
        self._others: list[VerbButton] = []
        self.primary = VerbButton(self, is_primary=True)
        self.back.clicked.connect(self.back_pressed)
        self.primary.clicked.connect(self._on_clicked)
        self.sound.clicked.connect(self.sound_pressed)
        self._show()
        on_theme(self._arrange)

    @property
    def state(self) -> BarState:
        return self._state

    @property
    def others(self) -> Sequence["VerbButton"]:
        return [button for button in self._others if not button.isHidden()]

    @property
    def quiet(self) -> Sequence["VerbButton"]:
        return [button for button in self._quiet if not button.isHidden()]

    @property
    def buttons(self) -> list["VerbButton"]:
        """All buttons, also hidden ones, in the order of reading."""
        return [self.back, *self._quiet, self.sound, *self._others, self.primary]

    @property
    def tab_order(self) -> list[QWidget]:
        """All that can be pressed, in the order of reading."""
        return [button for button in self.buttons if not button.isHidden()]

    @property
    def keys(self) -> list[str]:
        """The keys that its buttons show, and those of the page that it presses."""
        shown = [button.verb.key for button in self.buttons if not button.isHidden() and button.verb.key]
        return list(dict.fromkeys([*(action.key for action in self._state.on_page), *shown]))

    def press(self, key: str) -> None:
        """Press the button that shows this key, if it can be pressed."""
        if (on_page := next((one for one in self._state.on_page if one.key == key), None)) is not None:
            self.pressed.emit(on_page)
            return
        next(button for button in self.buttons if not button.isHidden() and button.verb.key == key).click()

    def show_state(self, state: BarState) -> None:
        """Show what can be done; cheap where only the elapsed time is another."""
        before, self._state = self._state, state
        if state.recording is not None:
            self._clock.show_elapsed(state.recording.elapsed_s)
        if _without_time(before) != _without_time(state):
            self._show()
            if (state.recording is None) != (before.recording is None):
                self.recording_changed.emit(state.recording is not None)
            if state.recording is not None and before.recording is None:
                words = f"{state.recording.title}. {state.recording.note}"
                QAccessible.updateAccessibility(QAccessibleAnnouncementEvent(self, words))

    def focus(self) -> None:
        """Give the focus to what will most likely be pressed."""
        order = self.tab_order
        best = self.primary if self.primary in order and self.primary.isEnabled() else next(iter(order), None)
        if best is not None:
            best.setFocus(Qt.FocusReason.OtherFocusReason)

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        if event.size().width() != event.oldSize().width():
            self._arrange()

    def _show(self) -> None:
        state = self._state
        recording = state.recording
        is_inverse = recording is not None
        had_focus = any(button.hasFocus() for button in self.tab_order)
        self._keep_enough(self._quiet, len(state.quiet))
        self._keep_enough(self._others, len(state.others))
        sound = None
        if recording is not None:
            words, icon = (tr("Sound on"), Icon.SOUND) if recording.has_sound else (tr("Sound off"), Icon.SOUND_OFF)
            sound = BarAction(words, self.sound_pressed.emit, icon=icon)
        has_back = state.has_back and not is_inverse
        back = BarAction(tr("Back"), self.back_pressed.emit, icon=Icon.BACK) if has_back else None
        self.back.show_verb(back, ButtonKind.SECONDARY, is_inverse)
        self.sound.show_verb(sound, ButtonKind.QUIET, is_inverse)
        for k, (button, verb) in enumerate(zip(self._quiet, _padded(state.quiet, len(self._quiet)), strict=True)):
            takes_place_of_back = k == 0 and not state.has_back
            button.show_verb(verb, ButtonKind.SECONDARY if takes_place_of_back else ButtonKind.QUIET, is_inverse)
        for button, verb in zip(self._others, _padded(state.others, len(self._others)), strict=True):
            button.show_verb(verb, ButtonKind.SECONDARY, is_inverse)
        requested = state.primary is not None and (state.primary.is_requested or is_inverse)
        self.primary.show_verb(state.primary, ButtonKind.PRIMARY if requested else ButtonKind.SECONDARY, is_inverse)
        self._clock.setVisible(is_inverse)
        self._title.setText(recording.title if recording is not None else "")
        self._note.setText(recording.note if recording is not None else state.note)
        for text in (self._title, self._note):
            text.setVisible(bool(text.text()))
        self._title.set_tone("inv_ink" if is_inverse else "ink")
        self._note.set_tone("inv_ink2" if is_inverse else "ink2")
        set_ground(self, INVERSE if is_inverse else BAR_GROUND)
        self._arrange()
        if had_focus and not any(button.hasFocus() for button in self.tab_order):
            self.focus()

    def _keep_enough(self, buttons: list["VerbButton"], count: int) -> None:
        while len(buttons) < count:
            button = VerbButton(self)
            button.clicked.connect(self._on_clicked)
            buttons.append(button)
            for before, after in pairwise(self.buttons):
                QWidget.setTabOrder(before, after)
            words, verbs = [self._title, self._note], [self.sound, *self._others, self.primary]
            for part in (self._clock, self.back, *self._quiet, *words, *verbs):
                part.raise_()  # in reading order: Qt lists the parts as they are stacked

    def _arrange(self) -> None:
        """Put all in one row, or the words above the verbs, or the verbs in as many rows as they need."""
        margin = side_margin(self.width(), current_theme())
        gap = px(16 if self.width() >= px(NARROW_BELOW) else 8)
        room = max(self.width(), px(LEAST)) - 2 * margin
        for button in self.buttons:
            button.set_room(room)
        left: Row = [one for one in (self._clock, self.back, *self._quiet) if not one.isHidden()]
        right: Row = [one for one in (self.sound, *self._others, self.primary) if not one.isHidden()]
        if _width(left, gap) + _width(right, gap) + gap > room:
            for button in self._quiet:
                button.leave_icon_away()
        before = _width(left, gap) + (gap if left else 0)
        after = _width(right, gap) + (gap if right else 0)
        is_one_row = before + after <= room
        is_beside = is_one_row and self._fits(room - before - after)
        rows = [(left, right)] if is_one_row else [*_rows(left, room, gap), *_rows(right, room, gap, is_right=True)]
        line = px(BAR) if is_beside else px((STOP_HEIGHT if self._state.recording is not None else HEIGHT) + 8)
        top = 0
        if is_beside:
            self._place_words(self._narrowed(QRect(margin + before, 0, room - before - after, line)))
        else:
            height = self._words_height(room)
            self._place_words(QRect(margin, px(8), room, height))
            top = px(8) + height
        for first, last in rows:
            self._place_row(first, margin, top, line, gap)
            self._place_row(last, margin + room - _width(last, gap), top, line, gap)
            top += line
        self.setFixedHeight(top if is_beside else max(top + px(4), px(BAR)))

    def _place_row(self, widgets: Row, x: int, top: int, line: int, gap: int) -> None:
        for widget in widgets:
            size = widget.sizeHint()
            widget.setGeometry(QRect(QPoint(x, top + (line - size.height()) // 2), size))
            x += size.width() + gap

    def _fits(self, width: int) -> bool:
        """Return whether the words may stand beside the verbs: not squeezed, and no higher than the bar."""
        texts = [text for text in (self._title, self._note) if text.text()]
        widest = max((text.fontMetrics().horizontalAdvance(text.text()) for text in texts), default=0)
        return width >= min(widest, px(NOTE_AT_LEAST)) and self._words_height(width) <= px(BAR - 8)

    def _words_height(self, width: int) -> int:
        texts = [text for text in (self._title, self._note) if text.text()]
        return sum(text.heightForWidth(max(width, 1)) for text in texts)

    def _narrowed(self, box: QRect) -> QRect:
        """Give lines of a length that is read at a glance: two short ones rather than a long one."""
        if self._state.recording is not None:
            return box
        for widest in (NOTE_WIDTH, 2 * NOTE_WIDTH):
            left = max(box.left(), box.right() + 1 - px(widest))
            if self._words_height(box.right() + 1 - left) <= px(44):
                return QRect(left, box.top(), box.right() + 1 - left, box.height())
        return box

    def _place_words(self, box: QRect) -> None:
        """Place title and note: by the primary verb whose price they state, or after the time of a recording."""
        align = Qt.AlignmentFlag.AlignRight if self._state.recording is None else Qt.AlignmentFlag.AlignLeft
        top = box.top() + (box.height() - self._words_height(box.width())) // 2
        for text in (self._title, self._note):
            height = text.heightForWidth(box.width()) if text.text() else 0
            text.setAlignment(align | Qt.AlignmentFlag.AlignVCenter)
            text.setGeometry(box.left(), top, box.width(), height)
            top += height

    def _on_clicked(self) -> None:
        button = self.sender()
        assert isinstance(button, VerbButton)
        self.pressed.emit(button.verb)


_NOTHING = BarAction("", lambda: None)


class VerbButton(Button):
    """A button whose word, key and kind follow what can be done now; hidden while it is nothing.

    `verb`: what it does, nothing while it is hidden; its key holds though there may be no room for the cap.
    """

    def __init__(self, parent: QWidget, is_primary: bool = False) -> None:
        super().__init__("", parent=parent)
        self._is_primary = is_primary
        self.verb = _NOTHING
        self.hide()

    @property
    def is_filled(self) -> bool:
        return self.face.kind is ButtonKind.PRIMARY

    def show_verb(self, verb: BarAction | None, kind: ButtonKind, is_inverse: bool) -> None:
        self.setVisible(verb is not None)
        self.verb = verb or _NOTHING
        if verb is None:
            return
        height = STOP_HEIGHT if is_inverse and self._is_primary else HEIGHT
        self.set_face(kind=kind, icon=verb.icon, key=verb.key, is_inverse=is_inverse, height=height)
        self.setText(verb.text)
        self.setAccessibleName(verb.text)
        self.setAccessibleDescription(tr("Key {key}").format(key=verb.key) if verb.key else "")
        self.setEnabled(verb.is_enabled)

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Take a double click for the one press that it is meant as: the second would stop what the first began."""
        event.accept()

    def set_room(self, width: int) -> None:
        """Leave away the key cap, then the icon, where the words alone fill `width` pixels."""
        self.set_face(icon=self.verb.icon, key=self.verb.key)
        if self.sizeHint().width() > width:
            self.set_face(key="")
        if self.sizeHint().width() > width:
            self.set_face(icon=None)

    def leave_icon_away(self) -> None:
        self.set_face(icon=None)

    def sizeHint(self) -> QSize:
        size = super().sizeHint()
        if self._is_primary:
            size.setWidth(max(size.width(), px(PRIMARY_WIDTH)))
        return size


class _Clock(Painted):
    """The dot of a recording and its time. The dot does not blink."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self._time = "00:00"
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)

    def show_elapsed(self, elapsed_s: float) -> None:
        time = clock(elapsed_s, 2)
        if time != self._time:
            self._time = time
            self.setAccessibleName(tr("Recording, {time}").format(time=time))
            self.update()

    def painted_texts(self) -> list[PaintedText]:
        """Give the time in its box."""
        font = current_theme().font(40, SEMIBOLD)
        return [PaintedText(self._time, QRectF(self.rect()).adjusted(self._text_left(), 0, 0, 0), font, "inv_ink")]

    def sizeHint(self) -> QSize:
        theme = current_theme()
        widest = QFontMetrics(theme.font(40, SEMIBOLD)).horizontalAdvance("000:00")
        return QSize(self._text_left() + widest, theme.px(HEIGHT))

    def draw(self, painter: QPainter) -> None:
        theme = current_theme()
        side = theme.px(DOT * 24 / 14)  # the icon's dot is 14 of its 24
        dot = QRectF(theme.px(12) - side / 2, (self.height() - side) / 2, side, side)
        paint_icon(painter, Icon.RECORDING, dot, theme.colours.inv_ink)

    def _text_left(self) -> int:
        return px(36)


def _without_time(state: BarState) -> BarState:
    if state.recording is None:
        return state
    return replace(state, recording=replace(state.recording, elapsed_s=0.0))


def _padded(verbs: tuple[BarAction, ...], length: int) -> list[BarAction | None]:
    return [*verbs, *[None] * (length - len(verbs))]


def _width(widgets: Row, gap: int) -> int:
    return sum(widget.sizeHint().width() for widget in widgets) + gap * max(len(widgets) - 1, 0)


def _rows(widgets: Row, room: int, gap: int, is_right: bool = False) -> list[tuple[Row, Row]]:
    """Fill rows one after another; what is wider than a row has one of its own."""
    rows: list[list[QWidget]] = []
    for widget in widgets:
        if rows and _width([*rows[-1], widget], gap) <= room:
            rows[-1].append(widget)
        else:
            rows.append([widget])
    return [([], row) if is_right else (row, []) for row in rows]
