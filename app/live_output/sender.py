"""The thread that sends the running walk to the outlets that are on."""

import asyncio
import errno
import logging
import threading
import time
from collections import deque
from collections.abc import Callable, Coroutine
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from app.live_output import messages
from app.live_output.chunks import LiveChunk, LiveStreams
from app.live_output.lsl_outlets import LslOutlets
from app.live_output.status import NO_WALK, NONE, RUNNING, OutputRefusedError, OutputSettings
from core.body import Joint
from core.samples import FloatArray
from devices.live import SourceRefusedError

if TYPE_CHECKING:
    from app.live_output.web_socket import WebSocketServer

MOST_WAITING = 200  # updates that are not sent yet: six seconds
STATUS_EVERY_S = 1.0
CLOSE_S = 5.0

_log = logging.getLogger(__name__)


def open_sender(settings: OutputSettings) -> "tuple[Sender | None, dict[str, OutputRefusedError]]":
    """Open what is switched on; None where nothing could be, and why, by "lsl" and "websocket"."""
    trouble: dict[str, OutputRefusedError] = {}
    lsl, server, sockets = None, None, []
    if settings.has_lsl:
        try:
            lsl = LslOutlets()
        except SourceRefusedError as problem:
            other = str(problem.values.get("other", ""))
            trouble["lsl"] = OutputRefusedError("" if other else "lsl", other)
    if settings.has_websocket:
        try:
            from app.live_output import web_socket  # does without an extra

            sockets, server = web_socket.listening_sockets(settings.port), web_socket.WebSocketServer
        except ImportError:
            trouble["websocket"] = OutputRefusedError("live")
        except OSError as problem:
            _log.warning("live output: port %d: %s", settings.port, errno.errorcode.get(problem.errno or 0, "?"))
            trouble["websocket"] = OutputRefusedError(is_port_taken=True)
    is_on = lsl is not None or server is not None
    return (Sender(lsl, server, sockets) if is_on else None), trouble


