"""Six sensors on, or seven, and each known: heard through a source, and told where they are worn."""

import datetime
from dataclasses import replace
from enum import Enum, auto
from pathlib import Path
from typing import TYPE_CHECKING
from uuid import UUID

import numpy as np
from PySide6.QtCore import QObject
from PySide6.QtWidgets import QFileDialog

from app.icons import Icon
from app.pages.home_lists import PatientLine
from app.patient_words import when
from app.theme import ThemeNotifier
from app.widgets.action_bar import BarAction, BarState
from app.widgets.folder_dialog import ask_for_folder
from app.widgets.rail_row import StepState
from app.widgets.sensor_tile import SILENT_FROM_S
from app.wizard.keys import Intent, KeyAction
from app.wizard.sensors.columns_telling import ColumnsTelling
from app.wizard.sensors.dot_setup import DotSetup
from app.wizard.sensors.estimator import PlacingEstimator
from app.wizard.sensors.memories_control import MemoriesControl
from app.wizard.sensors.page import SensorsPage, Way
from app.wizard.sensors.replays import Replays
from app.wizard.sensors.sensor_row import SensorRow
from app.wizard.sensors.source_pages import SourceOption
from app.wizard.sensors.sources import SEARCH, WITH_PELVIS
from app.wizard.step import Step
from app.wizard.worn_sensors import SourceChoice
from app.wording import name_of, tr, tr_n
from core.body import LEG_JOINTS, LEG_SITES, Site
from core.samples import FloatArray, ImuBlock

if TYPE_CHECKING:
    from app.acquisition.acquisition import SensorStatus
    from app.storage.stored import SessionSummary
    from app.wizard.visit import Visit

REPLAY = "replay"
TRACE_TICKS, ROW_TICKS = 3, 8  # of 30 a second: traces ten times a second, rows and sources four times
TRACE_S, TRACE_POINTS = 5.0, 250
TURNS_MORE = 2.0  # times the variance that another axis needs before the trace goes over to it


class SensorsShown(Enum):
    """What the step asks about, while the source it has goes on sending."""

    NOTHING = auto()  # another step is in sight
    SOURCE = auto()  # the source, and who wears which of its sensors
    STORED = auto()  # which stored session is to be replayed


