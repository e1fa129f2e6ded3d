"""Six sensors on, or seven, and each known: found through a source, and stated where it is worn."""

from dataclasses import replace
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject

from app.theme.icons import Icon
from app.widgets.action_bar import BarAction, BarState
from app.widgets.battery import LOW
from app.widgets.rail_row import StepState
from app.widgets.sensor_tile import SILENT_FROM_S
from app.wizard.keys import Intent, KeyAction
from app.wizard.sensors.columns_telling import ColumnsTelling
from app.wizard.sensors.dot_setup import DotSetup
from app.wizard.sensors.estimator import PlacingEstimator
from app.wizard.sensors.memories_control import MemoriesControl
from app.wizard.sensors.page import SensorsPage, Way
from app.wizard.sensors.replays import StoredReplay
from app.wizard.sensors.sensor_row import SensorRow
from app.wizard.sensors.source_pages import SourceOption
from app.wizard.sensors.sources import SEARCH, WITH_PELVIS
from app.wizard.sensors.trace_values import TRACE_S, TraceValues
from app.wizard.step import Step, StepId
from app.wizard.worn_sensors import SourceChoice
from app.wording.body import name_of
from app.wording.translation import tr
from core.body import LEG_JOINTS, LEG_SITES, Site

if TYPE_CHECKING:
    from app.acquisition.acquisition import SensorStatus
    from app.wizard.visit import Visit

REPLAY = "replay"
REMEMBERED_LOOKS = 4  # a second: time to see who wears what
TRACE_TICKS, ROW_TICKS = 3, 8  # of 30 a second: traces ten times a second, rows and sources four times


