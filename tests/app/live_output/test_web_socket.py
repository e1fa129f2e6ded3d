"""The running walk over a WebSocket: every sample once, to this computer alone, whatever clients do."""

import json
import math
import os
import socket
import threading
from contextlib import ExitStack, suppress
from itertools import pairwise
from typing import Any

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect

from app.live_output import messages
from app.live_output.chunks import LiveChunk
from app.live_output.output import LiveOutput
from app.live_output.sender import MOST_WAITING
from app.live_output.status import OutputSettings
from app.live_output.web_socket import BACKLOG, MOST_CLIENTS, MOST_CONNECTIONS, listening_sockets
from core.body import LEG_JOINTS, Joint
from core.verdicts.model import Verdict
from tests.app.live_output.known_walk import BEGAN_S, RATE_HZ, STREAMS, samples, walk
from tests.waiting import PATIENCE_S

ANY_PORT = 0


@pytest.fixture
def on(output: LiveOutput) -> LiveOutput:
    output.set_up(OutputSettings(has_websocket=True, port=ANY_PORT))
    output.open_streams(STREAMS)
    return output


def client(output: LiveOutput, host: str = "127.0.0.1", **options: Any) -> ClientConnection:
    return connect(f"ws://{host}:{output.port}", open_timeout=PATIENCE_S, proxy=None, **options)


def received(one: ClientConnection, until: str = "none") -> list[dict[str, Any]]:
    """All messages until the status states that the walk is that."""
    found = []
    is_running = False
    while True:
        message = json.loads(one.recv(timeout=PATIENCE_S))
        found.append(message)
        if message["type"] == "status":
            is_running |= message["walk"] == "running"
            if message["walk"] == until and (is_running or until == "running"):
                return found


def send(output: LiveOutput, chunks: list[LiveChunk]) -> None:
    """Hand over a whole walk, no faster than it is sent."""
    output.begin_walk(BEGAN_S, BEGAN_S)
    for chunk in chunks:
        output.take(chunk)
    output.end_walk()


def until_closed(one: ClientConnection) -> int | None:
    """The code with which it was closed; None without one."""
    while True:
        try:
            one.recv(timeout=PATIENCE_S)
        except ConnectionClosed as closed:
            return None if closed.rcvd is None else int(closed.rcvd.code)


def of_kind(found: list[dict[str, Any]], kind: str) -> list[dict[str, Any]]:
    return [one for one in found if one["type"] == kind]


@pytest.mark.parametrize("host", ["127.0.0.1", "[::1]"])
def test_every_sample_arrives_once_and_in_order(on: LiveOutput, host: str) -> None:
    if host == "[::1]" and not has_ipv6():
        pytest.skip("this computer has no IPv6")
    with client(on, host) as one:
        one.recv(timeout=PATIENCE_S)
        send(on, walk(1000))
        found = received(one)
    for joint in LEG_JOINTS:
        mine = [m for m in of_kind(found, "angles") if m["joint"] == joint.value]
        degrees = [value for m in mine for value in m["deg"]]
        assert degrees == [float(k) for k in range(1000)]
        firsts = [m["first"] for m in mine]
        assert firsts == [sum(len(m["deg"]) for m in mine[:k]) for k in range(len(mine))]
        times = [value for m in mine for value in m["time_s"]]
        assert all(b > a for a, b in pairwise(times))
        assert times[-1] - times[0] == pytest.approx(999 / RATE_HZ, abs=1e-4)
        assert {value for m in mine for value in m["status"]} == {"care"}
        assert {value for m in mine for value in m["sd_deg"]} == {1.5}
    assert [m["number"] for m in of_kind(found, "event")] == list(range(10))
    last = of_kind(found, "status")[-1]
    assert (last["samples"], last["events"], last["dropped"]) == (4000, 10, 0)


def has_ipv6() -> bool:
    with suppress(OSError), socket.create_server(("::1", 0), family=socket.AF_INET6):
        return True
    return False


