"""Sources through which sensors can be received.

They are those found at ports and on the network, streams, and a simulated patient.

Sensors are looked for beside the screen: ports take a second or two, and some never answer. Streams are asked for in
the network that somebody has chosen, and in none before.
"""

import logging
import threading
from collections.abc import Callable, Sequence
from functools import partial
from importlib.util import find_spec
from typing import TYPE_CHECKING, overload

from app.acquisition.acquisition import Acquisition
from app.acquisition.dot_fleet import DotFleet, ReceivedDot
from app.system.allowed_drivers import other_drivers
from app.system.known_columns import known_columns
from app.wizard.worn_sensors import SetUpFirstError, SourceChoice
from app.wording.translation import later, tr, tr_n
from core.body import Side
from core.prosthesis import Prosthesis
from devices.catalogue import DRIVERS
from devices.dot.samples import DRIVER as MOVELLA_DOT
from devices.dot.source import DotSource
from devices.drivers.lsl import GROUP, PORT
from devices.live import SourceRefusedError
from devices.search import search, search_streams
from devices.simulation.demonstration_patient import DemonstrationPatient
from devices.simulation.prosthesis_user import ProsthesisUser
from devices.simulation.replay import DEMONSTRATION_SESSION, DEMONSTRATION_WITH_PELVIS
from devices.transport.bluetooth import BluetoothMissingError, own_radio
from devices.transport.networks import THIS_COMPUTER, own_addresses

if TYPE_CHECKING:
    from devices.search import FoundSensor, SearchResult
    from devices.simulation.walker import WalkerSettings

DEMONSTRATION = "demonstration"
WITH_PELVIS = "demonstration_with_pelvis"
SEARCH = "search"
COLUMNS = "columns"
STREAMS = "streams "  # and the address that is asked
SEARCH_ENDS_S = 10.0

_log = logging.getLogger(__name__)


def choices() -> Sequence[SourceChoice]:
    """All sources of this machine: they become more while the search that begins now goes on."""
    sources = Sources(_search, _networks())
    sources.look()
    return sources


class Sources(Sequence[SourceChoice]):
    """The simulated patient, what was found of each driver, and a search that opens whatever it finds.

    Read it from the screen's thread: that never waits for the search.
    """

    def __init__(self, search: "Callable[[], SearchResult]", networks: Sequence[str] = ()) -> None:
        self._search, self._networks = search, networks
        self._searching = threading.Lock()  # two searches would take each other's ports
        self._found: SearchResult | None = None
        self._is_over = threading.Event()
        self._is_over.set()

    @overload
    def __getitem__(self, place: int) -> SourceChoice: ...
    @overload
    def __getitem__(self, place: slice) -> tuple[SourceChoice, ...]: ...
    def __getitem__(self, place: int | slice) -> SourceChoice | tuple[SourceChoice, ...]:
        return self._every()[place]

    def __len__(self) -> int:
        return len(self._every())

    def look(self) -> None:
        """Begin a search in a thread of its own, unless one goes on."""
        if self._is_over.is_set():
            self._is_over.clear()
            threading.Thread(target=self._look, name="looking for sensors", daemon=True).start()

    def wait(self) -> None:
        """Wait for the search that goes on; not on the screen's thread."""
        self._is_over.wait(SEARCH_ENDS_S)

    def _look(self) -> None:
        try:
            self._found = self._looked()
        except Exception:  # the thread's edge: the simulated patient and another search are still there
            _log.exception("sensors could not be looked for")
        finally:
            self._is_over.set()

    def _looked(self) -> "SearchResult":
        with self._searching:
            return self._search()

    def _every(self) -> tuple[SourceChoice, ...]:
        demonstration = SourceChoice(
            DEMONSTRATION,
            tr("Simulated patient"),
            _demonstration,
            is_simulated=True,
            make_prosthetic=_prosthesis_user,
        )
        with_pelvis = SourceChoice(
            WITH_PELVIS,
            tr("Simulated patient, seven sensors"),
            partial(_demonstration, DEMONSTRATION_WITH_PELVIS),
            is_simulated=True,
            make_prosthetic=partial(_prosthesis_user, settings=DEMONSTRATION_WITH_PELVIS),
        )
        again = SourceChoice(SEARCH, tr("Search for sensors"), self._open_all)
        streams = [_of_streams(address) for address in self._networks]
        return (demonstration, *self._of_drivers(), *self._of_lines(), again, *streams, with_pelvis)

    def _of_drivers(self) -> list[SourceChoice]:
        found = self._found
        if found is None or not found.sensors:
            return []
        by_driver = {driver: found.of(driver.key) for driver in (*DRIVERS, *found.others)}
        return [self._choice(driver.key, tr(driver.name), sensors) for driver, sensors in by_driver.items() if sensors]

    def _of_lines(self) -> list[SourceChoice]:
        lines = self._found.lines if self._found is not None else ()
        name = tr("Text lines (CSV)")
        return [SourceChoice(COLUMNS, name, self._open_all, lines=lines)] if lines else []

    def _choice(self, key: str, name: str, sensors: "Sequence[FoundSensor]") -> SourceChoice:
        count = sum(sensor.count for sensor in sensors)
        words = tr_n("{name}, {count} sensor", "{name}, {count} sensors", count)

        def make() -> Acquisition:
            self.wait()  # a search that goes on holds the ports
            return _opening(sensors)

        is_simulated = all(sensor.is_simulated for sensor in sensors)
        make_fleet = partial(fleet_of, sensors) if key == MOVELLA_DOT else None
        return SourceChoice(key, words.format(name=name, count=count), make, is_simulated, make_fleet=make_fleet)

    def _open_all(self) -> Acquisition:
        """Search again, and take all sensors that are found."""
        self._found = found = self._looked()
        others = [sensor for sensor in found.sensors if sensor.driver != MOVELLA_DOT]
        if found.sensors and not others:
            raise SetUpFirstError(MOVELLA_DOT)
        if others:  # beside which DOTs are a source of their own
            return _opening(others)
        if found.lines:
            raise SourceRefusedError(
                later("CSV data arrive, but their columns are not defined"), later("Choose these sensors as the source")
            )
        if found.broken:
            raise found.broken[0]
        if len(found.passed) == 1:  # then it is this one that is meant
            raise found.passed[0].refusal
        raise SourceRefusedError(later("No sensor found"), _remedy(found.deaf))


