"""Time from a sample's arrival until another program has its angle, through Lab Streaming Layer and the WebSocket.

    python -m tests.benchmarks.live_output [--seconds 60]

The demonstration's patient with six sensors at 200 Hz, played in real time through the acquisition: reader, sealed
journal, ring buffers, the walking estimator and the live output. Two programs of their own receive: one by pylsl, one
by the client of websockets. A sample has arrived when the reader has it from its source, which is polled every 15 ms;
an angle has, when the later of its two sensors' samples has. It is received when the other program's call has returned
with it; both read one clock. Jitter is the spread of these times, as standard deviation and from 5 to 95 %. What is
asked for: 95 % within 60 ms.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
import uuid
from bisect import bisect_left
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from app.acquisition.acquisition import Acquisition
from app.acquisition.live_sensors import live_sensors
from app.live_output.chunks import LiveChunk, LiveStreams
from app.live_output.output import LiveOutput
from app.live_output.status import OutputSettings
from app.main_window import SWITCH_S
from app.storage.journal.writer import JournalWriter
from app.wizard.walking.estimator import WalkingEstimator
from core.analysis import analyse
from core.body import LEG_JOINTS, LEG_SITES, Joint, Side
from core.samples import ImuBlock
from core.session import RecordingKind
from devices.live import Keep
from devices.simulation.replay import ReplaySource
from devices.simulation.walker import DEMONSTRATION, FreeMotion, Standing, Walk, simulate
from tests.benchmarks.beat import Beat
from tests.benchmarks.live_road import stood
from tests.driver import options
from tests.safety.journal_material import KEY, NO_ROOM_ASKED

RATE_HZ = 200.0
STRIDE_S = 1.1
GOAL_S = 0.06
READY_S = 60.0

WEB_SOCKET = """
import json, sys, time
from websockets.sync.client import connect
out, was_running = {}, False
with connect(f"ws://127.0.0.1:{sys.argv[1]}", proxy=None) as client:
    print("ready", flush=True)
    for line in client:
        now_s = time.monotonic()
        message = json.loads(line)
        if message["type"] == "angles":
            out.setdefault(message["joint"], []).append((now_s, message["first"], len(message["deg"])))
        was_running |= message.get("walk") == "running"
        if was_running and message.get("walk") == "none":
            break
print(json.dumps(out))
"""
LSL = """
import json, sys, threading, time
import pylsl
found = pylsl.resolve_bypred("starts-with(name,'Gaitwright ')", minimum=6, timeout=60.0)
inlets = {one.name().split()[1]: pylsl.StreamInlet(one) for one in found}
for one in inlets.values():
    one.open_stream(timeout=60.0)
out, over = {name: [] for name in inlets if "_" in name}, threading.Event()
def receive(name, inlet):
    number = 0
    while not over.is_set():
        sample, _ = inlet.pull_sample(timeout=0.2)
        if sample is None:
            continue
        rest, _ = inlet.pull_chunk(timeout=0.0, max_samples=4096)
        out[name].append((time.monotonic(), number, 1 + len(rest)))
        number += 1 + len(rest)
threads = [threading.Thread(target=receive, args=(name, inlets[name])) for name in out]
for one in threads:
    one.start()
print("ready", flush=True)
was_running = False
while True:
    line, _ = inlets["status"].pull_sample(timeout=60.0)
    walk = json.loads(line[0])["walk"]
    was_running |= walk == "running"
    if was_running and walk == "none":
        break
time.sleep(0.5)
over.set()
for one in threads:
    one.join()
print(json.dumps(out))
"""


class TimedSource(ReplaySource):
    """Notes when samples arrived: the last stamp of each sensor's block, and then."""

    def __init__(self, *args: object, **kwargs: object) -> None:
        super().__init__(*args, **kwargs)  # type: ignore[arg-type]  # as it is given
        self.arrived: dict[str, list[tuple[float, float]]] = defaultdict(list)

    def read(self, keep: Keep) -> Sequence[ImuBlock]:
        blocks = super().read(keep)
        now_s = time.monotonic()
        for block in blocks:
            if len(block):
                self.arrived[block.sensor].append((float(block.time_s[-1]), now_s))
        return blocks


def program(text: str, *arguments: str) -> "subprocess.Popen[str]":
    """Start another program and wait until it receives."""
    started = subprocess.Popen([sys.executable, "-c", text, *arguments], stdout=subprocess.PIPE, text=True)
    assert started.stdout is not None
    assert started.stdout.readline() == "ready\n"
    return started


