"""The running walk as streams of Lab Streaming Layer, received by its own library: every sample once."""

import json
import math
import re
import sys
import threading
from collections.abc import Iterator
from time import monotonic
from typing import Any

import numpy as np
import pylsl
import pylsl.util
import pytest

from app.live_output import sender as module
from app.live_output.chunks import LiveChunk
from app.live_output.output import LiveOutput
from app.live_output.status import OutputSettings
from core.body import LEG_JOINTS, Joint
from core.verdicts.model import Verdict
from devices.drivers.lsl import ask_in
from devices.live import SourceRefusedError
from devices.transport.networks import THIS_COMPUTER
from tests.app.live_output.known_walk import BEGAN_S, RATE_HZ, STREAMS, samples, walk
from tests.examples import live_lsl
from tests.waiting import PATIENCE_S, wait_for

COUNT = 1000


@pytest.fixture
def on(alone_with_lsl: None, output: LiveOutput) -> LiveOutput:
    output.set_up(OutputSettings(has_lsl=True))
    refused = output.trouble.get("lsl")
    if refused is not None and refused.other:  # another test of this process has searched a network
        pytest.skip("Lab Streaming Layer searches another network here")
    assert not output.trouble
    output.open_streams(STREAMS)
    return output


NAMES = (*(joint.value for joint in LEG_JOINTS), "events", "status")


@pytest.fixture
def inlets(on: LiveOutput) -> Iterator[dict[str, Any]]:
    found = pylsl.resolve_bypred("starts-with(name,'Gaitwright ')", minimum=len(NAMES), timeout=PATIENCE_S)
    made = {one.name().split()[1]: pylsl.StreamInlet(one, recover=False) for one in found}
    assert set(made) == set(NAMES)
    for one in made.values():
        one.open_stream(timeout=PATIENCE_S)
    yield made
    for one in made.values():
        one.close_stream()


def pulled(one: Any, count: int) -> tuple[list[Any], list[float]]:
    rows: list[Any] = []
    stamps: list[float] = []

    def has_all() -> bool:
        new, at = one.pull_chunk(timeout=0.0, max_samples=4096)
        rows.extend(new)
        stamps.extend(at)
        return len(rows) >= count

    wait_for(has_all)
    return rows, stamps


def send(output: LiveOutput, chunks: list[LiveChunk]) -> None:
    output.begin_walk(BEGAN_S, BEGAN_S)
    for chunk in chunks:
        output.take(chunk)
    output.end_walk()