def _remedy(deaf: SourceRefusedError | None) -> str:
    """What to do where no sensor was found, and Bluetooth LE was `deaf`."""
    if isinstance(deaf, BluetoothMissingError):
        return later(
            "Plug in the receiver or switch on the sensors, then search again. Bluetooth LE sensors need "
            "the package gaitwright[bluetooth]"
        )
    if deaf is not None:
        return later(
            "Plug in the receiver or switch on the sensors, then search again. Bluetooth LE sensors "
            "connect once Bluetooth is switched on"
        )
    return later("Plug in the receiver or switch on the sensors, then search again")


def _demonstration(settings: "WalkerSettings" = DEMONSTRATION_SESSION) -> Acquisition:
    return Acquisition([DemonstrationPatient(settings)])


def _prosthesis_user(side: Side, fitted: Prosthesis, settings: "WalkerSettings" = DEMONSTRATION_SESSION) -> Acquisition:
    return Acquisition([ProsthesisUser(side, settings, fitted=fitted)])


def _networks() -> Sequence[str]:
    """By which of its addresses this computer can ask for streams; none where their library is not installed."""
    return (THIS_COMPUTER, *own_addresses()) if find_spec("pylsl") is not None else ()


def _of_streams(address: str) -> SourceChoice:
    """The streams where this computer has this address. It is stated before whom that asks."""
    make = partial(_open_streams, address)
    if address == THIS_COMPUTER:
        return SourceChoice(STREAMS + address, tr("Streams from programs on this computer"), make)
    what = tr(
        "This asks every computer on the network of {address} for sensor streams, by UDP to {group}, "
        "port {port}. It then contacts the computers that answer. No patient data are sent."
    ).format(address=address, group=GROUP, port=PORT)
    name = tr("Streams on the network of {address}").format(address=address)
    return SourceChoice(STREAMS + address, name, make, asks=(what, tr("Choose the source again to start the query.")))


def _open_streams(address: str) -> Acquisition:
    """Ask there, and take all sensors that are streamed."""
    found = search_streams(address)
    if found.sensors:
        return _opening(found.sensors)
    if len(found.passed) == 1:
        raise found.passed[0].refusal
    raise SourceRefusedError(
        later("No stream with motion data found"), later("Start the stream in its program, then search again")
    )


def fleet_of(sensors: "Sequence[FoundSensor]") -> DotFleet:
    """The DOTs among what was found, to be set up."""
    received = []
    for one in sensors:
        source = one.make()
        if isinstance(source, DotSource):
            received.append((source.group.radio, ReceivedDot(source.sensor, one.rssi_dbm)))
    return DotFleet(received[0][0], [dot for _, dot in received])


def _opening(sensors: "Sequence[FoundSensor]") -> Acquisition:
    return Acquisition([sensor.make() for sensor in sensors])


def _search() -> "SearchResult":
    return search(columns=known_columns(), radio=own_radio(), others=other_drivers().drivers)
