"""The running walk of the demonstration's patient as other programs receive it, and that it names nobody."""

import json
import re
import socket
import threading
from collections.abc import Iterator
from getpass import getuser
from itertools import pairwise
from pathlib import Path
from typing import Any

import pylsl
import pytest
from pytestqt.qtbot import QtBot
from websockets.sync.client import connect

from app.live_output.output import live_output
from app.live_output.status import OutputSettings
from app.wizard.visit import Visit
from app.wizard.walking.step import WalkingStep
from core.body import LEG_JOINTS, Site
from core.session import Patient
from tests.app.wizard.begun_visit import begin
from tests.app.wizard.patient_time import PatientTime
from tests.app.wizard.walking.shown_step import calibrate, shown_step, start, stop
from tests.waiting import PATIENCE_S

pytestmark = pytest.mark.endurance  # walks that are recorded

PLANTED = Patient(code="DEMO-QXZVQ", birth_year=1957, sex="female", prosthetic_side="left", affected_side="left")


@pytest.fixture
def step(
    qtbot: QtBot, alone_with_lsl: None, visit: Visit, worn: dict[str, Site], patient_time: PatientTime
) -> Iterator[WalkingStep]:
    begin(qtbot, visit, worn, PLANTED)
    patient_time.is_held = lambda: visit.recordings.is_recording and not visit.recordings.has_begun
    live_output.set_up(OutputSettings(has_lsl=True, has_websocket=True, port=0))
    assert live_output.port
    with shown_step(qtbot, visit, is_entered=False) as step:
        yield step
    live_output.stop()


def walk(qtbot: QtBot, step: WalkingStep, visit: Visit, patient_time: PatientTime, seconds: float) -> None:
    start(qtbot, step, visit)
    patient_time.wait(qtbot, seconds)
    assert step.page.output.isVisible()
    assert step.page.output.text().startswith("Live output is on: ")
    stop(qtbot, step, visit)


class Listener(threading.Thread):
    """Keeps every byte that a WebSocket client is sent, from the handshake on."""

    def __init__(self, port: int) -> None:
        super().__init__(daemon=True)
        self._socket = socket.create_connection(("127.0.0.1", port))
        self._socket.sendall(
            b"GET / HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            b"Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n"
        )
        self.received = b""
        self.start()

    def run(self) -> None:
        while part := self._socket.recv(65536):
            self.received += part
        self._socket.close()


def lsl_texts() -> list[str]:
    """The whole header of each stream, without the one line in which the library itself names the computer."""
    found = pylsl.resolve_bypred("starts-with(name,'Gaitwright ')", minimum=len(LEG_JOINTS) + 2, timeout=PATIENCE_S)
    texts = []
    for one in found:
        inlet = pylsl.StreamInlet(one)
        xml = inlet.info(timeout=PATIENCE_S).as_xml()
        assert (
            f"<hostname>{socket.gethostname()}</hostname>" in xml
        )  # where it is no more, the settings need not state it
        texts.append(re.sub("<hostname>.*</hostname>", "", xml))
        inlet.close_stream()
    assert len(texts) == len(LEG_JOINTS) + 2
    return texts


def test_nothing_that_leaves_names_a_person_or_this_computer(
    qtbot: QtBot, step: WalkingStep, visit: Visit, patient_time: PatientTime, tmp_path: Path
) -> None:
    calibrate(qtbot, visit)
    step.enter()
    listener = Listener(live_output.port)
    status = pylsl.StreamInlet(pylsl.resolve_byprop("name", "Gaitwright status", timeout=PATIENCE_S)[0])
    status.open_stream(timeout=PATIENCE_S)
    headers = lsl_texts()
    walk(qtbot, step, visit, patient_time, 5.0)
    lines, _ = status.pull_chunk(timeout=1.0, max_samples=1000)
    status.close_stream()
    (recording,) = visit.recordings.walks
    step.leave()
    live_output.stop()
    listener.join(PATIENCE_S)
    assert b'"type":"angles"' in listener.received
    assert b'"type":"event"' in listener.received
    assert b'"simulated":true' in listener.received
    left = listener.received + "\n".join([*headers, *(line[0] for line in lines)]).encode()
    details = recording.details
    names = {
        "qxzvq", "prosthe", "female", details.name, details.folder, details.condition,
        str(recording.id), str(tmp_path), socket.gethostname(), getuser(), "/home", "websockets/", "python/",
    }  # fmt: skip
    found = left.lower()
    assert [name for name in names if len(name) > 2 and name.lower().encode() in found] == []
    assert not states_year(left.decode(errors="replace"))


def states_year(text: str) -> bool:
    """Whether a text states the year of birth, not merely its digits within an angle, a count or a stream's uid."""
    uid, decimal = r"[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}", r"(?<![\d.])\d+\.\d+(?![\d.])"
    count = r'"(?:first|samples|events)":\d+'
    rest = re.sub(f"{uid}|{decimal}|{count}", "", text)
    return re.search(rf"(?<!\d){PLANTED.birth_year}(?!\d)", rest) is not None


@pytest.mark.parametrize("text", ['{"birth_year":1957}', "<desc>1957-03-02</desc>", "DEMO-1957", "born 2.3.1957"])
def test_a_year_of_birth_is_found(text: str) -> None:
    assert states_year(text)


@pytest.mark.parametrize(
    "text", ['{"knee":12.1957}', '{"t":1957.25}', "3f2a7c1e-1957-4b1d-9c5e-0123456789ab", "219571", '{"samples":1957}']
)
def test_digits_of_a_measured_value_are_no_year_of_birth(text: str) -> None:
    assert not states_year(text)


def test_a_whole_walk_is_received_each_sample_once_where_it_was_switched_on_from_the_page(
    qtbot: QtBot, step: WalkingStep, visit: Visit, patient_time: PatientTime
) -> None:
    calibrate(qtbot, visit)
    live_output.stop()
    step.enter()
    live_output.set_up(OutputSettings(has_websocket=True, port=0))
    messages: list[dict[str, Any]] = []

    def receive() -> None:
        with connect(f"ws://127.0.0.1:{live_output.port}", proxy=None) as client:
            ready.set()
            was_running = False
            for line in client:
                messages.append(json.loads(line))
                walks = messages[-1].get("walk")
                was_running |= walks == "running"
                if was_running and walks == "none":
                    return

    ready = threading.Event()
    receiver = threading.Thread(target=receive, daemon=True)
    receiver.start()
    assert ready.wait(PATIENCE_S)
    walk(qtbot, step, visit, patient_time, 6.0)
    receiver.join(PATIENCE_S)
    assert not receiver.is_alive()
    rate_hz = [m for m in messages if m["type"] == "hello"][-1]["joints"]
    last = [m for m in messages if m["type"] == "status"][-1]
    total = 0
    for joint in LEG_JOINTS:
        mine = [m for m in messages if m["type"] == "angles" and m["joint"] == joint.value]
        numbers = [m["first"] + k for m in mine for k in range(len(m["deg"]))]
        times_s = [one for m in mine for one in m["time_s"]]
        assert numbers == list(range(len(numbers)))
        assert len(numbers) > 4.0 * rate_hz[joint.value]
        steps_s = [b - a for a, b in pairwise(times_s)]
        assert steps_s == pytest.approx([1 / rate_hz[joint.value]] * len(steps_s), abs=1e-4)
        total += len(numbers)
    assert (last["samples"], last["dropped"], last["closed"]) == (total, 0, 0)
    assert any(m["type"] == "event" for m in messages)