def run(seconds: float) -> None:
    sys.setswitchinterval(SWITCH_S)  # as the window does
    required = (Standing(duration_s=10.0), FreeMotion(duration_s=25.0), Walk(strides=round(seconds / STRIDE_S)))
    session = simulate(replace(DEMONSTRATION, rate_hz=RATE_HZ, recordings=required)).session
    calibration = analyse(session).calibrations[-1].joints
    site_of = {session.recordings[0].imu[site].sensor: site for site in LEG_SITES}
    name_at = {site: name for name, site in site_of.items()}
    source = TimedSource(session)
    acquisition, output, beat = Acquisition([source]), LiveOutput(), Beat()
    acquisition.start()
    sent: dict[Joint, list[float]] = defaultdict(list)
    try:
        sensors = live_sensors(site_of, stood(acquisition).state.standing.rest, acquisition.status())
        estimator = WalkingEstimator(site_of, sensors, calibration)
        output.set_up(OutputSettings(has_lsl=True, has_websocket=True, port=0))
        assert not output.trouble
        output.open_streams(LiveStreams(estimator.rates_hz, tuple(Side), is_simulated=True))
        programs = {
            "Lab Streaming Layer": program(LSL),
            "WebSocket": program(WEB_SOCKET, str(output.port)),
        }
        began_s = acquisition.now_s

        def take(chunk: LiveChunk) -> None:
            for joint, new in chunk.angles.items():
                sent[joint] += new.since(began_s).time_s.tolist()
            output.take(chunk)

        estimator.on_chunk = take
        source.arrived.clear()
        load = os.getloadavg()[0]
        with tempfile.TemporaryDirectory() as folder:
            acquisition.ask(RecordingKind.WALKING)
            acquisition.record(JournalWriter.create(Path(folder), uuid.uuid4(), KEY, room=NO_ROOM_ASKED))
            began_s = acquisition.now_s
            output.begin_walk(began_s, began_s)
            acquisition.set_estimator(estimator)
            beat.start()
            time.sleep(seconds)
            acquisition.set_estimator(None)
            time.sleep(0.5)
            beat.end()
            output.end_walk()
            acquisition.stop_recording()
        begin_s = source.now_ns() / 1e9 - acquisition.now_s  # of the acquisition's clock
        arrivals = {
            joint: _arrival(source, begin_s, name_at[joint.proximal], name_at[joint.distal]) for joint in LEG_JOINTS
        }
        print("Arrival to receipt, ms: 50 %, 95 %, worst; jitter: standard deviation, 5 to 95 %.\n")
        print("| by | samples sent | received once | 50 %, 95 %, worst | sd, 5 to 95 % | 95 % within 60 ms |")
        print("|---|---|---|---|---|---|")
        for name, one in programs.items():
            answer, _ = one.communicate(timeout=READY_S)
            print(_row(name, json.loads(answer), sent, arrivals), flush=True)
        late = ", ".join(f"{1000 * value:.1f}" for value in np.quantile(beat.late_s, (0.5, 0.95, 1.0)))
        print(f"\nA thread that does nothing woke so late meanwhile: {late}. Load at the beginning: {load:.1f}.")
        print(f"Dropped by the output: {output.status.dropped}; never seen by the estimator: ", end="")
        print(f"{acquisition.dropped_from_preview}; it failed with: {acquisition.trouble}.")
    finally:
        output.stop()
        acquisition.close()


def _arrival(source: TimedSource, begin_s: float, *names: str) -> Callable[[float], float]:
    """When all of a joint's samples of an instant had arrived."""
    blocks = [tuple(zip(*source.arrived[name], strict=True)) for name in names]

    def when(time_s: float) -> float:
        found = []
        for last_s, at_s in blocks:
            place = bisect_left(last_s, begin_s + time_s - 1e-4)
            found.append(at_s[min(place, len(at_s) - 1)])
        return max(found)

    return when


def _row(
    name: str,
    received: dict[str, list[tuple[float, int, int]]],
    sent: dict[Joint, list[float]],
    arrivals: dict[Joint, Callable[[float], float]],
) -> str:
    took_s, count, is_whole = [], 0, True
    for joint in LEG_JOINTS:
        numbers = []
        for at_s, first, length in received.get(joint.value, []):
            for number in range(first, first + length):
                numbers.append(number)
                took_s.append(at_s - arrivals[joint](sent[joint][number]))
        is_whole &= numbers == list(range(len(sent[joint])))
        count += len(numbers)
    low, half, high, worst = np.quantile(took_s, (0.05, 0.5, 0.95, 1.0)) * 1000
    is_met = "yes" if high <= 1000 * GOAL_S else "no"
    total = sum(map(len, sent.values()))
    once = "all" if is_whole else f"no: {count}"
    return (
        f"| {name} | {total} | {once} | {half:.0f}, {high:.0f}, {worst:.0f} | "
        f"{1000 * np.std(took_s):.1f}, {high - low:.0f} | {is_met} |"
    )


def main() -> None:
    run(options(__doc__, seconds=(60.0, "of the walk")).seconds)


if __name__ == "__main__":
    main()
