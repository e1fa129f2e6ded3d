"""Command line for sensors. It lists those that are received, and plays ones that are not there."""

import argparse
import os
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

from app.system.known_columns import known_columns
from app.system.progress import Report
from core.session import RecordingKind
from devices.catalogue import DRIVERS
from devices.emulators.patient import EmulatedPatient, EmulatedSensor, session_for
from devices.emulators.transports import Emulation, PseudoTerminal
from devices.files.trial import PROGRAMS, PROOFS
from devices.live import SourceRefusedError
from devices.search import SearchResult, search, search_streams
from devices.transport.bluetooth import own_radio
from devices.transport.ports import MORE_PORTS

MOVEMENTS = {"f": "free_motion", "w": "walking", "s": "standing"}


def run(args: argparse.Namespace, _report: Report) -> Iterator[str]:
    """List the sensors, or play some until interrupted and say so meanwhile."""
    if args.emulate:
        emulate(args.emulate, args.count, args.seconds, lambda line: print(line, flush=True), sys.stdin)
    else:
        yield from list_devices(args.streams)


def list_devices(streams_in: str = "") -> Iterator[str]:
    """List received devices, silent ports and drivers' tests; takes 1 to 2 s. `streams_in` empty: no streams."""
    found = search(columns=known_columns(), radio=own_radio())
    if streams_in:
        try:
            streams = search_streams(streams_in)
        except SourceRefusedError as refusal:
            yield str(refusal)
        else:
            found = SearchResult(
                found.sensors + streams.sensors, found.passed + streams.passed, found.lines, found.deaf
            )
    names = {driver.key: driver.name for driver in DRIVERS}
    yield "Sensors found:" if found.sensors else "No sensor was found."
    for sensor in found.sensors:
        simulated = ", simulated" if sensor.is_simulated else ""
        yield f"- {names[sensor.driver]}: {sensor.name} at {sensor.place}{simulated}"
    for lines in (one for one in found.lines if one.columns is None):
        yield f"- Lines of {lines.count} numbers at {lines.port.device}: state in the application what they are."
    if found.deaf is not None:
        yield str(found.deaf)
    if found.passed:
        yield "Ports without one:"
    for passed in found.passed:
        about = f" ({passed.port.description})" if passed.port.description else ""
        yield f"- {passed.port.device}{about}: {passed.refusal}"
    yield "How the drivers were tested:"
    for driver in DRIVERS:
        yield f"- {driver.name}: {driver.proof}"
    yield "What the readers of files were held against:"
    for name, proof in PROOFS.items():
        yield f"- {PROGRAMS[name]}: {proof}"


def emulate(
    kind: str, count: int, seconds: float, show_message: Callable[[str], None], asked: Iterable[str] = ()
) -> None:
    """Emulate sensors at pseudo-terminals, ports first, until `seconds` are over; `asked`: see `MOVEMENTS`."""
    patient = EmulatedPatient(session_for(count))
    with _emulations(patient, kind, count) as emulations:
        places = [emulation.place for emulation in emulations]
        for place in places:
            show_message(place)
        show_message(f"Let the application look there: {MORE_PORTS}={os.pathsep.join(places)}")
        show_message("The patient stands. Type f and Enter for a free motion, w for a walk.")
        threading.Thread(
            target=_ask, args=(patient, asked, show_message), daemon=True
        ).start()  # it waits for the keyboard
        until_s = time.monotonic() + seconds
        try:
            while time.monotonic() < until_s:
                time.sleep(min(0.1, seconds))
        except KeyboardInterrupt:
            show_message("Ended.")


def _ask(patient: EmulatedPatient, asked: Iterable[str], show_message: Callable[[str], None]) -> None:
    for line in asked:
        if (kind := MOVEMENTS.get(line.strip())) is not None:
            clip = patient.ask(RecordingKind(kind))
            show_message(f"{clip.recording.name}: {(clip.end_ns - clip.start_ns) / 1e9:.0f} s")


@contextmanager
def _emulations(patient: EmulatedPatient, kind: str, count: int) -> Iterator[list[Emulation]]:
    with tempfile.TemporaryDirectory(prefix="gaitwright-ports-") as folder:
        emulations: list[Emulation] = []
        try:
            for number in range(count):
                link = Path(folder) / f"{kind}-{number + 1}"
                voice = EmulatedSensor(patient, kind, number).voice
                emulations.append(Emulation(voice, partial(PseudoTerminal, link)))
            yield emulations
        finally:
            for emulation in emulations:
                emulation.close()