class SensorsStep(Step):
    """The library is informed of who wears what when the step is left, and only if that is news."""

    id = StepId.SENSORS

    def __init__(self, visit: "Visit", parent: QObject | None = None) -> None:
        super().__init__(visit, parent)
        self._page: SensorsPage | None = None
        self._estimator: PlacingEstimator | None = None
        self._shakes = self._ticks = 0
        self._is_in_sight = False
        self._required: dict[str, Site] = {}  # where sensors go that are being looked for again
        self._without_light: set[str] = set()
        self._traces = TraceValues()
        self._silent_site: Site | None = None
        self._is_source_awaited = self._has_gone_on = False
        self._remembered_looks = 0  # in a row at which all sensors of the last visit were received
        self._reported_of = ""  # the choice of which it was stated whom it asks on the network
        self.telling = ColumnsTelling(self)
        self.telling.changed.connect(self.changed)
        self.setup = DotSetup(visit.sensors, self)
        self.setup.changed.connect(self._on_changed)
        self.setup.ready.connect(visit.sensors.search)
        self.setup.left.connect(self._on_asking_left)
        self.memories = MemoriesControl(visit, self)
        self.memories.changed.connect(self._on_changed)
        self.memories.left.connect(self._on_memories_left)
        self.stored = StoredReplay(visit, self)
        self.stored.changed.connect(self._on_changed)
        self.stored.read.connect(self._on_stored_read)
        self.stored.left.connect(self._on_asking_left)
        visit.sensors.changed.connect(self._on_changed)
        visit.sensors.opened.connect(self._on_opened)
        visit.sensors.set_up_required.connect(self._on_source_chosen)

    @property
    def page(self) -> SensorsPage:
        if self._page is None:
            page = self._page = SensorsPage()
            page.assigned.connect(self._visit.sensors.assign)
            page.way_chosen.connect(self._on_way_chosen)
            page.source_chosen.connect(self._on_source_chosen)
            page.list.identify_pressed.connect(self._on_identify_pressed)
            page.list.reconnect_pressed.connect(self._reconnect)
            page.searching.stop.clicked.connect(self._on_stop_pressed)
            page.columns.back.clicked.connect(self._on_asking_left)
            self.stored.show_on(page.stored)
            self.setup.show_on(page.dots, page.progress)
            self.memories.show_on(page.memories, page.progress)
        return self._page

    @property
    def title(self) -> str:
        return tr("Sensors")

    @property
    def note(self) -> str:
        sensors = self._visit.sensors
        if sensors.acquisition is None:
            return ""
        if self._visit.cannot_record:
            return tr("not for this patient")
        if sensors.is_left_to_motion and not sensors.site_of:
            return tr("from free motion")
        if sensors.detected:
            return tr("positions look swapped")
        return tr("{count} of {most} assigned").format(count=len(sensors.site_of), most=len(sensors.places))

    @property
    def state(self) -> StepState:
        sensors = self._visit.sensors
        if sensors.acquisition is None:
            return StepState.TODO
        if self._silent_site is not None or self._visit.cannot_record or sensors.detected:
            return StepState.ATTENTION
        return StepState.DONE if sensors.joints or sensors.is_left_to_motion else StepState.TODO

    @property
    def cannot_enter(self) -> str:
        patient = self._visit.patient
        if patient.stored is not None:
            return ""
        return (
            tr("Press Enter to save the patient first.")
            if patient.details.code
            else tr("Enter the patient's code first.")
        )

    @property
    def cannot_leave(self) -> str:
        return self.setup.cannot_leave or self.memories.cannot_leave

    @property
    def topic(self) -> str:
        return "sensors-movella-dot" if self.setup.is_on else "sensors"

    def enter(self) -> None:
        self._is_in_sight = True
        self._visit.record.begin()
        self._begin_estimator()
        self._is_source_awaited = bool(self._visit.placement_before) and self._visit.sensors.acquisition is None
        self._remembered_looks = 0
        self._show()
        self.page.focus()

    def leave(self) -> None:
        self._end_asking()
        self._is_in_sight = False
        self._reported_of = ""
        sensors = self._visit.sensors
        sensors.keep_labels()  # somebody has looked at them
        sensors.sync.forget()
        if sensors.acquisition is not None:
            sensors.acquisition.set_estimator(None)
        self._estimator = None
        if sensors.site_of and sensors.site_of != self._known_places and not self._visit.cannot_record:
            self._take_places()

    def _take_places(self) -> None:
        """Other places of the same sensors: entered wrongly; another sensor at a place: strapped on since."""
        visit, worn, known = self._visit, self._visit.sensors.site_of, self._known_places
        known_at, worn_at = {site: name for name, site in known.items()}, visit.sensors.sensor_at
        if not visit.recordings.since_strapped:
            visit.place_sensors()
        elif worn.keys() == known.keys():
            visit.worn.place_as_stated_now()
            for joint in visit.details.turned_sign:  # stated by hand of other sensors
                if any(known_at.get(site) != worn_at.get(site) for site in (joint.proximal, joint.distal)):
                    visit.record.set_turned(joint, None)
            what = tr("Sensor positions changed. Standing reference and calibration are calculated again.")
            self.reported.emit(what, tr("If sensors were moved on the body, record standing and free motion again."))
        else:
            visit.place_sensors()
            if any(known_at.get(site, name) != name for name, site in worn.items()):
                visit.recordings.say_restrapped()
                what = tr("Another sensor is worn. Standing reference and calibration are no longer valid.")
                self.reported.emit(what, tr("Record standing and free motion again."))

    def tick(self) -> None:
        self._ticks += 1
        if self._ticks % ROW_TICKS == 0:
            self._show_sources()  # a search beside the screen may have found some
            self.telling.tick()
            self._open_last_source()
        if self._visit.sensors.acquisition is None or self._is_asking:
            return
        if self._estimator is not None:
            state = self._estimator.state
            if state.shakes != self._shakes:
                self._shakes = state.shakes
                if state.shaken is not None:
                    self.page.show_shaken(state.shaken)
            self.page.show_shaken_together(state.shaken_together)
        if self._ticks % TRACE_TICKS == 0:
            self._show_traces()
        if self._ticks % ROW_TICKS == 0:
            self._show_rows()
            self._go_on_with_remembered()

    def _open_last_source(self) -> None:
        """Open the source of the last visit where its set-up is used again, as soon as it is found."""
        key, sensors = self._visit.source_before, self._visit.sensors
        is_free = not (self._is_asking or sensors.is_searching) and sensors.acquisition is None
        if self._is_source_awaited and is_free and key in {one.key for one in self._visit.choices}:
            self._on_source_chosen(key)

    def _go_on_with_remembered(self) -> None:
        """Leave the page by itself once all remembered sensors were received for a while, but only once."""
        self._remembered_looks = self._remembered_looks + 1 if self._are_all_remembered else 0
        if self._remembered_looks >= REMEMBERED_LOOKS and not self._has_gone_on:
            self._has_gone_on = True
            self.done.emit()

    @property
    def _are_all_remembered(self) -> bool:
        sensors, before = self._visit.sensors, self._visit.placement_before
        if not before or sensors.site_of != before or sensors.are_loose or sensors.detected:
            return False
        received = sensors.status
        if not before.keys() <= received.keys():
            return False
        bar, status = self._of_open(), [received[name] for name in before]
        is_whole = bar.primary is not None and bar.primary.is_enabled and bar.primary.is_requested and not bar.note
        is_charged = all(one.details.battery is None or one.details.battery >= LOW for one in status)
        return is_whole and is_charged and all(one.silent_s < SILENT_FROM_S and one.received_hz > 0 for one in status)

    def bar(self) -> BarState:
        if self.telling.is_on:
            is_whole = self.telling.columns is not None
            use = BarAction(tr("Use these columns"), self._use_columns, tr("Enter"), is_enabled=is_whole)
            return BarState(primary=use)
        if self.setup.is_on or self.setup.is_synchronising:
            return self.setup.bar()
        if self.memories.is_on:
            return self.memories.bar()
        if self.stored.is_on:
            return self.stored.bar()
        quiet = (BarAction(tr("Sensor memory"), self.memories.begin),) if self._may_ask_memories else ()
        return replace(self._of_open(), quiet=quiet)

    def _of_open(self) -> BarState:
        """What can be done with the sensors that are open, or why the session cannot go on with them yet."""
        sensors, silent, enter = self._visit.sensors, self._silent_site, tr("Enter")
        if sensors.are_in_memory:
            back = BarAction(tr("Send data live"), self.setup.set_back, enter, is_requested=False)
            return BarState(primary=back, note=tr("The sensors are ready to record walks. They send no live data."))
        if sensors.acquisition is None:
            return BarState(note="" if sensors.is_searching else tr("Choose where to search for sensors."))
        if reason := self._visit.cannot_record:
            other = BarAction(tr("Choose other sensors"), self._choose_others, enter, Icon.REPEAT)
            words = tr("Start with a demonstration patient")
            demonstration = BarAction(words, self.demonstration_required.emit, is_requested=False)
            return BarState(primary=other, others=(demonstration,), note=reason)
        go_on = BarAction(tr("Stand still"), self.done.emit, enter)
        if silent is not None:
            words = tr("Reconnect {site}").format(site=name_of(silent))
            again = BarAction(words, self._reconnect, enter, Icon.REPEAT)
            joints = (*LEG_JOINTS, *sensors.hips)
            lost = tr(" and ").join(name_of(one) for one in joints if silent in (one.proximal, one.distal))
            without = replace(go_on, text=tr("Go on without {joints}").format(joints=lost), key="", is_requested=False)
            return BarState(primary=again, others=(without,) if sensors.joints else ())
        if sensors.is_left_to_motion:
            return BarState(primary=go_on, note=tr("Sensor positions are detected in the free motion."))
        if not sensors.joints:
            note = tr("Two sensors at one joint are needed: thigh and shank, or shank and foot.")
            return BarState(primary=replace(go_on, is_enabled=False), note=note)
        is_whole = set(LEG_SITES) <= sensors.sensor_at.keys()  # a pelvis is for whoever wants hips
        return BarState(primary=replace(go_on, is_requested=is_whole), note=sensors.price_of_missing())

    @property
    def _is_asking(self) -> bool:
        """Whether something is shown in place of the sensors that are open, or that are to be."""
        is_of_dots = self.setup.is_on or self.setup.is_synchronising or self.memories.is_on
        return is_of_dots or self.telling.is_on or self.stored.is_on

    @property
    def _may_ask_memories(self) -> bool:
        is_free = self._visit.recordings.ongoing is None and self._visit.session is not None
        return self._visit.sensors.dots is not None and is_free and not self._is_asking

    def on_intent(self, intent: Intent) -> bool:
        if intent.action is KeyAction.LABEL:
            return self.page.place_selected(intent.number)
        if intent.action is KeyAction.IDENTIFY and self.setup.is_on:
            return self.setup.identify_selected()
        if intent.action is KeyAction.IDENTIFY:
            return self.page.identify_selected()
        return False

    @property
    def _known_places(self) -> dict[str, Site]:
        """Site by the sensor's name, as it was last passed to the library in this session."""
        session = self._visit.session
        return session.placements[-1].site_of if session is not None and session.placements else {}

    def _begin_estimator(self) -> None:
        """Let the estimator's thread listen for shaken sensors while the step is in sight."""
        acquisition = self._visit.sensors.acquisition
        if acquisition is None or not self._is_in_sight:
            return
        self._estimator, self._shakes = PlacingEstimator(acquisition.sensors), 0
        acquisition.set_estimator(self._estimator)

    def _show(self) -> None:
        self._show_sources()
        sensors, page = self._visit.sensors, self.page
        if self.stored.reading:
            page.show_reading(self.stored.reading)
        elif sensors.is_searching and sensors.choice is not None:
            page.show_searching("" if sensors.choice.key == SEARCH else sensors.choice.name)
        elif self.telling.is_on:
            page.show_columns()
        elif self.setup.is_on or self.setup.is_synchronising:
            page.show_dots(self.setup.is_synchronising)
        elif self.memories.is_on:
            page.show_memories(self.memories.is_busy)
        elif self.stored.is_on:
            page.show_stored()
        elif sensors.acquisition is None:
            page.show_no_source()
        else:
            if sensors.is_left_to_motion != (page.way is Way.MOTION):
                page.show_way(Way.MOTION if sensors.is_left_to_motion else Way.DRAG)
            self._show_rows()

    def _show_sources(self) -> None:
        """Offer what there is for this patient: what was found, what is simulated, and what is played at the moment."""
        visit, sensors = self._visit, self._visit.sensors
        options = [SourceOption(one.key, one.name, is_last=one.key == WITH_PELVIS) for one in visit.choices]
        if visit.may_simulate:
            options.append(SourceOption(REPLAY, tr("Replay of a stored session")))
        chosen = sensors.choice or self.setup.choice
        if chosen is not None:
            found = len(sensors.acquisition.sensors) if sensors.acquisition is not None else 0
            note = tr("{count} found").format(count=found) if found else ""
            keys = [option.key for option in options]
            at = keys.index(chosen.key) if chosen.key in keys else len(options)
            options[at : at + 1] = [SourceOption(chosen.key, chosen.name, note, chosen.key == WITH_PELVIS)]
        options.sort(key=lambda option: option.is_last)
        page = self.page
        page.show_sources(options, chosen.key if chosen is not None else "")
        asks = next((choice.asks for choice in visit.choices if choice.key == self._reported_of), ("", ""))
        if not self.setup.is_on and sensors.sync.failure[0]:
            asks = sensors.sync.failure
        page.show_message(*asks if options else (tr("No sensor source is available for this patient."), ""))
        apart = tr(
            "Simulated and replayed sensors are offered only for patient codes that begin with DEMO. This "
            "keeps their data apart from real patients."
        )
        page.nothing.show_left_out("" if visit.may_simulate else apart)

    def _show_rows(self) -> None:
        sensors = self._visit.sensors
        acquisition = sensors.acquisition
        if acquisition is None:
            return
        status = sensors.status
        rows = tuple(self._row(status[name]) for name in acquisition.sensors if name in status)
        self.page.show_sensors(rows, sensors.doubt_in_words()[0] if sensors.detected else "")
        silent = next((row.site for row in rows if row.silent_s > 0 and row.site is not None), None)
        if silent is not self._silent_site:
            self._silent_site = silent
            self.changed.emit()

    def _row(self, status: "SensorStatus") -> SensorRow:
        is_silent = status.silent_s >= SILENT_FROM_S
        return SensorRow(
            name=status.sensor,
            model=status.details.model,
            rate_hz=status.details.rate_hz or float(round(status.received_hz)),
            battery=status.details.battery,
            site=self._visit.sensors.site_of.get(status.sensor),
            silent_s=float(round(status.silent_s)) if is_silent else 0.0,
            lost_share=round(status.lost_share, 3),
            can_identify=status.sensor not in self._without_light,
            quiet=status.details.quiet,
            is_loss_seen=status.details.is_loss_seen,
            has_memory=self._visit.sensors.dots is not None,
        )

    def _show_traces(self) -> None:
        acquisition = self._visit.sensors.acquisition
        if acquisition is None:
            return
        now_s = acquisition.now_s
        latest = (acquisition.latest(name, TRACE_S) for name in acquisition.sensors)
        self.page.show_traces(self._traces.of(latest, now_s))

    def _reconnect(self) -> None:
        """Open the source again; its sensors come back to their places."""
        sensors = self._visit.sensors
        if sensors.choice is None:
            return
        self._required = dict(sensors.site_of)
        if sensors.choice.make_fleet is not None:
            self._set_up(sensors.choice)
        else:
            sensors.search(sensors.choice)

    def _on_opened(self) -> None:
        sensors = self._visit.sensors
        assert sensors.acquisition is not None
        reported = sensors.choice.worn if sensors.choice is not None else {}
        for required in (self._required or self._known_places or self._visit.placement_before, reported):
            known = {name: site for name, site in required.items() if name in sensors.acquisition.sensors}
            if known:
                sensors.assign_all(known)
                break
        self._required = {}
        self._begin_estimator()
        if self._is_in_sight:
            self._show()
            self.page.focus()

    def _on_changed(self) -> None:
        if self._is_in_sight:
            self._show()
        self.changed.emit()

    def _on_way_chosen(self, way: str) -> None:
        is_left = way == Way.MOTION
        if is_left != self._visit.sensors.is_left_to_motion:
            self._visit.sensors.leave_to_motion(is_left)

    def _on_source_chosen(self, key: str) -> None:
        if self.memories.is_busy:  # what is fetched or erased is not left by accident
            self.reported.emit(self.memories.cannot_leave, "")
            self._show_sources()
            return
        self._is_source_awaited = False
        sensors = self._visit.sensors
        known = (*self._visit.choices, *([sensors.choice] if sensors.choice is not None else []))
        choice = next((one for one in known if one.key == key), None)
        if choice is None and key != REPLAY:
            return
        is_reported, self._reported_of = key == self._reported_of, ""
        self._end_asking()
        if choice is None:
            self.stored.begin()
            self._show_asked()
        elif any(choice.asks) and not is_reported:
            self._reported_of = key
            sensors.close()
            self._on_changed()
        elif choice.lines:
            sensors.close()  # they may be at the same ports
            self.telling.begin(self.page.columns, choice.lines)
            self._show_asked()
        elif choice.make_fleet is not None:
            self._set_up(choice)
        else:
            sensors.search(choice)

    def _end_asking(self) -> None:
        """Let go of all that is shown in place of the sensors, or would come there once it is read."""
        self.stored.end()
        self.telling.end()
        self.setup.end()
        self.memories.end()

    def _set_up(self, choice: SourceChoice) -> None:
        """Ask of Movella DOTs which are worn, and synchronise them."""
        self._visit.sensors.close()
        known = self._required or self._known_places or self._visit.placement_before
        self.setup.begin(choice, known.keys())
        self._show_asked()

    def _show_asked(self) -> None:
        """Show what is asked now, or the sensors again, with the focus in it."""
        self._show()
        self.page.focus()
        self.changed.emit()

    def _on_asking_left(self) -> None:
        """Other sources are asked for than those in question."""
        self._end_asking()
        self._show_asked()

    def _on_memories_left(self, was_live: bool) -> None:
        if was_live:
            self.setup.set_back()
        self._show_asked()

    def _choose_others(self) -> None:
        self._on_stop_pressed()
        self.page.focus()

    def _use_columns(self) -> None:
        """Remember what is entered, and search again: all that is known is found then."""
        try:
            self.telling.keep()
        except OSError as problem:
            self.reported.emit(tr("The column settings could not be saved."), str(problem))
            return
        self._on_source_chosen(SEARCH)

    def _on_stop_pressed(self) -> None:
        if self.stored.reading:
            self.stored.stop_reading()
        else:
            self._visit.sensors.close()
        self._on_changed()

    def _on_stored_read(self, choice: SourceChoice) -> None:
        if self._is_in_sight:
            self._visit.sensors.search(choice)

    def _on_identify_pressed(self, sensor: str) -> None:
        acquisition = self._visit.sensors.acquisition
        if acquisition is not None and not acquisition.identify(sensor):
            self._without_light.add(sensor)
            self.reported.emit(
                tr("{sensor} has no LED that can be lit.").format(sensor=sensor), tr("Shake the sensor instead.")
            )
            self._show_rows()
