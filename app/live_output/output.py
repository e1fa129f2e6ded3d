"""Hand the running walk to the outlets that are on, without holding up whoever measures or shows it.

The estimator's thread puts what it has into a bounded queue and goes on; a thread of its own sends. Where that falls
behind, samples are dropped and counted, and the count leaves with the status.
"""

import time
from functools import partial
from typing import TYPE_CHECKING

from app.live_output.status import NO_WALK, OutputRefusedError, OutputSettings, Status

if TYPE_CHECKING:
    from app.live_output.chunks import LiveChunk, LiveStreams
    from app.live_output.sender import Sender


class LiveOutput:
    """Off until `set_up`: no thread, no socket. All but `take` are the window's thread's, `take` the estimator's.

    Attributes
    ----------
    settings
        What is switched on.
    trouble
        Why one of them is off all the same, by "lsl" and "websocket".
    """

    def __init__(self) -> None:
        self.settings = OutputSettings()
        self.trouble: dict[str, OutputRefusedError] = {}
        self._sender: Sender | None = None
        self._streams: LiveStreams | None = None

    @property
    def is_on(self) -> bool:
        return self._sender is not None

    @property
    def has_lsl(self) -> bool:
        return self._sender is not None and self._sender.lsl is not None

    @property
    def port(self) -> int:
        """Of the WebSocket; 0 while it is off."""
        return 0 if self._sender is None else self._sender.port

    @property
    def status(self) -> Status:
        """As it left last."""
        return NO_WALK if self._sender is None else self._sender.status

    def set_up(self, settings: OutputSettings) -> None:
        """Switch on and off as these ask; what is wrong is in `trouble`."""
        if settings == self.settings:
            return
        self.stop()
        self.settings = settings
        if settings.has_lsl or settings.has_websocket:
            from app.live_output.sender import open_sender  # a start without what nobody has switched on

            self._sender, self.trouble = open_sender(settings)
        if self._sender is not None and self._streams is not None:
            self._sender.do(partial(self._sender.open_streams, self._streams))

    def stop(self) -> None:
        """Switch all off; sockets are closed when it returns."""
        sender, self._sender = self._sender, None
        self.settings, self.trouble = OutputSettings(), {}
        if sender is not None:
            sender.close()

    def open_streams(self, streams: "LiveStreams") -> None:
        """Offer the streams of a patient who may walk soon."""
        self._streams = streams
        if (sender := self._sender) is not None:
            sender.do(partial(sender.open_streams, streams))

    def close_streams(self) -> None:
        self._streams = None
        if (sender := self._sender) is not None:
            sender.do(sender.close_streams)

    def begin_walk(self, began_s: float, now_s: float) -> None:
        """Send what is measured from `began_s` on; it is `now_s` on the acquisition's clock."""
        if (sender := self._sender) is not None:
            sender.do(partial(sender.begin_walk, began_s, time.monotonic() - now_s, sender.dropped))

    def end_walk(self) -> None:
        if (sender := self._sender) is not None:
            sender.do(sender.end_walk)

    def take(self, chunk: "LiveChunk") -> None:
        """Take what is new and return at once."""
        if (sender := self._sender) is not None:
            sender.take(chunk)


live_output = LiveOutput()