class SensorsStep(Step):
    """The library is told who wears what when the step is left, and only if that is news."""

    def __init__(self, look: ThemeNotifier, visit: "Visit", parent: QObject | None = None) -> None:
        super().__init__(look, visit, parent)
        self._page: SensorsPage | None = None
        self._estimator: PlacingEstimator | None = None
        self._shakes = self._ticks = 0
        self._asks = SensorsShown.NOTHING
        self._wanted: dict[str, Site] = {}  # where sensors go that are being looked for again
        self._without_light: set[str] = set()
        self._axis: dict[str, int] = {}  # which of a sensor's axes its trace shows
        self._silent_site: Site | None = None
        self._told_of = ""  # the choice of which it was said whom it asks on the network
        self._names: dict[UUID, str] = {}  # of stored sessions
        self.dialog: QFileDialog | None = None
        self.telling = ColumnsTelling(self)
        self.telling.changed.connect(self.changed)
        self.setup = DotSetup(visit.sensors, self)
        self.setup.changed.connect(self._on_setup_changed)
        self.setup.ready.connect(visit.sensors.search)
        self.setup.left.connect(self._on_setup_left)
        self.memories = MemoriesControl(visit, self)
        self.memories.changed.connect(self._on_setup_changed)
        self.memories.left.connect(self._on_memories_left)
        self._replays = Replays(visit.controller, self)
        self._replays.listed.connect(self._on_listed)
        self._replays.read.connect(self._on_replay_read)
        self._replays.refused.connect(self._on_replay_refused)
        visit.sensors.changed.connect(self._on_sensors_changed)
        visit.sensors.opened.connect(self._on_opened)
        visit.sensors.set_up_wanted.connect(self._on_source_chosen)

    @property
    def page(self) -> SensorsPage:
        if self._page is None:
            page = self._page = SensorsPage(self._look)
            page.assigned.connect(self._visit.sensors.assign)
            page.way_chosen.connect(self._on_way_chosen)
            page.source_chosen.connect(self._on_source_chosen)
            page.identify_pressed.connect(self._on_identify_pressed)
            page.reconnect_pressed.connect(self._on_reconnect_pressed)
            page.stop_pressed.connect(self._on_stop_pressed)
            page.stored.chosen.connect(self.changed)
            page.stored.opened.connect(self._replay)
            page.stored.folder_pressed.connect(self._choose_folder)
            page.stored.back_pressed.connect(self._on_stored_left)
            page.columns.back_pressed.connect(self._on_columns_left)
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
            return tr("left to the motion")
        return tr("{count} of {most} worn").format(count=len(sensors.site_of), most=len(sensors.places))

    @property
    def state(self) -> StepState:
        sensors = self._visit.sensors
        if sensors.acquisition is None:
            return StepState.TODO
        if self._silent_site is not None or self._visit.cannot_record:
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
            else tr("Type the patient's code first.")
        )

    @property
    def cannot_leave(self) -> str:
        return self.setup.cannot_leave or self.memories.cannot_leave

    @property
    def topic(self) -> str:
        return "sensors-movella-dot" if self.setup.is_on else "sensors"

    def enter(self) -> None:
        self._asks = SensorsShown.SOURCE
        self._visit.record.begin()
        self._begin_estimator()
        self._show()
        self.page.focus()

    def leave(self) -> None:
        self._end_asking()
        self._asks = SensorsShown.NOTHING
        self._told_of = ""
        sensors = self._visit.sensors
        sensors.sync.forget()
        if sensors.acquisition is not None:
            sensors.acquisition.set_estimator(None)
        self._estimator = None
        if sensors.site_of and sensors.site_of != self._known_places and not self._visit.cannot_record:
            # other places of the same sensors: they were told wrongly; other sensors: strapped on since
            if self._visit.recordings.since_strapped and sensors.site_of.keys() == self._known_places.keys():
                self._visit.worn.place_as_said_now()
            else:
                self._visit.place_sensors()

    def tick(self) -> None:
        self._ticks += 1
        if self._ticks % ROW_TICKS == 0:
            self._show_sources()  # a search beside the screen may have found some
            self.telling.tick()
        if self._visit.sensors.acquisition is None or self._is_choosing or self._replays.reading or self._is_asking:
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

    def bar(self) -> BarState:
        bar = self._bar()
        return replace(bar, quiet=(BarAction(tr("Sensors' memories")),)) if self._may_ask_memories else bar

    @property
    def _is_asking(self) -> bool:
        """Whether something stands in the place of the sensors that are open, or that are to be."""
        return self.telling.is_on or self.setup.is_on or self.setup.is_synchronising or self.memories.is_on

    @property
    def _may_ask_memories(self) -> bool:
        is_free = self._visit.recordings.ongoing is None and self._visit.session is not None
        return self._visit.sensors.dots is not None and is_free and not self._is_asking and not self._is_choosing

    def _bar(self) -> BarState:
        sensors = self._visit.sensors
        if self._replays.reading:
            return BarState()
        if self.telling.is_on:
            is_whole = self.telling.columns is not None
            return BarState(primary=BarAction(tr("Use these columns"), tr("Enter"), is_enabled=is_whole))
        if self.setup.is_on or self.setup.is_synchronising:
            return self.setup.bar()
        if self.memories.is_on:
            return self.memories.bar()
        if self._is_choosing:
            is_any = self.page.stored.session is not None
            return BarState(primary=BarAction(tr("Replay it"), tr("Enter"), Icon.PLAY, is_enabled=is_any))
        go_on = tr("Stand still")
        if sensors.are_in_memory:
            back = BarAction(tr("Set back to live"), tr("Enter"), is_wished=False)
            return BarState(primary=back, note=tr("The sensors are ready for walks, and send nothing."))
        if sensors.acquisition is None:
            return BarState(note="" if sensors.is_searching else tr("Choose where sensors are looked for."))
        if reason := self._visit.cannot_record:
            other = BarAction(tr("Choose other sensors"), tr("Enter"), Icon.REPEAT)
            demonstration = BarAction(tr("Begin with a demonstration patient"), is_wished=False)
            return BarState(primary=other, others=(demonstration,), note=reason)
        if (silent := self._silent_site) is not None:
            again = BarAction(tr("Reconnect {site}").format(site=name_of(silent)), tr("Enter"), Icon.REPEAT)
            joints = (*LEG_JOINTS, *sensors.hips)
            lost = tr(" and ").join(name_of(one) for one in joints if silent in (one.proximal, one.distal))
            without = BarAction(tr("Go on without {joints}").format(joints=lost), is_wished=False)
            return BarState(primary=again, others=(without,) if sensors.joints else ())
        if sensors.is_left_to_motion:
            return BarState(primary=BarAction(go_on, tr("Enter")), note=tr("The free motion tells who wears what."))
        if not sensors.joints:
            note = tr("Two sensors that share a joint are needed: thigh and shank, or shank and foot.")
            return BarState(primary=BarAction(go_on, tr("Enter"), is_enabled=False), note=note)
        is_whole = set(LEG_SITES) <= sensors.sensor_at.keys()  # a pelvis is for whoever wants hips
        return BarState(primary=BarAction(go_on, tr("Enter"), is_wished=is_whole), note=sensors.price_of_missing())

    def on_primary(self) -> None:
        if self.telling.is_on:
            self._use_columns()
        elif self.setup.is_on:
            self.setup.on_primary()
        elif self.memories.is_on:
            self.memories.on_primary()
        elif self._visit.sensors.are_in_memory:
            self.setup.set_back()
        elif self._is_choosing:
            if (session := self.page.stored.session) is not None:
                self._replay(session)
        elif self._visit.cannot_record:
            self._on_stop_pressed()
            self.page.focus()
        elif self._silent_site is not None:
            self._reconnect()
        elif self._visit.sensors.acquisition is not None:
            self.done.emit()

    def on_other(self, number: int) -> None:
        if self.setup.is_on:
            self.setup.leave_out_failed()
        elif self.memories.is_on:
            self.memories.on_other()
        elif self._visit.cannot_record:
            self.demonstration_wanted.emit()
        else:
            self.done.emit()

    def on_quiet(self, number: int) -> None:
        if self.memories.is_on:
            self.memories.leave()
        elif self._may_ask_memories:
            self.memories.begin()

    def on_intent(self, intent: Intent) -> bool:
        if intent.action is KeyAction.LABEL:
            return self.page.place_selected(intent.number)
        if intent.action is KeyAction.IDENTIFY and self.setup.is_on:
            return self.setup.identify_selected()
        if intent.action is KeyAction.IDENTIFY:
            return self.page.identify_selected()
        return False

    @property
    def _is_in_sight(self) -> bool:
        return self._asks is not SensorsShown.NOTHING

    @property
    def _is_choosing(self) -> bool:
        return self._asks is SensorsShown.STORED

    def _end_choosing(self) -> None:
        if self._is_choosing:
            self._asks = SensorsShown.SOURCE

    @property
    def _known_places(self) -> dict[str, Site]:
        """Site by the sensor's name, as the library was told last in this session."""
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
        if self._replays.reading:
            page.show_reading(self._replays.reading)
        elif sensors.is_searching and sensors.choice is not None:
            page.show_searching("" if sensors.choice.key == SEARCH else sensors.choice.name)
        elif self.telling.is_on:
            page.show_columns()
        elif self.setup.is_on or self.setup.is_synchronising:
            page.show_dots(self.setup.is_synchronising)
        elif self.memories.is_on:
            page.show_memories(self.memories.is_busy)
        elif self._is_choosing:
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
        asks = next((choice.asks for choice in visit.choices if choice.key == self._told_of), ("", ""))
        if not self.setup.is_on and sensors.sync.failure[0]:
            asks = sensors.sync.failure
        page.tell(*asks if options else (tr("No source of sensors is at hand for this patient."), ""))
        apart = tr(
            "Simulated and replayed sensors are offered only for codes that begin with DEMO, "
            "so that they never pass for a real patient's."
        )
        page.nothing.show_left_out("" if visit.may_simulate else apart)

    def _show_rows(self) -> None:
        sensors = self._visit.sensors
        acquisition = sensors.acquisition
        if acquisition is None:
            return
        status = sensors.status
        rows = tuple(self._row(status[name]) for name in acquisition.sensors if name in status)
        self.page.show_sensors(rows)
        silent = next((row.site for row in rows if row.silent_s > 0 and row.site is not None), None)
        if silent is not self._silent_site:
            self._silent_site = silent
            self.changed.emit()

    def _row(self, status: "SensorStatus") -> SensorRow:
        is_silent = status.silent_s >= SILENT_FROM_S
        return SensorRow(
            name=status.sensor,
            model=status.details.model,
            rate_hz=status.details.rate_hz or float(round(status.heard_hz)),
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
        self.page.show_traces(
            {name: self._trace(acquisition.latest(name, TRACE_S), now_s) for name in acquisition.sensors}
        )

    def _trace(self, block: ImuBlock, now_s: float) -> FloatArray:
        """Give (n,) deg/s of the last seconds at even steps, about the sensor's axis that turns most; NaN if silent."""
        time_s = np.linspace(now_s - TRACE_S, now_s, TRACE_POINTS)
        heard = np.isfinite(block.gyr_rad_s).all(axis=1)
        if np.count_nonzero(heard) < 2:
            return np.full(TRACE_POINTS, np.nan)
        rates = block.gyr_rad_s[heard]
        variance = rates.var(axis=0)
        most = int(np.argmax(variance))
        axis = self._axis.setdefault(block.sensor, most)
        if variance[most] > TURNS_MORE * variance[axis]:
            axis = self._axis[block.sensor] = most
        known_s = block.time_s[heard]
        values: FloatArray = np.rad2deg(np.interp(time_s, known_s, rates[:, axis], left=np.nan))
        values[time_s > known_s[-1] + SILENT_FROM_S / 2] = np.nan
        return values

    def _reconnect(self) -> None:
        """Open the source anew; its sensors come back to their places."""
        sensors = self._visit.sensors
        if sensors.choice is None:
            return
        self._wanted = dict(sensors.site_of)
        if sensors.choice.make_fleet is not None:
            self._set_up(sensors.choice)
        else:
            sensors.search(sensors.choice)

    def _on_opened(self) -> None:
        sensors = self._visit.sensors
        assert sensors.acquisition is not None
        told = sensors.choice.worn if sensors.choice is not None else {}
        for wanted in (self._wanted or self._known_places or self._visit.placement_before, told):
            known = {name: site for name, site in wanted.items() if name in sensors.acquisition.sensors}
            if known:
                sensors.assign_all(known)
                break
        self._wanted = {}
        self._begin_estimator()
        if self._is_in_sight:
            self._show()
            self.page.focus()

    def _on_sensors_changed(self) -> None:
        if self._is_in_sight:
            self._show()
        self.changed.emit()

    def _on_way_chosen(self, way: str) -> None:
        is_left = way == Way.MOTION
        if is_left != self._visit.sensors.is_left_to_motion:
            self._visit.sensors.leave_to_motion(is_left)

    def _on_source_chosen(self, key: str) -> None:
        if self.memories.is_busy:  # what is fetched or erased is not left by accident
            self.told.emit(self.memories.cannot_leave, "")
            self._show_sources()
            return
        sensors = self._visit.sensors
        known = (*self._visit.choices, *([sensors.choice] if sensors.choice is not None else []))
        choice = next((one for one in known if one.key == key), None)
        if choice is None and key != REPLAY:
            return
        is_told, self._told_of = key == self._told_of, ""
        self._end_asking()
        if choice is None:
            self._choose_stored()
        elif any(choice.asks) and not is_told:
            self._told_of = key
            sensors.close()
            self._show()
            self.changed.emit()
        elif choice.lines:
            sensors.close()  # they may be at the same ports
            self.telling.begin(self.page.columns, choice.lines)
            self._show()
            self.page.focus()
            self.changed.emit()
        elif choice.make_fleet is not None:
            self._set_up(choice)
        else:
            sensors.search(choice)

    def _end_asking(self) -> None:
        """Let go of all that stands in the place of the sensors, or would come there once it is read."""
        self._end_choosing()
        self._replays.stop()
        self.telling.end()
        self.setup.end()
        self.memories.end()

    def _set_up(self, choice: SourceChoice) -> None:
        """Ask of Movella DOTs which are worn, and synchronise them."""
        self._visit.sensors.close()
        known = self._wanted or self._known_places or self._visit.placement_before
        self.setup.begin(choice, known.keys())
        self._show()
        self.page.focus()
        self.changed.emit()

    def _on_setup_changed(self) -> None:
        if self._is_in_sight:
            self._show()
        self.changed.emit()

    def _on_setup_left(self) -> None:
        self.setup.end()
        self._show()
        self.page.focus()
        self.changed.emit()

    def _on_memories_left(self, was_live: bool) -> None:
        if was_live:
            self.setup.set_back()
        self._show()
        self.page.focus()
        self.changed.emit()

    def _use_columns(self) -> None:
        """Remember what is told, and search again: all that is known is heard then."""
        try:
            self.telling.keep()
        except OSError as problem:
            self.told.emit(tr("What the columns mean cannot be kept."), str(problem))
            return
        self._on_source_chosen(SEARCH)

    def _on_columns_left(self) -> None:
        self.telling.end()
        self._show()
        self.page.focus()
        self.changed.emit()

    def _on_stop_pressed(self) -> None:
        if self._replays.reading:
            self._replays.stop()
        else:
            self._visit.sensors.close()
        self._show()
        self.changed.emit()

    # replay of a stored session

    def _choose_stored(self) -> None:
        """Ask which: what sends now goes on doing so meanwhile."""
        self._asks = SensorsShown.STORED
        self.page.stored.tell("")
        session = self._visit.session
        self._replays.list_sessions(session.id if session is not None else None)
        self._show()
        self.page.focus()
        self.changed.emit()

    def _on_listed(self, lines: "list[SessionSummary]") -> None:
        now = datetime.datetime.now().astimezone()
        shown = [_stored_line(line, now) for line in lines]
        self._names = {line.id: tr("{code}, {when}").format(code=line.code, when=line.when) for line in shown}
        page = self.page
        page.stored.show_sessions(shown)
        if self._is_choosing:
            page.focus()
            self.changed.emit()

    def _choose_folder(self) -> None:
        self.dialog = ask_for_folder(self.page, tr("Replay a session folder"), self._on_folder_selected)

    def _on_folder_selected(self, folder: str) -> None:
        self.replay_folder(Path(folder))

    def replay_folder(self, folder: Path) -> None:
        """Let a session folder be the sensors."""
        self._replays.read_folder(folder)
        self._show()
        self.changed.emit()

    def _replay(self, session_id: UUID) -> None:
        self._replays.read_session(session_id, self._names[session_id])
        self._show()
        self.changed.emit()

    def _on_stored_left(self) -> None:
        self._end_choosing()
        self._show()
        self.page.focus()
        self.changed.emit()

    def _on_replay_read(self, choice: SourceChoice) -> None:
        if not self._is_in_sight:
            return
        self._end_choosing()
        self.page.stored.tell("")
        self._visit.sensors.search(choice)

    def _on_replay_refused(self, what: str, then: str) -> None:
        if not self._is_in_sight:
            return
        self.page.stored.tell(what, then)
        self._show()
        self.page.focus()
        self.changed.emit()

    def _on_identify_pressed(self, sensor: str) -> None:
        acquisition = self._visit.sensors.acquisition
        if acquisition is not None and not acquisition.identify(sensor):
            self._without_light.add(sensor)
            self.told.emit(tr("{sensor} has no light that can be lit.").format(sensor=sensor), tr("Shake it instead."))
            self._show_rows()

    def _on_reconnect_pressed(self, _sensor: str) -> None:
        self._reconnect()


def _stored_line(line: "SessionSummary", now: datetime.datetime) -> PatientLine:
    amount = tr_n("{count} recording", "{count} recordings", line.recordings).format(count=line.recordings)
    conditions = ", ".join(line.conditions)
    return PatientLine(line.id, line.patient_code, conditions, when(line.started, now), amount, searched="")