class Sender:
    """What it is asked to do it does in that order. `port`: of the WebSocket; `status`: as it left last."""

    def __init__(
        self, lsl: LslOutlets | None, make: "Callable[..., WebSocketServer] | None", sockets: list[Any]
    ) -> None:
        self.lsl = lsl
        self.port = sockets[0].getsockname()[1] if sockets else 0
        self.status = NO_WALK
        self._server = make(sockets, self._welcome) if make is not None else None
        self._begun_s = time.monotonic()
        self._streams: LiveStreams | None = None
        self._from_s: float | None = None  # of the walk that goes on, on the acquisition's clock
        self._own_offset_s = self._lsl_offset_s = 0.0  # of the clocks of the stamps against it
        self._sent: dict[Joint, int] = {}
        self._latest_s: dict[Joint, float] = {}
        self._waiting: deque[Callable[[], None]] = deque()
        self.dropped = 0  # written by the estimator's thread alone
        self._dropped_before = 0
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._run, name="live output", daemon=True)
        self._thread.start()

    # from other threads

    def do(self, what: Callable[[], None]) -> None:
        self._waiting.append(what)
        self._loop.call_soon_threadsafe(self._work)

    def take(self, chunk: LiveChunk) -> None:
        if len(self._waiting) >= MOST_WAITING:
            self.dropped += chunk.samples
        else:
            try:
                self.do(partial(self._send, chunk))
            except RuntimeError:  # it is being closed
                self.dropped += chunk.samples

    def close(self) -> None:
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(CLOSE_S)

    # on its own

    def _run(self) -> None:
        loop = self._loop
        asyncio.set_event_loop(loop)
        tasks = [loop.create_task(self._state_again())]
        if self._server is not None:
            tasks.append(loop.create_task(self._server.open()))
        loop.run_forever()
        for task in tasks:
            task.cancel()
        last: list[Coroutine[Any, Any, Any]] = [] if self._server is None else [self._server.close()]
        loop.run_until_complete(asyncio.gather(*tasks, *last, return_exceptions=True))
        if self.lsl is not None:
            self.lsl.close_streams()
        loop.run_until_complete(loop.shutdown_asyncgens())
        loop.close()

    def _work(self) -> None:
        while self._waiting:
            what = self._waiting.popleft()
            try:
                what()
            except Exception:  # the thread's edge: the walk is recorded all the same
                _log.exception("the live output failed")

    async def _state_again(self) -> None:
        while True:
            self._state()
            await asyncio.sleep(STATUS_EVERY_S)

    def open_streams(self, streams: LiveStreams) -> None:
        self._streams = streams
        self.status = replace(self.status, simulated=streams.is_simulated)
        if self.lsl is not None:
            self.lsl.open_streams(streams)
        self._line(messages.hello(streams))

    def close_streams(self) -> None:
        self._streams = self._from_s = None
        self.status = NO_WALK
        if self.lsl is not None:
            self.lsl.close_streams()
        self._line(messages.hello(None))
        self._state()

    def begin_walk(self, began_s: float, offset_s: float, dropped_before: int) -> None:
        """`offset_s`: of the machine's clock against the acquisition's."""
        self._from_s, self._own_offset_s = began_s, offset_s - self._begun_s
        if self.lsl is not None:
            self._lsl_offset_s = offset_s + self.lsl.now_s() - time.monotonic()
        self._sent, self._latest_s = {}, {}
        self._dropped_before = dropped_before
        if self._server is not None:
            self._server.closed, self._server.latest_closed = 0, ""
        self.status = replace(NO_WALK, walk=RUNNING, simulated=self.status.simulated)
        self._state()

    def end_walk(self) -> None:
        self._from_s = None
        self.status = replace(self.status, walk=NONE)
        self._state()

    def _send(self, chunk: LiveChunk) -> None:
        if (from_s := self._from_s) is None:
            return
        for joint, samples in chunk.angles.items():
            new = samples.since(from_s)
            if len(new):
                first = self._sent.get(joint, 0)
                self._sent[joint] = first + len(new)
                time_s = self._in_order(joint, new.time_s)
                if self.lsl is not None:
                    self.lsl.send_angles(joint, time_s + self._lsl_offset_s, new)
                if self._clients:
                    self._line(messages.angles(joint, first, time_s + self._own_offset_s, new))
        events = self.status.events
        for mark in chunk.events:
            if mark.time_s >= from_s:
                if self.lsl is not None:
                    self.lsl.send_event(mark, mark.time_s + self._lsl_offset_s)
                self._line(messages.event(mark, events, self._own_offset_s))
                events += 1
        self.status = replace(
            self.status,
            samples=sum(self._sent.values()),
            events=events,
            missing=tuple(site.value for site in chunk.missing),
            doubtful_feet=tuple(side.value for side in chunk.doubtful),
        )

    def _in_order(self, joint: Joint, time_s: FloatArray) -> FloatArray:
        """A clock that is fitted again may step back by a little: no stamp is earlier than the one before."""
        ordered = np.maximum.accumulate(np.maximum(time_s, self._latest_s.get(joint, -np.inf)))
        self._latest_s[joint] = float(ordered[-1])
        return ordered

    @property
    def _clients(self) -> int:
        return 0 if self._server is None else self._server.clients

    def _state(self) -> None:
        dropped = self.dropped - self._dropped_before
        self.status = replace(self.status, dropped=dropped, clients=self._clients)
        if self._server is not None:
            closed, latest = self._server.closed, self._server.latest_closed
            self.status = replace(self.status, closed=closed, latest_closed=latest)
        line = messages.status(self.status)
        if self.lsl is not None:
            self.lsl.send_status(line)
        self._line(line)

    def _welcome(self) -> list[str]:
        return [messages.hello(self._streams), messages.status(self.status)]

    def _line(self, line: str) -> None:
        if self._server is not None:
            self._server.send(line)
