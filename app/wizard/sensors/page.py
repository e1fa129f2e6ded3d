"""Page of the sensors:

whether six or seven are on, and which is where. They are dragged onto the figure, shaken in turn, or left to the
motion.
"""

from collections.abc import Mapping, Sequence
from enum import StrEnum
from itertools import pairwise

from PySide6.QtCore import QSignalBlocker, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QHideEvent, QResizeEvent
from PySide6.QtWidgets import QBoxLayout, QHBoxLayout, QScrollArea, QVBoxLayout, QWidget

from app.theme.current import current_theme, on_theme, px, scaled
from app.theme.icons import Icon
from app.widgets.body_figure import SensorMark
from app.widgets.choice import Choice
from app.widgets.lay_out import lay_out
from app.widgets.notice import Notice
from app.widgets.segmented import Segmented
from app.widgets.sensors_progress import SensorsProgress
from app.widgets.text import SEMIBOLD, Text
from app.wizard.sensors.columns_form import ColumnsForm
from app.wizard.sensors.dot_form import DotForm
from app.wizard.sensors.memories_form import MemoriesForm
from app.wizard.sensors.sensor_list import SensorList
from app.wizard.sensors.sensor_places import PlaceShown, SensorPlaces
from app.wizard.sensors.sensor_row import SensorRow
from app.wizard.sensors.sensor_sentences import Stated, stated_of_dragged, stated_of_sensors, stated_of_shaken_together
from app.wizard.sensors.session_chooser import SessionChooser
from app.wizard.sensors.source_pages import NoSource, Searching, SourceOption
from app.wording.translation import tr
from core.body import LEG_SITES, Site
from core.samples import FloatArray

FLASH_MS = 700
OFFERED_AT_ONCE = 5  # sources that have a button of their own where there is none yet
FIGURE_WIDTH = (414, 560)  # as the window grows
USUAL_WIDTH = 1016
SCROLL_BAR = 12
WIDEST = 1400  # further apart, a row and its place on the figure no longer meet the eye together


class Way(StrEnum):
    DRAG = "drag"
    SHAKE = "shake"
    MOTION = "motion"


