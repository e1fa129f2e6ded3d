"""The live output is off until somebody switches it on, and what leaves names nobody."""

import socket
import sys
import threading

import pytest

import app.live_output
from app.live_output.output import LiveOutput
from app.live_output.status import OutputSettings
from app.live_output.words import output_words
from tests.app.live_output.known_walk import BEGAN_S, STREAMS, walk


def threads() -> list[str]:
    return [one.name for one in threading.enumerate() if one.name == "live output"]


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch) -> list[object]:
    """Every socket that is made."""
    opened: list[object] = []
    make = socket.socket.__init__

    def watched(self: socket.socket, *args: object, **kwargs: object) -> None:
        opened.append(self)
        make(self, *args, **kwargs)  # type: ignore[arg-type]  # whatever it is given

    monkeypatch.setattr(socket.socket, "__init__", watched)
    return opened


def test_it_is_off_at_first_and_opens_no_socket(output: LiveOutput, opened: list[object]) -> None:
    assert not output.is_on
    output.set_up(OutputSettings())
    output.open_streams(STREAMS)
    output.begin_walk(BEGAN_S, BEGAN_S)
    for chunk in walk(100):
        output.take(chunk)
    output.end_walk()
    output.close_streams()
    assert opened == []
    assert threads() == []
    assert output_words(output) == ""


def test_the_watch_on_sockets_sees_those_that_are_opened(output: LiveOutput, opened: list[object]) -> None:
    output.set_up(OutputSettings(has_websocket=True, port=0))
    assert opened
    assert threads() == ["live output"]
    assert output_words(output) == "Live output is on: WebSocket (0 connected)."
    output.stop()
    assert threads() == []


def test_while_sensors_store_the_walk_it_states_that_nothing_is_sent(output: LiveOutput) -> None:
    assert output_words(output, is_in_memory=True) == ""
    output.set_up(OutputSettings(has_websocket=True, port=0))
    assert output_words(output, is_in_memory=True) == ("Live output: nothing is sent while the sensors store the walk.")


def test_without_the_library_the_websocket_names_what_to_install(
    output: LiveOutput, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "app.live_output.web_socket", None)
    monkeypatch.delattr(app.live_output, "web_socket", raising=False)  # where another test has loaded it
    output.set_up(OutputSettings(has_websocket=True, port=8765))
    assert not output.is_on
    assert "gaitwright[live]" in output_words(output)


def test_a_port_that_is_taken_is_stated(output: LiveOutput) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        output.set_up(OutputSettings(has_websocket=True, port=port))
    assert output_words(output) == (f"Live output is off: Another program uses port {port}. Enter another port.")