def test_what_is_not_reported_has_no_number(on: LiveOutput) -> None:
    chunks = [
        LiveChunk({Joint.LEFT_KNEE: samples(0, 3, Verdict.NOT_REPORTED)}),
        LiveChunk({Joint.LEFT_KNEE: samples(3, 3, Verdict.READ)}),
    ]
    with client(on) as one:
        one.recv(timeout=PATIENCE_S)
        send(on, chunks)
        unreported, reported = of_kind(received(one), "angles")
    assert (unreported["deg"], unreported["sd_deg"], unreported["status"]) == ([None] * 3, [None] * 3, ["withheld"] * 3)
    assert (reported["deg"], reported["status"]) == ([3.0, 4.0, 5.0], ["read"] * 3)


def test_a_missing_angle_is_not_reported_under_any_verdict() -> None:
    chunk = samples(0, 2, Verdict.READ)
    assert chunk.status.tolist() == [0, 0]
    gap = samples(0, 2, Verdict.NOT_MEASURED)
    assert gap.status.tolist() == [2, 2]
    assert all(map(math.isnan, gap.angle_deg))


def test_what_is_measured_before_the_walk_and_after_it_does_not_leave(on: LiveOutput) -> None:
    before = LiveChunk({Joint.LEFT_KNEE: samples(-4, 8)})  # half of it
    with client(on) as one:
        one.recv(timeout=PATIENCE_S)
        on.take(LiveChunk({Joint.LEFT_KNEE: samples(50, 8)}))
        send(on, [before])
        on.take(LiveChunk({Joint.LEFT_KNEE: samples(70, 8)}))
        found = received(one)
        send(on, [])
        found += received(one)
    assert [m["deg"] for m in of_kind(found, "angles")] == [[0.0, 1.0, 2.0, 3.0]]


def test_simulated_samples_are_marked(on: LiveOutput) -> None:
    with client(on) as one:
        hello = json.loads(one.recv(timeout=PATIENCE_S))
    assert hello["type"] == "hello"
    assert hello["simulated"] is True
    assert hello["joints"] == {joint.value: RATE_HZ for joint in LEG_JOINTS}


@pytest.mark.parametrize(
    "origin", ["https://example.org", "http://localhost.example.org", "http://127.0.0.1.evil", "null", "file://"]
)
def test_a_page_of_another_site_is_refused(on: LiveOutput, origin: str) -> None:
    with pytest.raises(InvalidStatus) as refused, client(on, origin=origin):
        pass
    assert refused.value.response.status_code == 403
    assert b"wright" not in refused.value.response.body.lower()


@pytest.mark.parametrize("origin", ["http://localhost:8000", "http://127.0.0.1", "https://[::1]:1"])
def test_a_page_of_this_computer_is_served(on: LiveOutput, origin: str) -> None:
    with client(on, origin=origin) as one:
        assert json.loads(one.recv(timeout=PATIENCE_S))["type"] == "hello"


def test_nothing_listens_but_on_the_loopback_addresses() -> None:
    sockets = listening_sockets(ANY_PORT)
    assert {one.getsockname()[0] for one in sockets} <= {"127.0.0.1", "::1"}
    assert len({one.getsockname()[1] for one in sockets}) == 1
    for one in sockets:
        one.close()


def test_a_port_of_another_program_is_named_and_the_rest_goes_on(output: LiveOutput) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        output.set_up(OutputSettings(has_websocket=True, port=taken.getsockname()[1]))
        assert output.trouble["websocket"].is_port_taken
        assert not output.is_on
        output.take(walk(6)[0])
    output.set_up(OutputSettings(has_websocket=True, port=ANY_PORT))
    assert output.trouble == {}
    assert output.is_on


def test_after_switching_off_nothing_listens(on: LiveOutput) -> None:
    port = on.port
    with client(on) as one:
        on.stop()
        until_closed(one)
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(("127.0.0.1", port))


def test_a_client_that_sends_is_shown_out_and_the_others_go_on(on: LiveOutput) -> None:
    with client(on) as good, client(on) as talks, client(on) as huge:
        good.recv(timeout=PATIENCE_S)
        talks.send("hello")
        with suppress(ConnectionClosed):  # it may be gone before all of it was taken
            huge.send("x" * 10_000_000)
        for one, code in ((talks, 1003), (huge, 1009)):
            assert until_closed(one) in (code, None)  # who is still sending may not get to see it
        send(on, walk(100))
        assert len(of_kind(received(good), "angles")) == 4 * 17


