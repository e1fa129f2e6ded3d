"""Command line for sensors. It lists those that are received, and plays ones that are not there."""

import argparse
import os
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path

from app.importing.untrusted_files import why_format_unusable
from app.system.allowed_drivers import driver_packages, other_drivers
from app.system.known_columns import known_columns
from app.system.progress import Report
from core.session import RecordingKind
from devices.catalogue import DRIVERS
from devices.emulators.patient import EmulatedPatient, EmulatedSensor, session_for
from devices.emulators.transports import Emulation, PseudoTerminal
from devices.files.other_formats import offered_formats
from devices.files.trial import PROGRAMS, PROOFS
from devices.live import SourceRefusedError
from devices.other_drivers import OtherDrivers
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
    others = other_drivers()
    found = search(columns=known_columns(), radio=own_radio(), others=others.drivers)
    if streams_in:
        try:
            streams = search_streams(streams_in)
        except SourceRefusedError as refusal:
            yield str(refusal)
        else:
            found = replace(found, sensors=found.sensors + streams.sensors, passed=found.passed + streams.passed)
    names = {driver.key: driver.name for driver in (*DRIVERS, *others.drivers)}
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
    yield from _drivers_of_others(others, found)
    yield "What the readers of files were held against:"
    for name, proof in PROOFS.items():
        yield f"- {PROGRAMS[name]}: {proof}"
    yield from _formats_of_others()


def _drivers_of_others(others: OtherDrivers, found: SearchResult) -> Iterator[str]:
    """State what other packages bring for sensors, and why some of it is left out."""
    packages = driver_packages()
    if packages:
        yield "Drivers of other packages:"
    for package in packages:
        state = "allowed" if package.is_allowed else "not allowed; this is set in the application"
        yield f"- {package.name} {package.version}, {', '.join(package.drivers)}: {state}."
    for one in others.left_out:
        yield f"- {one.offer.name} of {one.offer.package} was left out: {one.why}."
    yield from (f"- {problem}" for problem in found.broken)


def _formats_of_others() -> Iterator[str]:
    """State what other packages bring for files, each tried in the process that would read with it."""
    offered = offered_formats()
    if offered:
        yield "File formats of other packages:"
    for offer in offered:
        why = why_format_unusable(offer)
        state = f"left out: {why}" if why else "can be read"
        yield f"- {offer.name} of {offer.package} {offer.version}: {state}."


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
