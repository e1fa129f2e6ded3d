"""The example page in Chromium, served on this computer: every sample once. Skips without `chromium`."""

import json
import re
import shutil
import subprocess
import threading
import urllib.request
from collections.abc import Iterator
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import pytest
from websockets.sync.client import connect

from app.live_output.output import LiveOutput
from app.live_output.status import OutputSettings
from tests.app.live_output.known_walk import BEGAN_S, STREAMS, walk
from tests.waiting import PATIENCE_S, wait_for

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
PAGE = Path(__file__).parents[2] / "examples" / "live_websocket.html"
COUNT = 1000

pytestmark = [
    pytest.mark.endurance,  # starts a browser
    pytest.mark.skipif(CHROMIUM is None, reason="Chromium is not installed: apt-get install chromium"),
]


class Browser:
    """One page of a Chromium without a window."""

    def __init__(self, profile: Path, page: str) -> None:
        assert CHROMIUM is not None
        options = ["--headless=new", "--no-sandbox", "--disable-gpu", "--remote-debugging-port=0", "--no-first-run"]
        self._process = subprocess.Popen(
            [CHROMIUM, *options, f"--user-data-dir={profile}", page],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        place = profile / "DevToolsActivePort"
        wait_for(lambda: place.exists() and bool(place.read_text().strip()), every_s=0.05)
        self._port = int(place.read_text().split()[0])

    def text(self) -> str:
        """What the page shows now; empty while it is not there yet."""
        with urllib.request.urlopen(f"http://127.0.0.1:{self._port}/json") as answer:
            pages = [one for one in json.load(answer) if one["type"] == "page"]
        if not pages:
            return ""
        with connect(pages[0]["webSocketDebuggerUrl"], proxy=None, max_size=None) as tools:
            ask = {"expression": "document.documentElement.innerText", "returnByValue": True}
            tools.send(json.dumps({"id": 1, "method": "Runtime.evaluate", "params": ask}))
            found: dict[str, Any] = json.loads(tools.recv(timeout=PATIENCE_S))
        return str(found["result"]["result"].get("value", ""))

    def close(self) -> None:
        self._process.terminate()
        self._process.wait(PATIENCE_S)


@pytest.fixture
def on(output: LiveOutput) -> LiveOutput:
    output.set_up(OutputSettings(has_websocket=True, port=0))
    output.open_streams(STREAMS)
    return output


@pytest.fixture
def browser(on: LiveOutput, tmp_path: Path) -> Iterator[Browser]:
    handler = partial(SimpleHTTPRequestHandler, directory=str(PAGE.parent))
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        page = f"http://127.0.0.1:{server.server_port}/{PAGE.name}?port={on.port}"
        browser = Browser(tmp_path / "profile", page)
        yield browser
        browser.close()
        server.shutdown()


def test_the_page_receives_every_sample_and_marks_them_simulated(on: LiveOutput, browser: Browser) -> None:
    wait_for(lambda: "Walk: none, simulated" in browser.text(), every_s=0.1)
    on.begin_walk(BEGAN_S, BEGAN_S)
    for chunk in walk(COUNT):
        on.take(chunk)
    on.end_walk()
    wait_for(lambda: re.search(r"; [1-9]\d* of [1-9]", browser.text()) is not None, every_s=0.1)
    wait_for(lambda: on.status.samples == 4 * COUNT)
    wait_for(lambda: f"{4 * COUNT} of {4 * COUNT} samples, 0 dropped" in browser.text(), every_s=0.1)
    text = browser.text()
    for joint in STREAMS.rates_hz:
        assert re.search(rf"{joint.value}\s+999\.0° ± 1\.5°", text)
    assert "right initial_contact at" in text