def test_every_sample_arrives_once_on_a_clock_that_goes_on(on: LiveOutput, inlets: dict[str, Any]) -> None:
    before_s = pylsl.local_clock()
    send(on, walk(COUNT))
    for joint in LEG_JOINTS:
        rows, stamps = pulled(inlets[joint.value], COUNT)
        values = np.array(rows)
        assert values[:, 0] == pytest.approx(np.arange(COUNT), abs=1e-3)
        assert set(values[:, 1]) == {1.5}
        assert set(values[:, 2]) == {1.0}
        assert np.diff(stamps) == pytest.approx(1 / RATE_HZ, abs=1e-6)
        assert stamps[0] == pytest.approx(before_s, abs=PATIENCE_S)
        assert inlets[joint.value].pull_sample(timeout=0.0) == (None, None)
    events, _ = pulled(inlets["events"], COUNT // 100)
    assert [one[0] for one in events] == ["left_initial_contact", "right_initial_contact"] * 5


def test_what_is_not_reported_has_no_number_but_its_status(on: LiveOutput, inlets: dict[str, Any]) -> None:
    send(on, [LiveChunk({Joint.LEFT_KNEE: samples(0, 3, Verdict.NOT_REPORTED)})])
    rows, _ = pulled(inlets["left_knee"], 3)
    assert all(math.isnan(angle) and math.isnan(sd) and status == 2.0 for angle, sd, status in rows)


def test_the_status_has_what_was_sent_and_that_it_is_simulated(on: LiveOutput, inlets: dict[str, Any]) -> None:
    send(on, walk(100))
    lines: list[dict[str, Any]] = []

    def is_over() -> bool:
        lines.extend(json.loads(one[0]) for one in inlets["status"].pull_chunk(timeout=0.0)[0])
        return bool(lines) and lines[-1]["walk"] == "none" and lines[-1]["samples"] > 0

    wait_for(is_over)
    assert (lines[-1]["samples"], lines[-1]["events"], lines[-1]["dropped"]) == (400, 1, 0)
    assert lines[-1]["simulated"] is True


def test_a_stream_states_its_channels(inlets: dict[str, Any]) -> None:
    info = inlets["right_ankle"].info(timeout=PATIENCE_S)
    assert info.get_channel_labels() == ["right_ankle_deg", "right_ankle_sd_deg", "right_ankle_status"]
    assert info.get_channel_units() == ["deg", "deg", "none"]
    assert info.nominal_srate() == RATE_HZ
    assert info.desc().child_value("simulated") == "yes"
    assert info.desc().child_value("positive") == "dorsiflexion"
    assert info.desc().child_value("status") == "0 read, 1 care, 2 withheld"


def test_streams_stay_where_an_estimator_is_replaced_and_go_with_the_page(
    on: LiveOutput, inlets: dict[str, Any]
) -> None:
    knee = inlets["left_knee"]
    on.open_streams(STREAMS)
    send(on, walk(12))
    assert len(pulled(knee, 12)[0]) == 12
    on.close_streams()

    def is_lost() -> bool:
        try:
            knee.pull_sample(timeout=0.0)
        except pylsl.util.LostError:
            return True
        return False

    wait_for(is_lost)


def test_the_example_prints_what_is_streamed(on: LiveOutput, monkeypatch: pytest.MonkeyPatch) -> None:
    over = threading.Event()

    printed: list[str] = []

    def note(*words: object) -> None:
        printed.append(" ".join(map(str, words)))

    def now_s() -> float:
        """It ends once both kinds were printed."""
        has_both = all(any(part in line for line in printed) for part in ("left_knee", "left_initial_contact"))
        return math.inf if has_both else monotonic()

    monkeypatch.setattr(live_lsl, "print", note, raising=False)
    monkeypatch.setattr(live_lsl, "monotonic", now_s)

    def send_until_over() -> None:
        while not over.is_set():  # it is not known when the example has found the streams
            send(on, walk(100))
            over.wait(0.05)

    sender = threading.Thread(target=send_until_over)
    sender.start()
    try:
        live_lsl.main(PATIENCE_S)
    finally:
        over.set()
        sender.join()
    text = "\n".join(printed)
    assert re.search(r"^\d+\.\d{3} Gaitwright left_knee: \d+\.\d+ 1\.5 1\.0$", text, re.MULTILINE)
    assert re.search(r"^\d+\.\d{3} Gaitwright events: left_initial_contact$", text, re.MULTILINE)


def test_another_network_that_is_searched_already_is_named(output: LiveOutput, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse() -> None:
        raise SourceRefusedError("Lab Streaming Layer already searches the network of {other}", "", other="192.0.2.1")

    monkeypatch.setattr(module, "LslOutlets", refuse)
    output.set_up(OutputSettings(has_lsl=True))
    assert output.trouble["lsl"].other == "192.0.2.1"
    assert not output.is_on


def test_without_the_library_it_is_named(output: LiveOutput, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pylsl", None)
    monkeypatch.setitem(sys.modules, "pylsl.util", None)
    try:
        ask_in(THIS_COMPUTER)
    except SourceRefusedError as refused:
        if "not installed" not in refused.what:
            pytest.skip("Lab Streaming Layer searches another network here")
    output.set_up(OutputSettings(has_lsl=True))
    assert output.trouble["lsl"].extra == "lsl"
