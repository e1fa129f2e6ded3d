"""The frame round every step: rail, header, sensors, banner, page and bar, each in its place at every size."""

from enum import Enum, auto
from itertools import pairwise

from PySide6.QtCore import QEvent, QObject, QPoint, QPropertyAnimation, QRect, Qt, QTimer, Signal
from PySide6.QtGui import QPixmap, QResizeEvent, QShowEvent
from PySide6.QtWidgets import QGraphicsOpacityEffect, QHBoxLayout, QLabel, QScrollArea, QVBoxLayout, QWidget

from app.theme.current import current_theme, on_theme, px, scaled
from app.theme.motion import duration_ms
from app.widgets.action_bar import ActionBar, BarState
from app.widgets.banner import Banner
from app.widgets.grid import COMPACT_BELOW, CONTENT, LEAST, WIDE_FROM, side_margin
from app.widgets.header import Header
from app.widgets.lay_out import lay_out
from app.widgets.page_stack import PageStack
from app.widgets.rail_row import RailForm
from app.widgets.sensor_strip import SensorStrip
from app.widgets.step_rail import StepRail
from app.widgets.toast import Toast
from app.wizard.step import StepId

FADE_MS = 120
LEAST_PAGE = 40
LOW_BELOW = 480  # of the window, px of the design: tiles would leave the page no room


class StripMode(Enum):
    """FOLDED: a button in the header, which unfolds by itself when a sensor turns bad.

    Where the window is too low for tiles, SHOWN is folded too, and nothing unfolds by itself: the button shows it.
    """

    SHOWN = auto()
    FOLDED = auto()
    HIDDEN = auto()


