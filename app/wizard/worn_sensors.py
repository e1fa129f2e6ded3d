"""Sensors that are there, and who wears which of them where."""

import logging
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

from app.storage.stored import PlacedSensor
from app.system.progress import Report
from app.widgets.sensor_tile import SILENT_FROM_S
from app.wizard.sensor_sync import SensorSync
from app.wording.body import name_of, spelled_out
from app.wording.translation import capitalised, joined, later, tr
from app.workers.background import Background, Work
from app.workers.refusals import refusal_of
from core.body import LEG_JOINTS, LEG_SITES, Joint, Side, Site, hip_of
from core.placement.labels import groups_of
from core.prosthesis import NOT_STATED, Prosthesis
from core.samples import SensorInfo
from core.session import Patient
from devices.live import SourceRefusedError

if TYPE_CHECKING:
    from app.acquisition.acquisition import Acquisition, SensorStatus
    from app.acquisition.dot_fleet import DotFleet
    from devices.dot.source import DotGroup
    from devices.drivers.lines import LinesAt

_log = logging.getLogger(__name__)


class SetUpFirstError(SourceRefusedError):
    """Sensors that were found, and have to be set up by the choice of this `key` before they are opened."""

    def __init__(self, key: str) -> None:
        super().__init__(later("These sensors must be set up first"), later("Choose these sensors as the source"))
        self.key = key


@dataclass(frozen=True, slots=True)
class SourceChoice:
    """A source through which sensors can be received. `make` may take seconds: it is called beside the screen.

    What `is_simulated` or replayed was not measured on this patient: the library keeps it apart from real recordings.
    `worn` gives the site by the sensor's name where the source gives it, as a stored session does. What `lines` mean
    has to be entered first; they are received through another choice then. `asks` names whom on the network `make`
    will ask what, where it asks anybody, and what to do to have it ask: that is shown before. `make_prosthetic` is
    called instead for a patient with a prosthesis on one side, with what is stated of it. What `make_fleet` gives has
    to be set up first: `make` is another one's then.
    """

    key: str
    name: str
    make: Callable[[], "Acquisition"]
    is_simulated: bool = False
    worn: Mapping[str, Site] = field(default_factory=dict)
    lines: "tuple[LinesAt, ...]" = ()
    asks: tuple[str, str] = ("", "")
    make_prosthetic: "Callable[[Side, Prosthesis], Acquisition] | None" = None
    make_fleet: "Callable[[], DotFleet] | None" = None

    def for_patient(self, patient: Patient) -> "SourceChoice":
        """For somebody who may wear prostheses."""
        if self.make_prosthetic is None or len(patient.prosthetic_sides) != 1:
            return self
        (side,) = patient.prosthetic_sides
        return replace(self, make=partial(self.make_prosthetic, side, patient.worn.get(side, NOT_STATED)))


