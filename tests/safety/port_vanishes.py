"""T4 at ports:

a sensor is pulled out while it is recorded. Check what the others lose and that the gap is right to a sample.

    python -m tests.safety.port_vanishes --count 200

Six emulated x-IMU3s at 200 Hz, each at a pseudo-terminal of its own; in each round four are pulled out once and put in
again, at moments of their own.
"""

from collections.abc import Collection
from functools import partial
from pathlib import Path

import numpy as np

from app.acquisition.acquisition import Acquisition
from app.storage.journal.decoding import decode
from devices.decoders import DECODERS
from devices.drivers.ximu3 import Ximu3
from devices.emulators.transports import Emulation, PseudoTerminal
from devices.emulators.ximu3 import Ximu3Voice
from devices.source import DecodedSensor
from devices.stream import ByteSource
from devices.transport.ports import PortInfo, SerialPort
from tests.driver import Found, drive
from tests.safety.journal_material import KEY
from tests.safety.vanishing import Pulling

SENSORS, RATE_HZ, LOOP = 6, 200, 1900


def motion(number: int) -> tuple[float, ...]:
    """A rate that states which sample it is."""
    return (float(number % LOOP), 0.0, 0.0, 0.0, 0.0, 1.0)


def vanish_often(folder: Path, count: int, seed: int) -> Found:
    names = [f"EMU{k:05d}" for k in range(SENSORS)]
    emulations = {
        name: Emulation(Ximu3Voice(name, motion, rate_hz=RATE_HZ), partial(PseudoTerminal, folder / name))
        for name in names
    }
    sources = [ByteSource(Ximu3(), SerialPort(PortInfo(emulation.place))) for emulation in emulations.values()]
    acquisition = Acquisition(sources)

    def faults_in(path: Path, gone: Collection[str]) -> list[str]:
        sensors = decode([path], KEY, DECODERS).sensors
        missing = [f"{name} is not there" for name in names if name not in sensors]
        received = [name for name in names if name in sensors]
        return missing + [
            fault for name in received for fault in faults_of(name, sensors[name], gaps=int(name in gone))
        ]

    acquisition.start()
    try:
        return Pulling(acquisition, emulations, faults_in, earliest_s=0.3, settles_s=0.5).often(folder, count, seed)
    finally:
        acquisition.close()
        for emulation in emulations.values():
            emulation.close()


def faults_of(name: str, decoded: DecodedSensor, gaps: int) -> list[str]:
    """What is wrong with a sensor that should have so many gaps."""
    number = np.degrees(decoded.block.gyr_rad_s[:, 0]).round().astype(np.int64)
    missing = np.diff(number) % LOOP - 1
    by_time = np.round(np.diff(decoded.block.time_s) * RATE_HZ).astype(np.int64) - 1
    faults = []
    if np.count_nonzero(missing) != gaps:
        faults.append(f"{name}: {np.count_nonzero(missing)} gaps, expected {gaps}")
    if not np.array_equal(missing, by_time):
        faults.append(f"{name}: gaps of {missing[missing != by_time]}, by their times {by_time[missing != by_time]}")
    if decoded.counts.lost != missing.sum() or decoded.counts.doubled or decoded.counts.late:
        faults.append(f"{name}: {decoded.counts}, missing {missing.sum()}")
    return faults


if __name__ == "__main__":
    drive(__doc__, lambda asked, folder: vanish_often(folder, asked.count, asked.seed), count=200, seed=1)