class WizardShell(QWidget):
    """Passive: it lays out what it holds, and knows nothing of what a page is for.

    `room_changed`: whether the window is compact, and the width and height that a page has, in px of the design.
    Emitted when the room or the page is another one.
    """

    room_changed = Signal(bool, float, float)

    def __init__(self) -> None:
        super().__init__()
        self._strip_mode, self._is_compact = StripMode.HIDDEN, False
        self._is_low = False
        self._by_step: dict[StepId, QWidget] = {}
        self.rail = StepRail()
        self.header = Header(has_mark=False)
        self.strip = SensorStrip()
        self.banner = Banner()
        self._pages = PageStack()
        self._scroll = QScrollArea()
        self._outer = QScrollArea()  # scrolls only in a window that is too low for header and bar, as 400 x 280 is
        self.bar = ActionBar()
        self._build()
        self.toast = Toast(self)
        self._fade = _Fade(self._scroll)
        self._settled = QTimer(self)
        self._settled.setSingleShot(True)
        self._settled.timeout.connect(lambda: self._scroll.setUpdatesEnabled(True))
        self._connect()
        self.setAutoFillBackground(True)
        on_theme(self._fit)
        self.set_strip_mode(StripMode.HIDDEN)

    @property
    def is_compact(self) -> bool:
        return self._is_compact

    @property
    def page(self) -> QWidget | None:
        """The page in sight."""
        return self._pages.currentWidget()

    @property
    def pages(self) -> dict[StepId, QWidget]:
        """Those that are made."""
        return dict(self._by_step)

    def add_page(self, step: StepId, page: QWidget) -> None:
        """Take in a page; one that the step had before is given up."""
        if (before := self._by_step.get(step)) is page:
            return
        if before is not None:
            self._pages.removeWidget(before)
            before.deleteLater()
        self._by_step[step] = page
        self._pages.addWidget(page)

    def begin_fade(self) -> None:
        """Let the page that comes next appear under this one, as it is before anything of it changes.

        Afterwards a picture of it would cost as much again: all of it would be laid out first.
        """
        self._fade.begin()

    def show_page(self, step: StepId, page: QWidget | None = None) -> None:
        """Go to a page, which is taken in if it is new. The focus goes where its reading starts."""
        if page is not None:
            self.add_page(step, page)
        page = self._by_step[step]
        if page is not self.page:
            self._scroll.setUpdatesEnabled(False)  # until the page has its size, else its charts are painted at each
            self._settled.start(0)
            self._pages.setCurrentWidget(page)
            self._scroll.verticalScrollBar().setValue(0)
            self._scroll.horizontalScrollBar().setValue(0)
        self._show_room()
        self._chain()
        self._focus_page()

    def clear_pages(self) -> None:
        """Let go of all pages, and of what the bar does for them."""
        self.bar.show_state(BarState())
        self._fade.end()
        for page in self._by_step.values():
            self._pages.removeWidget(page)
            page.hide()
            page.deleteLater()
        self._by_step.clear()
        self.header.fold.setChecked(False)  # what one session looked at is no wish of the next

    def set_strip_mode(self, mode: StripMode) -> None:
        if mode is not self._strip_mode:
            self._strip_mode = mode
            self.header.fold.setChecked(False)
        self._show_strip()

    def focus_next_region(self, steps: int) -> None:
        """Take the focus to the next region, or the one before: rail, sensors, page, bar."""
        sensors = self.strip if not self.strip.isHidden() else self.header.fold
        regions = [region for region in (self.rail, sensors, self._scroll, self.bar) if not region.isHidden()]
        focused = self.window().focusWidget()
        at = next(
            (
                k
                for k, one in enumerate(regions)
                if focused is not None and (one is focused or one.isAncestorOf(focused))
            ),
            regions.index(self._scroll),
        )
        goal = regions[(at + steps) % len(regions)]
        if goal is self._scroll:
            self._focus_page()
        elif isinstance(goal, StepRail | SensorStrip | ActionBar):
            goal.focus()
        else:
            goal.setFocus(Qt.FocusReason.OtherFocusReason)
        if goal is not self.rail:
            self._outer.ensureWidgetVisible(goal, 0, 0)

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._fit()

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        self._fit()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if event.type() in (QEvent.Type.Resize, QEvent.Type.Show, QEvent.Type.Move):
            if watched is self._scroll.viewport():
                self._fade.setGeometry(self._scroll.viewport().rect())
                self._show_room()
            else:
                self._place_toast()
        return super().eventFilter(watched, event)

    def _build(self) -> None:
        for scroll in (self._scroll, self._outer):
            scroll.setWidgetResizable(True)
            scroll.setFocusPolicy(Qt.FocusPolicy.NoFocus)
            scroll.setMinimumSize(1, 1)  # the hint of a scroll area would be more than a low window has
        self._scroll.setWidget(self._pages)
        scaled(self._scroll.setMinimumHeight, LEAST_PAGE)
        self._banner_row = lay_out(QVBoxLayout(), self.banner)
        self._middle = lay_out(QVBoxLayout(), self._banner_row, (self._scroll, 1), spacing=0)
        column = QWidget()
        lay_out(QVBoxLayout(column), self.header, self.strip, (self._middle, 1), self.bar, margins=0, spacing=0)
        self._outer.setWidget(column)
        self._outer.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        lay_out(QHBoxLayout(self), self.rail, (self._outer, 1), margins=0, spacing=0)

    def _connect(self) -> None:
        self.header.fold.toggled.connect(self._on_fold_toggled)
        self.strip.tiles_changed.connect(self._on_tiles_changed)
        self.strip.turned_bad.connect(self._on_turned_bad)
        self.bar.recording_changed.connect(self._on_recording_changed)
        self._outer.verticalScrollBar().rangeChanged.connect(self._on_range_changed)
        self._outer.verticalScrollBar().valueChanged.connect(self._place_toast)
        self._scroll.viewport().installEventFilter(self)
        for widget in (self.bar, self.toast):
            widget.installEventFilter(self)

    def _fit(self) -> None:
        """Choose the forms of all parts by the room the window has, in px of the design."""
        scale = current_theme().scale
        width, height = self.width() / scale, self.height() / scale
        was_low, self._is_low = self._is_low, height < LOW_BELOW
        self._is_compact = width < COMPACT_BELOW[0] or height < COMPACT_BELOW[1]
        form = RailForm.WIDE if width >= WIDE_FROM else RailForm.USUAL
        self.rail.set_form(RailForm.COMPACT if self._is_compact else form)
        self.header.set_compact(self._is_compact)
        self.strip.set_compact(self._is_compact)
        free = self.width() - self.rail.width()
        beside = max(free - px(CONTENT), 0) // 2
        self._middle.setContentsMargins(beside, 0, beside, 0)
        margin = side_margin(free, current_theme()) - beside
        self._banner_row.setContentsMargins(margin, 0, margin, 0)
        if was_low != self._is_low:
            self.header.fold.setChecked(False)
            self._show_strip()
        self._place_toast()
        self._show_room()

    def _show_room(self) -> None:
        if self.page is None:
            return
        scale = current_theme().scale
        room = self._scroll.viewport().size()
        self.room_changed.emit(self._is_compact, room.width() / scale, room.height() / scale)

    def _chain(self) -> None:
        """Let Tab go through the page after the banner, and from the page to the bar."""
        page = self.page
        if page is None:
            return
        inside = getattr(page, "tab_order", None)
        if inside is None:
            inside = [
                one
                for one in page.findChildren(QWidget)  # among them lists that fold out in windows of their own
                if one.focusPolicy() & Qt.FocusPolicy.TabFocus and one.window() is self.window()
            ]
        for before, after in pairwise([self.banner, *inside, *self.bar.buttons]):
            QWidget.setTabOrder(before, after)

    def _focus_page(self) -> None:
        page = self.page
        if page is None:
            return
        focus = getattr(page, "focus", None)
        if focus is None:
            page.setFocus(Qt.FocusReason.OtherFocusReason)
            return
        focus()
        focused = self.window().focusWidget()
        is_left = focused is page and page.focusPolicy() is Qt.FocusPolicy.NoFocus  # where Qt put it for want of better
        if focused is None or is_left or not page.isAncestorOf(focused):
            self.bar.focus()  # nothing on this page waits for keys

    def _show_strip(self) -> None:
        mode = self._strip_mode
        if mode is StripMode.SHOWN and self._is_low:
            mode = StripMode.FOLDED
        self.header.set_fold_shown(mode is StripMode.FOLDED)
        self.strip.setVisible(mode is StripMode.SHOWN or (mode is StripMode.FOLDED and self.header.fold.isChecked()))

    def _place_toast(self) -> None:
        px = current_theme().px
        bar = QRect(self.bar.mapTo(self, QPoint(0, 0)), self.bar.size())
        margin = side_margin(bar.width(), current_theme())
        if bar.width() <= px(LEAST):
            margin = px(4)
        self.toast.set_room(bar.width() - 2 * margin)
        above = min(bar.top(), self.height()) - px(16) - self.toast.height()
        self.toast.move(bar.left() + margin, max(above, px(8)))

    def _on_fold_toggled(self) -> None:
        self._show_strip()

    def _on_tiles_changed(self) -> None:
        self.header.fold.show_tiles(self.strip.tiles)

    def _on_turned_bad(self) -> None:
        if self._strip_mode is StripMode.FOLDED and not self._is_low:
            self.header.fold.setChecked(True)

    def _on_recording_changed(self, is_recording: bool) -> None:
        """Reserve the banner's place while recording so that nothing jumps, unless the page has its own place."""
        policy = self.banner.sizePolicy()
        policy.setRetainSizeWhenHidden(is_recording and not getattr(self.page, "keeps_place_for_messages", False))
        self.banner.setSizePolicy(policy)

    def _on_range_changed(self) -> None:
        """Keep what stops a recording in sight where the frame itself has to scroll."""
        if self.bar.state.recording is not None:
            self._outer.ensureWidgetVisible(self.bar.primary, 0, px(8))


class _Fade(QLabel):
    """The page that was there, as a picture over the one that is, going away."""

    def __init__(self, scroll: QScrollArea) -> None:
        super().__init__(scroll.viewport())
        self._under = scroll.viewport()
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        effect = QGraphicsOpacityEffect(self)
        self.setGraphicsEffect(effect)
        self._run = QPropertyAnimation(effect, b"opacity", self)
        self._run.setStartValue(1.0)
        self._run.setEndValue(0.0)
        self._run.finished.connect(self.end)
        self.hide()

    def begin(self) -> None:
        """Take the picture of what is there now; what comes next appears under it."""
        self.end()
        duration = duration_ms(FADE_MS, current_theme())
        if duration == 0 or not self._under.isVisible():
            return
        self.setPixmap(self._under.grab())
        self.setGeometry(self._under.rect())
        self._run.setDuration(duration)
        self.show()
        self.raise_()
        self._run.start()

    def end(self) -> None:
        self._run.stop()
        self.setPixmap(QPixmap())
        self.hide()