class SensorsPage(QWidget):
    """The figure with its sensors, the list of those found, and the source that they come from.

    `assigned`: a sensor's name, and the site it is worn at; None: nowhere. On a worn site the two change places.
    """

    assigned = Signal(str, object)
    way_chosen = Signal(str)  # a `Way`
    source_chosen = Signal(str)  # the key of a `SourceOption`

    def __init__(self) -> None:
        super().__init__()
        self._is_compact = False
        self._sensors: tuple[SensorRow, ...] = ()
        self._doubt = ""
        self._names: tuple[str, ...] = ()
        self._offered: tuple[tuple[SourceOption, ...], str] = ((), "")
        self._reported = ("", "")
        self._shaken_together: tuple[str, ...] = ()
        self._hovered: tuple[str, Site] | None = None
        self._bared: set[Site] = set()
        self._required_next: Site | None = None
        self._flashing: Site | None = None
        self._flash_end = QTimer(self)
        self._flash_end.setSingleShot(True)
        self._flash_end.setInterval(FLASH_MS)
        self.title = Text(size=26, weight=SEMIBOLD, wraps=True)
        self.subtitle = Text("", 15, tone="ink2", wraps=True)
        self._name(has_pelvis=False)
        self.sources = Choice(tr("Sensor source"))
        self.sources.setPlaceholderText(tr("Choose a source"))
        self.places = SensorPlaces()
        self.ways = Segmented(
            tr("Sensor positions"),
            [
                (Way.DRAG, tr("Drag"), tr("onto the figure")),
                (Way.SHAKE, tr("Shake"), tr("each sensor in turn")),
                (Way.MOTION, tr("Detect from movement"), tr("during free motion")),
            ],
        )
        self.list = SensorList()
        self.notice = Notice(size=16)
        self.nothing = NoSource()
        self.searching = Searching()
        self.stored = SessionChooser()
        self.columns = ColumnsForm()
        self.dots, self.memories, self.progress = DotForm(), MemoriesForm(), SensorsProgress()
        self._build()
        self._connect()
        on_theme(self._fit)
        self.show_no_source()

    @property
    def way(self) -> Way:
        return Way(self.ways.choice)

    @property
    def offered_places(self) -> tuple[Site, ...]:
        """Where sensors can be worn: the pelvis only where there is a seventh, or one was put there."""
        has_pelvis = len(self._sensors) > len(LEG_SITES) or any(one.site is Site.PELVIS for one in self._sensors)
        return tuple(Site) if has_pelvis else LEG_SITES

    @property
    def next_place(self) -> Site | None:
        """Where the sensor that is shaken next goes: the place that was pressed, or the first that is free."""
        worn = {sensor.site for sensor in self._sensors}
        if self._required_next is not None and self._required_next not in worn:
            return self._required_next
        return next((site for site in self.offered_places if site not in worn), None)

    @property
    def tab_order(self) -> list[QWidget]:
        rows = [one for row in self.list.rows.values() for one in (row, row.worn, row.identify)]
        before = [*self.nothing.buttons, self.searching.stop, *self.stored.tab_order, *self.columns.tab_order]
        before += [*self.dots.tab_order, *self.memories.tab_order, self.progress.stop]
        return [self.sources, *before, *self._tiles, *self.ways.segments, *rows]

    def focus(self) -> None:
        if self._in_sight is self.nothing and self.nothing.buttons:
            self.nothing.buttons[0].setFocus()
            self._whole.ensureWidgetVisible(self.nothing.buttons[0])
        elif isinstance(
            self._in_sight, Searching | SessionChooser | ColumnsForm | DotForm | MemoriesForm | SensorsProgress
        ):
            self._in_sight.focus()
        elif row := self.list.rows.get(self.list.selection):
            row.setFocus()

    def set_compact(self, is_compact: bool) -> None:
        """Show legs instead of the whole person, and rows without columns, where the window is small."""
        self._is_compact = is_compact
        self.ways.set_brief(is_compact)
        self.list.set_narrow(is_compact)
        self.subtitle.setVisible(not is_compact)
        self._fit()

    def set_from_behind(self, is_from_behind: bool) -> None:
        self.places.set_from_behind(is_from_behind)

    def show_sources(self, options: Sequence[SourceOption], chosen: str = "") -> None:
        """Offer what sensors can be reached through; `chosen` is the key of the one in force."""
        is_shown = self.sources.currentIndex() == self.sources.findData(chosen)
        if (is_shown and (tuple(options), chosen) == self._offered) or self.sources.view().isVisible():
            return  # in its view one is chosen now
        self._offered = (tuple(options), chosen)
        found = tr("{source}: {found}")
        lines = [(found.format(source=one.name, found=one.note) if one.note else one.name, one.key) for one in options]
        self.sources.offer(lines, chosen, otherwise=-1)
        usual = [option for option in options if not option.is_last][:OFFERED_AT_ONCE]
        self.nothing.show_options([*usual, *(option for option in options if option.is_last)])
        for before, after in pairwise(
            [self.sources, *self.nothing.buttons, self.searching.stop, *self.stored.tab_order]
        ):
            QWidget.setTabOrder(before, after)

    def show_no_source(self) -> None:
        """Say that nothing is connected, and offer the sources."""
        self._sensors = ()
        self._bared.clear()
        self._required_next = None
        self._show(self.nothing)
        self._refresh()

    def show_searching(self, source: str) -> None:
        """Say that sensors are looked for through `source`; "": wherever there may be some."""
        stated = tr("Looking for sensors: {source}").format(source=source) if source else tr("Looking for sensors")
        self.searching.begin(stated)
        self._show(self.searching)

    def show_stored(self) -> None:
        """Ask which stored session is to be replayed."""
        self._show(self.stored)

    def show_columns(self) -> None:
        """Ask what the columns of lines of numbers mean."""
        self._show(self.columns)

    def show_dots(self, is_synchronising: bool) -> None:
        """Ask which Movella DOTs are worn, or show how far they are synchronised."""
        self._show(self.progress if is_synchronising else self.dots)

    def show_memories(self, is_busy: bool) -> None:
        """Show what the sensors' memories hold, or how far that is found out, fetched or erased."""
        self._show(self.progress if is_busy else self.memories)

    def show_reading(self, session: str) -> None:
        """Say that a session is read, to be replayed."""
        self.searching.begin(tr("Reading {name}").format(name=session))
        self._show(self.searching)

    def show_sensors(self, sensors: Sequence[SensorRow], doubt: str = "") -> None:
        """Show how the sensors are; four times a second is enough. `doubt`: which positions a motion contradicts."""
        if (tuple(sensors), doubt) == (self._sensors, self._doubt) and self._in_sight is self._lists:
            return
        self._sensors, self._doubt = tuple(sensors), doubt
        self._bared -= {sensor.site for sensor in sensors if sensor.site is not None}
        self.list.show_sensors(sensors, self.offered_places)
        names = tuple(sorted(sensor.name for sensor in sensors))
        if names != self._names:
            self._names = names
            self.places.set_names(names)
            rows = [one for row in self.list.rows.values() for one in (row, row.worn, row.identify)]
            for before, after in pairwise([self.ways.segments[-1], *rows]):
                QWidget.setTabOrder(before, after)
            self._fit()
        self._show(self._lists)
        self._refresh()

    def show_traces(self, traces: Mapping[str, FloatArray]) -> None:
        """Draw how each sensor turned in the last 5 s, deg/s, oldest first; ten times a second is enough."""
        if self._in_sight is self._lists:
            self.list.show_traces(traces)

    def show_way(self, way: Way) -> None:
        with QSignalBlocker(self.ways):
            self.ways.choose(way)
        self._refresh()

    def show_shaken(self, sensor: str) -> None:
        """Take the shaken sensor for the place that is next, if it has none yet; flash the place it has then."""
        self._shaken_together = ()
        known = next((one for one in self._sensors if one.name == sensor), None)
        if known is None:
            return
        self.list.select(sensor)
        site = known.site or self.next_place
        self._flash(site)
        if known.site is None and site is not None and self.way is Way.SHAKE:
            self._required_next = None
            self.assigned.emit(sensor, site)
        self._refresh()

    def show_shaken_together(self, sensors: Sequence[str]) -> None:
        """Say that several were shaken at once, which shows nothing; none takes it back."""
        if tuple(sensors) != self._shaken_together:
            self._shaken_together = tuple(sensors)
            self._refresh()

    def show_message(self, what: str, then: str = "") -> None:
        """Say what happened and what to do, before anything the page would say itself; "" takes it back."""
        if (what, then) != self._reported:
            self._reported = (what, then)
            self._refresh()

    def place_selected(self, number: int) -> bool:
        """Wear the selected sensor at place 1 to 7; returns whether there is such a place and a sensor."""
        if not self.list.selection or not 1 <= number <= len(Site) or self._in_sight is not self._lists:
            return False
        self.assign(self.list.selection, list(Site)[number - 1])
        return True

    def identify_selected(self) -> bool:
        """Light the LED of the selected sensor; returns whether it has one."""
        row = self.list.rows.get(self.list.selection)
        if row is None or not row.sensor.can_identify or self._in_sight is not self._lists:
            return False
        self.list.identify_pressed.emit(row.name)
        return True

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._fit()

    def hideEvent(self, event: QHideEvent) -> None:
        super().hideEvent(event)
        self._flash_end.stop()
        self._end_flash()

    @property
    def _tiles(self) -> list[QWidget]:
        return list(self.places.shown_tiles.values())

    def _build(self) -> None:
        words = lay_out(QVBoxLayout(), self.title, self.subtitle, spacing=4)
        sources = (self.sources, 0, Qt.AlignmentFlag.AlignVCenter)
        head = lay_out(QHBoxLayout(), (words, 1), sources, spacing=16)
        self._rows = _Scroll(self.list)
        beside = lay_out(QVBoxLayout(), self.ways, (self._rows, 1), self.notice, spacing=8)
        self._lists = QWidget()
        self._body = QBoxLayout(QBoxLayout.Direction.LeftToRight, self._lists)
        lay_out(self._body, self.places, (beside, 1), margins=0)
        content = QWidget()
        self._column = lay_out(QVBoxLayout(content), head, spacing=16)
        self._in_sight: QWidget = self.nothing
        asking = self.searching, self.stored, self.columns, self.dots, self.memories, self.progress
        for page in (self.nothing, *asking, self._lists):  # not stacked: each would ask room for all
            self._column.addWidget(page, 1)
            page.setVisible(page is self.nothing)
        self._whole = _Scroll(content)
        lay_out(QVBoxLayout(self), self._whole, margins=0)
        scaled(self.notice.setMinimumHeight, 66)

    def _connect(self) -> None:
        self.sources.activated.connect(self._on_source_activated)
        self.nothing.chosen.connect(self.source_chosen)
        self.ways.chosen.connect(self._on_way_chosen)
        self.places.dropped.connect(self.assign)
        self.places.hovered.connect(self._on_hovered)
        self.places.pressed.connect(self._on_place_pressed)
        self.list.assigned.connect(self.assign)
        self.list.selected.connect(self._on_selected)
        self._flash_end.timeout.connect(self._end_flash)

    def _show(self, page: QWidget) -> None:
        """Change over to `page`; a focus that was on the page before goes on with it."""
        if page is not self._in_sight:
            had_focus = self._in_sight.isAncestorOf(self.focusWidget() or self)
            self._in_sight.hide()
            self._in_sight = page
            page.show()
            if had_focus:
                self.focus()

    def assign(self, sensor: str, site: Site | None) -> None:
        before = next((one.site for one in self._sensors if one.name == sensor), None)
        if site is None and before is not None:
            self._bared.add(before)
        self._required_next = None
        self._reported, self._shaken_together = ("", ""), ()
        if site != before:
            self.assigned.emit(sensor, site)
        self._refresh()

    def _flash(self, site: Site | None) -> None:
        self._flashing = site
        if site is not None and self.isVisible():
            self._flash_end.start()

    def _end_flash(self) -> None:
        if self._flashing is not None:
            self._flashing = None
            self._refresh()

    def _refresh(self) -> None:
        """Show the places and the one sentence that matters most."""
        worn = {sensor.site: sensor for sensor in self._sensors if sensor.site is not None}
        places = self.offered_places
        if self.places.has_pelvis is not (Site.PELVIS in places):
            self._name(has_pelvis=Site.PELVIS in places)
        self.places.show_places({site: self._place(site, worn.get(site)) for site in places})
        self.notice.show_message(*self._sentence(worn))
        self.nothing.show_message(*self._reported)

    def _place(self, site: Site, sensor: SensorRow | None) -> PlaceShown:
        is_next = self.way is Way.SHAKE and bool(self._sensors) and site is self.next_place
        is_flashing = site is self._flashing
        if sensor is None:
            note = tr("shake it now") if is_next else tr("detected later") if self.way is Way.MOTION else ""
            mark = None if self.way is Way.MOTION else SensorMark.GAP
            return PlaceShown("", note, mark, is_next, is_flashing)
        if sensor.silent_s > 0:
            return PlaceShown(sensor.name, tr("no signal"), SensorMark.SILENT, is_next, is_flashing)
        if sensor.is_low:
            return PlaceShown(sensor.name, tr("charge"), SensorMark.LOOK, is_next, is_flashing)
        if sensor.is_lossy:
            return PlaceShown(sensor.name, tr("data loss"), SensorMark.LOOK, is_next, is_flashing)
        return PlaceShown(sensor.name, "", SensorMark.WORN, is_next, is_flashing)

    def _sentence(self, worn: Mapping[Site, SensorRow]) -> Stated:
        """What is so and what to do: the most urgent of all that could be stated."""
        if self._reported[0]:
            return Icon.WARNING, *self._reported, True
        if self._hovered is not None:
            return stated_of_dragged(*self._hovered, worn)
        if self._shaken_together:
            return stated_of_shaken_together(self._shaken_together)
        if self._doubt:
            return (
                Icon.WARNING,
                self._doubt,
                tr("Change the sensor positions, or continue with the current ones."),
                True,
            )
        next_place = self.next_place if self.way is Way.SHAKE else None
        is_left_to_motion = self.way is Way.MOTION
        return stated_of_sensors(self._sensors, worn, self._bared, next_place, is_left_to_motion, self.offered_places)

    def _name(self, has_pelvis: bool) -> None:
        """Say how many sensors there are, and where they go."""
        six, seven = tr("Six sensors, any orientation"), tr("Seven sensors, any orientation")
        legs = tr("Strap the sensors to thigh, shank and foot. Orientation does not matter.")
        pelvis = tr(
            "Strap the sensors to thigh, shank, foot and sacrum, not to a waistband. Orientation does not matter."
        )
        self.title.setText(seven if has_pelvis else six)
        self.subtitle.setText(pelvis if has_pelvis else legs)

    def _fit(self) -> None:
        """Lay figure and list side by side while both have room."""
        px = current_theme().px
        side = max(px(24), (self.width() - px(WIDEST)) // 2)
        above = px(12 if self._is_compact else 20)
        self._column.setContentsMargins(side, above, side, above)
        room = self.width() - 2 * side
        self.columns.set_room(room)
        self.dots.set_room(room, is_narrow=self._is_compact)
        self.places.set_narrow(self._is_compact)
        figure, rows = self.places.least_width, self.list.minimumWidth()
        rows = max(rows + px(SCROLL_BAR), self.ways.minimumSizeHint().width())
        gap = px(12 if self._is_compact else 16)
        self._body.setSpacing(gap)
        is_stacked = figure + gap + rows > room
        way = QBoxLayout.Direction.TopToBottom if is_stacked else QBoxLayout.Direction.LeftToRight
        self._body.setDirection(way)
        if is_stacked:
            self.places.set_narrow(True)
            self.places.setMinimumWidth(0)  # the bar that scrolls both takes of the room
            self.places.setMaximumWidth(max(0, room))
        elif self._is_compact:
            spare = max(0, room - gap - rows - figure)
            self.places.setFixedWidth(min(figure + spare // 2, max(figure, px(FIGURE_WIDTH[0]))))
        else:
            usual, widest = FIGURE_WIDTH
            grown = px(usual) + max(0, room - px(USUAL_WIDTH)) // 2
            self.places.setFixedWidth(max(figure, min(grown, px(widest), room - gap - rows)))
        self._rows.setMinimumHeight(self.list.minimumSizeHint().height() if is_stacked else 0)
        self._body.invalidate()  # of a width that is changed while Qt lays out it does not always hear
        self._body.activate()

    def _on_source_activated(self, index: int) -> None:
        self.source_chosen.emit(self.sources.itemData(index))

    def _on_way_chosen(self, way: str) -> None:
        self._shaken_together = ()
        self._refresh()
        self.way_chosen.emit(way)

    def _on_hovered(self, sensor: str, site: Site | None) -> None:
        self._hovered = (sensor, site) if site is not None else None
        self._refresh()

    def _on_place_pressed(self, site: Site) -> None:
        """While shaking, the place that is pressed is next; else it takes the selected sensor."""
        is_worn = any(sensor.site is site for sensor in self._sensors)
        if self.way is Way.SHAKE and not is_worn:
            self._required_next = site
            self._refresh()
        elif self.list.selection:
            self.assign(self.list.selection, site)

    def _on_selected(self, name: str) -> None:
        """Bring the row into sight that keys mean now."""
        row = self.list.rows.get(name)
        if row is not None:
            margin = px(8)
            self._rows.ensureWidgetVisible(row, 0, margin)
            self._whole.ensureWidgetVisible(row, 0, margin)


class _Scroll(QScrollArea):
    """Takes the room that is left and asks for none."""

    def __init__(self, content: QWidget) -> None:
        super().__init__()
        self.setWidgetResizable(True)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setWidget(content)

    def sizeHint(self) -> QSize:
        return self.minimumSizeHint()
