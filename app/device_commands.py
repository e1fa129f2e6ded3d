"""What does the command line do with sensors? It lists those that are heard, and plays ones that are not there."""

import os
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from core.samples import FloatArray
    from devices.emulators.transports import Emulation, Voice

EMULATED = ("ximu3", "witmotion")
SITES = 6
RATE_HZ = 100


def list_devices() -> Iterator[str]:
    """What is heard now, at which port nothing is, and how each driver was proved; takes a second or two."""
    from devices.catalogue import DRIVERS
    from devices.search import search

    found = search()
    names = {driver.key: driver.name for driver in DRIVERS}
    yield "Sensors that were heard:" if found.sensors else "No sensor was heard."
    for sensor in found.sensors:
        simulated = ", simulated" if sensor.is_simulated else ""
        yield f"- {names[sensor.driver]}: {sensor.name} at {sensor.place}{simulated}"
    if found.passed:
        yield "Ports without one:"
    for passed in found.passed:
        about = f" ({passed.port.description})" if passed.port.description else ""
        yield f"- {passed.port.device}{about}: {passed.what}. {passed.remedy}."
    yield "How the drivers were proved:"
    for driver in DRIVERS:
        yield f"- {driver.name}: {driver.proof}"


def emulate(kind: str, count: int, seconds: float, tell: Callable[[str], None]) -> None:
    """Play so many sensors at pseudo-terminals until interrupted or `seconds` are over; tells their ports first.

    Raises
    ------
    OSError
        There are no pseudo-terminals on this system.
    """
    from devices.ports import MORE_PORTS

    with _emulations(kind, count) as emulations:
        places = [emulation.place for emulation in emulations]
        for emulation in emulations:
            tell(emulation.place)
        tell(f"Let the application look there: {MORE_PORTS}={os.pathsep.join(places)}")
        until_s = time.monotonic() + seconds
        try:
            while time.monotonic() < until_s:
                time.sleep(min(0.1, seconds))
        except KeyboardInterrupt:
            tell("Ended.")


@contextmanager
def _emulations(kind: str, count: int) -> "Iterator[list[Emulation]]":
    from devices.emulators.transports import Emulation, Terminal

    with tempfile.TemporaryDirectory(prefix="gaitwright-ports-") as folder:
        emulations: list[Emulation] = []
        try:
            for number, values in enumerate(_walk(count)):
                link = Path(folder) / f"{kind}-{number + 1}"
                emulations.append(Emulation(_voice(kind, number, values), partial(Terminal, link)))
            yield emulations
        finally:
            for emulation in emulations:
                emulation.close()


def _voice(kind: str, number: int, values: "FloatArray") -> "Voice":
    from devices.emulators.witmotion import WitVoice
    from devices.emulators.ximu3 import Ximu3Voice

    def motion(sample: int) -> Sequence[float]:
        row: list[float] = values[sample % len(values)].tolist()
        return row

    if kind == "witmotion":
        return WitVoice(f"{number + 1:04d}", motion, rate_hz=RATE_HZ)
    return Ximu3Voice(f"EMU{number + 1:05d}", motion, rate_hz=RATE_HZ)


def _walk(count: int) -> "list[FloatArray]":
    """What the simulated patient's sensors measure, site by site: deg/s (3) and g (3) of each sample."""
    import numpy as np

    from core.body import Site
    from devices.walker import DEMONSTRATION, simulate
    from devices.ximu3 import G

    recordings = simulate(DEMONSTRATION).session.recordings
    found = []
    for number in range(count):
        site = list(Site)[number % SITES]
        blocks = [recording.imu[site] for recording in recordings if site in recording.imu]
        whole = np.concatenate([np.hstack([np.degrees(one.gyr_rad_s), one.acc_m_s2 / G]) for one in blocks])
        found.append(np.clip(np.nan_to_num(whole), [-1999] * 3 + [-15.9] * 3, [1999] * 3 + [15.9] * 3))
    return found
