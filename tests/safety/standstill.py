"""Check that a process that stood still is distinguished from a late disk.

Its cost must be stated as the journal has it.

    python -m tests.safety.standstill --count 10 --seconds 20

Six emulated x-IMU3s at 200 Hz, each at a pseudo-terminal, send to another process, which records them and is stopped
(SIGSTOP) and continued in each round. What does not fit into a terminal meanwhile is lost.
"""

import argparse
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path

from app.acquisition.acquisition import Acquisition
from app.storage.journal.decoding import decode
from app.storage.journal.disk import Trouble
from app.wizard.journal_words import standstill_message
from devices.decoders import DECODERS
from devices.drivers.ximu3 import Ximu3
from devices.emulators.transports import Emulation, PseudoTerminal
from devices.emulators.ximu3 import Ximu3Voice
from devices.stream import ByteSource
from devices.transport.ports import PortInfo, SerialPort
from tests.driver import HIDDEN, Found, drive
from tests.safety.journal_material import ID, KEY
from tests.safety.live_material import open_journal
from tests.safety.port_vanishes import RATE_HZ, SENSORS, motion

BEFORE_S, AFTER_S = 3.0, 3.0


def record(folder: Path, places: list[str]) -> None:
    """The process that is stopped: say when it records, then, once it goes on, what it would say and what it kept."""
    troubles: list[Trouble] = []
    acquisition = Acquisition([ByteSource(Ximu3(), SerialPort(PortInfo(place))) for place in places])
    acquisition.start()
    try:
        time.sleep(1.0)
        began_s, before = acquisition.now_s, sum(acquisition.lost().values())
        acquisition.record(open_journal(folder, ID, on_trouble=troubles.append, awake_s=acquisition.awake_s))
        time.sleep(BEFORE_S)
        print("records", flush=True)
        sys.stdin.readline()
        time.sleep(AFTER_S)
        latest = acquisition.standstills[-1:]
        lost = acquisition.lost()
        words = [standstill_message(one, began_s, acquisition.now_s, lost, True, True) for one in latest]
    finally:
        summary = acquisition.stop_recording()
        acquisition.close()
    sensors = decode([summary.path], KEY, DECODERS).sensors.values()
    reported = {
        "troubles": [str(trouble) for trouble in troubles],
        "words": [" ".join(message) for message in words],
        "lost_live": sum(lost.values()) - before,
        "lost": sum(sensor.counts.lost for sensor in sensors),
        "received": sum(sensor.counts.received for sensor in sensors),
    }
    print(json.dumps(reported), flush=True)


def faults_of(reported: dict[str, object], seconds: float) -> list[str]:
    faults = []
    words = reported["words"]
    if reported["troubles"]:
        faults.append(f"blamed the disk: {reported['troubles']}")
    if not isinstance(words, list) or len(words) != 1 or not words[0].startswith("Gaitwright stalled for"):
        return [*faults, f"{words} of a standstill of {seconds} s"]
    if reported["lost"] and "Samples were lost" not in words[0]:
        faults.append(f"{words[0]!r} where the journal lacks {reported['lost']}")
    if not reported["lost"] and "No sample is missing" not in words[0]:
        faults.append(f"{words[0]!r} where the journal lacks none")
    return faults


def stop_once(seconds: float) -> dict[str, object]:
    """One round: what the process that was stopped has to say."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        emulations = [
            Emulation(Ximu3Voice(f"EMU{k:05d}", motion, rate_hz=RATE_HZ), partial(PseudoTerminal, folder / f"port{k}"))
            for k in range(SENSORS)
        ]
        command = [sys.executable, "-m", "tests.safety.standstill", "--record", name, "--places"]
        process = subprocess.Popen(
            [*command, *(emulation.place for emulation in emulations)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        try:
            with process:
                assert process.stdout is not None
                assert process.stdout.readline() == "records\n"
                os.kill(process.pid, signal.SIGSTOP)
                time.sleep(seconds)
                os.kill(process.pid, signal.SIGCONT)
                stated, _ = process.communicate("\n", timeout=120)
        finally:
            for emulation in emulations:
                emulation.close()
    reported: dict[str, object] = json.loads(stated)
    return reported


def run(asked: argparse.Namespace, _: Path) -> Iterator[tuple[str, Found]]:
    if asked.record is not None:
        record(asked.record, asked.places)
        return
    for _number in range(asked.count):
        reported = stop_once(asked.seconds)
        yield str(reported), Found(faults=faults_of(reported, asked.seconds))


if __name__ == "__main__":
    drive(
        __doc__,
        run,
        count=10,
        seconds=20.0,
        record={"metavar": "FOLDER", "type": Path, "help": HIDDEN},
        places={"nargs": "*", "help": HIDDEN},
    )