class WornSensors(QObject):
    """`acquisition` is None until a source is open; `site_of` gives the site by the sensor's name.

    Left to the motion (`is_left_to_motion`), sensors have no site until the free motion has shown it. `detected`:
    by the site that a sensor is stated to be at, the one where the motion puts it, until that is used or the labels
    are kept.
    """

    changed = Signal()
    opened = Signal()
    refused = Signal(str, str)
    set_up_required = Signal(str)  # the key of the choice that what was found has to be set up by

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self.sync = SensorSync(self)
        """Brings sensors onto one clock; here, for its threads outlive a step."""
        self.asking = Background(self)
        """Asks sensors who they are, before some of them are opened."""
        self.acquisition: Acquisition | None = None
        self.choice: SourceChoice | None = None
        self.site_of: dict[str, Site] = {}
        self.is_left_to_motion = False
        self.detected: dict[Site, Site] = {}
        self._kept_labels: set[tuple[Site, ...]] = set()
        self._closing: list[threading.Thread] = []
        self._background = Background(self)
        self._background.done.connect(self._on_opened)
        self._background.failed.connect(self._on_failed)

    @property
    def is_searching(self) -> bool:
        return self._background.is_busy

    @property
    def is_idle(self) -> bool:
        """Whether no thread is left that opens or closes sensors."""
        is_quiet = self._background.is_idle and self.sync.is_idle and self.asking.is_idle
        return is_quiet and not any(thread.is_alive() for thread in self._closing)

    @property
    def sensor_at(self) -> dict[Site, str]:
        return {site: sensor for sensor, site in self.site_of.items()}

    @property
    def status(self) -> "Mapping[str, SensorStatus]":
        return {} if self.acquisition is None else self.acquisition.status()

    @property
    def silent_s(self) -> "Mapping[str, float]":
        return {} if self.acquisition is None else self.acquisition.silent_s()

    @property
    def are_silent(self) -> bool:
        """Whether none of the sensors that are worn has been received for a second or more."""
        worn = [silent_s for name, silent_s in self.silent_s.items() if name in self.site_of]
        return bool(worn) and all(silent_s >= SILENT_FROM_S for silent_s in worn)

    @property
    def joints(self) -> list[Joint]:
        """Those that have a sensor on both sides."""
        worn = self.sensor_at
        return [joint for joint in LEG_JOINTS if joint.proximal in worn and joint.distal in worn]

    @property
    def hips(self) -> list[Joint]:
        """Those that have a sensor on both sides; none without one on the pelvis."""
        worn = self.sensor_at
        return [hip_of(side) for side in Side if {Site.PELVIS, hip_of(side).distal} <= worn.keys()]

    @property
    def places(self) -> tuple[Site, ...]:
        """Where sensors can be worn: the pelvis only where there is a seventh, or one was put there."""
        count = len(self.acquisition.sensors) if self.acquisition is not None else 0
        has_pelvis = count > len(LEG_SITES) or Site.PELVIS in self.site_of.values()
        return tuple(Site) if has_pelvis else LEG_SITES

    @property
    def dots(self) -> "DotGroup | None":
        """Whom the open sensors belong to, if they are DOTs."""
        return self.acquisition.dots if self.acquisition is not None else None

    @property
    def are_ready_for_walks(self) -> bool:
        """Whether a walk can be recorded as it is to be: in memories on a clock that holds, or else live."""
        dots = self.dots
        return dots is None or (dots.is_ready_to_record if dots.record_hz is not None else not dots.is_recording_use)

    @property
    def are_loose(self) -> bool:
        """Whether DOTs that stream have no common clock, or have had it for so long that they drift apart."""
        dots = self.dots
        if dots is None or dots.is_recording_use or dots.is_synchronising or len(dots.sensors) < 2:
            return False
        return not dots.are_one_at(dots.rate_hz)

    @property
    def on_own_clocks(self) -> tuple[str, ...]:
        """DOTs that were to have a common clock, and have not."""
        dots = self.dots
        if dots is None or len(dots.sensors) < 2 or dots.is_synchronising:
            return ()
        return tuple(sensor.name for sensor in dots.sensors if not dots.clock_of(sensor.name))

    @property
    def are_in_memory(self) -> bool:
        """Whether the sensors record in their memories, or are ready to, so that nothing is measured live."""
        return self.dots is not None and self.dots.is_recording_use

    def search(self, choice: SourceChoice) -> None:
        """Open a source beside the screen; `opened` or `refused` follows. What was open before is closed."""
        self._close()
        self.choice = choice
        self._background.start(_opening(choice, self.closings()))
        self.changed.emit()

    def closings(self) -> Callable[[], None]:
        """What waits, beside the screen, until all that was closed so far lets go of its sensors."""
        closing = tuple(self._closing)

        def wait() -> None:
            for thread in closing:
                thread.join()

        return wait

    def close_beside(self, close: Callable[[], object]) -> None:
        """Let go of something beside the screen."""
        self._closing = [thread for thread in self._closing if thread.is_alive()]
        self._closing.append(threading.Thread(target=close, name="closing sensors"))
        self._closing[-1].start()

    def close(self) -> None:
        """Let go of the sensors; `finish` waits until that is done."""
        self._close()

    def detach(self) -> "Acquisition | None":
        """Forget what was open; whoever takes it closes it."""
        self._background.stop()
        self.sync.stop()
        acquisition = self.acquisition
        self.acquisition, self.choice, self.site_of, self.detected = None, None, {}, {}
        return acquisition

    def finish(self) -> None:
        """Wait for the last thread, at the end of the program."""
        self._background.finish()
        self.sync.finish()
        self.asking.finish()
        for thread in self._closing:
            thread.join()

    def assign(self, sensor: str, site: Site | None) -> None:
        """Wear `sensor` at `site`; one that was worn there takes the place that `sensor` had, or none."""
        before = self.site_of.pop(sensor, None)
        other = self.sensor_at.get(site) if site is not None else None
        if other is not None:
            del self.site_of[other]
            if before is not None:
                self.site_of[other] = before
        if site is not None:
            self.site_of[sensor] = site
        self.is_left_to_motion, self.detected = False, {}
        self.changed.emit()

    def assign_all(self, site_of: Mapping[str, Site]) -> None:
        """Wear all sensors as stated, the others nowhere."""
        self.site_of, self.detected = dict(site_of), {}
        self.changed.emit()

    def doubt(self, detected: Mapping[Site, Site]) -> None:
        """Note where the motion puts sensors elsewhere than stated; what was kept is not doubted again."""
        groups = [group for group in groups_of(detected) if group not in self._kept_labels]
        doubted = {site: detected[site] for group in groups for site in group}
        if doubted != self.detected:
            self.detected = doubted
            self.changed.emit()

    def doubt_in_words(self) -> tuple[str, str]:
        """Which positions the motion contradicts, and which angles that costs, in two sentences."""
        doubted = [site for site in Site if site in self.detected]
        names = [spelled_out(site) for site in doubted]
        what = tr("{first} and {last} look swapped.") if len(names) == 2 else tr("{sites} look mixed up.")
        what = what.format(sites=joined(names), first=names[0], last=names[-1])
        wrong = [name_of(joint) for joint in self.joints if not self.detected.keys().isdisjoint(_ends(joint))]
        then = tr("These angles would be wrong: {joints}.").format(joints=joined(wrong)) if wrong else ""
        return capitalised(what), then

    def use_detected(self) -> None:
        """Wear them where the motion puts them."""
        self.assign_all({name: self.detected.get(site, site) for name, site in self.site_of.items()})

    def keep_labels(self) -> None:
        """Wear them as stated, whatever the motion shows; for the rest of the visit."""
        self._kept_labels |= set(groups_of(self.detected))
        self.doubt({})

    def leave_to_motion(self, is_left: bool) -> None:
        self.is_left_to_motion = is_left
        if is_left:
            self.site_of, self.detected = {}, {}
        self.changed.emit()

    def placed(self) -> dict[Site, PlacedSensor]:
        """What the library is given about the sensors that are worn."""
        status = self.status
        placed = {}
        for sensor, site in self.site_of.items():
            reported = status[sensor].details
            info = SensorInfo(
                reported.serial, reported.model, reported.firmware, reported.rate_hz, reported.rate_kind, reported.clock
            )
            placed[site] = PlacedSensor(sensor, info)
        return placed

    def price_of_missing(self) -> str:
        """What is not measured for want of sensors, in a sentence; empty where all are worn that there are."""
        worn, places = self.sensor_at, self.places
        missing = [site for site in places if site not in worn]
        if missing == [Site.PELVIS]:
            return tr("No sensor on the pelvis: no hip angles.")
        required = [*LEG_JOINTS, *(hip_of(side) for side in Side if Site.PELVIS in places)]
        lost = [name_of(joint) for joint in required if joint not in (*self.joints, *self.hips)]
        if not lost or not worn:
            return ""
        return tr("No sensor at {sites}: no angles for {joints}.").format(
            sites=joined([name_of(site) for site in missing]), joints=joined(lost)
        )

    def _close(self) -> None:
        acquisition = self.detach()
        if acquisition is not None:  # closing waits for ports, so another thread does it
            self.close_beside(acquisition.close)

    def _on_opened(self, acquisition: "Acquisition") -> None:
        self.acquisition = acquisition
        self.opened.emit()
        self.changed.emit()

    def _on_failed(self, error: Exception) -> None:
        choice, self.choice = self.choice, None
        if isinstance(error, SetUpFirstError):
            self.set_up_required.emit(error.key)
        elif isinstance(error, SourceRefusedError):
            self.refused.emit(*refusal_of(error))
        else:
            _log.error("a source did not open", exc_info=error)
            name = choice.name if choice is not None else tr("This source")
            self.refused.emit(
                tr("{name} could not be opened.").format(name=name),
                tr("Choose another source. See the log for details."),
            )
        self.changed.emit()


def _ends(joint: Joint) -> tuple[Site, Site]:
    return joint.proximal, joint.distal


def _opening(choice: SourceChoice, wait: Callable[[], None]) -> Work:
    def work(report: Report) -> object:
        wait()
        report(0.0, choice.name)
        acquisition = choice.make()
        acquisition.start()
        try:
            report(1.0, choice.name)  # raises where nobody waits any more
        except BaseException:
            acquisition.close()
            raise
        return acquisition

    return work