def test_one_client_more_than_may_be_is_refused(on: LiveOutput) -> None:
    with ExitStack() as many:
        for _ in range(MOST_CLIENTS):
            one = many.enter_context(client(on))
            for _ in range(2):  # it counts once it has been welcomed
                one.recv(timeout=PATIENCE_S)
        with pytest.raises(InvalidStatus) as refused, client(on):
            pass
        assert refused.value.response.status_code == 503


def test_a_client_that_never_reads_is_closed_and_named_and_the_others_miss_nothing(on: LiveOutput) -> None:
    with socket.create_connection(("127.0.0.1", on.port)) as sleepy, client(on) as good:
        sleepy.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        sleepy.sendall(
            b"GET / HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            b"Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n"
        )
        good.recv(timeout=PATIENCE_S)
        on.begin_walk(BEGAN_S, BEGAN_S)
        numbers: list[int] = []
        count = first = 0
        while count == 0:
            on.take(LiveChunk({Joint.LEFT_KNEE: samples(first, 400)}))
            first += 400
            while not numbers or numbers[-1] + 400 < first:
                message = json.loads(good.recv(timeout=PATIENCE_S))
                if message["type"] == "angles":
                    numbers.append(message["first"])
                elif message["type"] == "status":
                    count = message["closed"]
                    named = message["latest_closed"]
        assert numbers == list(range(0, first, 400))
        assert count == 1
        assert named.startswith("client ")
        on.end_walk()
        on.begin_walk(BEGAN_S, BEGAN_S)
        latest = received(good, until="running")[-1]
        while latest["walk"] != "running" or latest["samples"]:  # those of the walk before
            latest = received(good, until="running")[-1]
        assert (latest["closed"], latest["latest_closed"]) == (0, "")


@pytest.mark.skipif(os.name == "nt", reason="file descriptors are counted as POSIX has them")
def test_ten_thousand_connections_take_no_files_and_no_sample(on: LiveOutput) -> None:
    with client(on) as good:
        good.recv(timeout=PATIENCE_S)
        before = open_files()
        held: list[socket.socket] = []
        most = 0
        for k in range(10_000):
            one = socket.socket()
            one.setblocking(False)
            one.connect_ex(("127.0.0.1", on.port))
            held.append(one)
            if len(held) > 200:
                held.pop(0).close()
            if k % 500 == 499:
                most = max(most, open_files() - len(held))
        send(on, walk(100))
        assert len(of_kind(received(good), "angles")) == 4 * 17
        assert most <= before + MOST_CONNECTIONS + 6 * BACKLOG  # those on their way out
        for one in held:
            one.close()


def open_files() -> int:
    """How many file descriptors this process has."""
    import resource  # not there on Windows

    most = min(resource.getrlimit(resource.RLIMIT_NOFILE)[0], 4096)
    count = 0
    for number in range(most):
        with suppress(OSError):
            os.fstat(number)
            count += 1
    return count


def test_what_cannot_be_sent_in_time_is_dropped_and_counted(on: LiveOutput, monkeypatch: pytest.MonkeyPatch) -> None:
    """The estimator's thread goes on whatever happens to the one that sends."""
    may_go_on, write = threading.Event(), messages.angles

    def held_up(*args: Any) -> str:
        may_go_on.wait(PATIENCE_S)
        return write(*args)

    monkeypatch.setattr(messages, "angles", held_up)
    chunks = walk(6 * (MOST_WAITING + 50))
    with client(on) as one:
        one.recv(timeout=PATIENCE_S)
        on.begin_walk(BEGAN_S, BEGAN_S)
        for chunk in chunks:
            on.take(chunk)
        may_go_on.set()
        on.end_walk()
        found = received(one)
    last = of_kind(found, "status")[-1]
    sent = sum(len(m["deg"]) for m in of_kind(found, "angles")) + len(of_kind(found, "event"))
    assert last["dropped"] > 0
    assert sent + last["dropped"] == sum(chunk.samples for chunk in chunks)
