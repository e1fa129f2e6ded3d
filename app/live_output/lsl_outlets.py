"""Streams of Lab Streaming Layer: one for each joint, one of the feet's events, one of the status.

The library names this computer in every stream by itself and listens to all networks of the computer; what can be set
is that nobody is led here who searches from another computer. The manual has both.
"""

from types import ModuleType
from typing import Any

import numpy as np

from app.live_output.chunks import STATUSES, AngleChunk, EventMark, LiveStreams
from core.body import Joint
from core.samples import FloatArray
from devices.drivers.lsl import library_for
from devices.transport.networks import THIS_COMPUTER

NAME = "Gaitwright"
BUFFER_S = 30  # for one who receives late; what is older is lost to them


class LslOutlets:
    """Works on one thread. Raises SourceRefusedError where the library is not there or searches another network."""

    def __init__(self) -> None:
        self._pylsl: ModuleType = library_for(THIS_COMPUTER)
        self._streams: LiveStreams | None = None
        self._joints: dict[Joint, Any] = {}
        self._events: Any = None
        self._status: Any = None

    def now_s(self) -> float:
        """The clock of the stamps."""
        return float(self._pylsl.local_clock())

    def open_streams(self, streams: LiveStreams) -> None:
        """Offer these; those that are offered already stay, with whoever receives them."""
        if self._streams is None or self._streams.is_simulated != streams.is_simulated:
            self.close_streams()
            self._events = self._outlet("events", "Markers", ["event"], 0.0, "string", streams)
            self._status = self._outlet("status", "Status", ["status"], 0.0, "string", streams)
        for joint in self._joints.keys() - streams.rates_hz.keys():
            del self._joints[joint]
        for joint, rate_hz in streams.rates_hz.items():
            if joint not in self._joints:
                labels = [f"{joint}_deg", f"{joint}_sd_deg", f"{joint}_status"]
                self._joints[joint] = self._outlet(joint.value, "JointAngle", labels, rate_hz, "float32", streams)
        self._streams = streams

    def close_streams(self) -> None:
        self._joints = {}
        self._events = self._status = self._streams = None

    def send_angles(self, joint: Joint, time_s: FloatArray, chunk: AngleChunk) -> None:
        """`time_s`: (n,), on the clock of the stamps."""
        if (outlet := self._joints.get(joint)) is not None:
            rows = np.column_stack([chunk.angle_deg, chunk.sd_deg, chunk.status])
            outlet.push_chunk(rows.astype(np.float32), time_s.tolist())

    def send_event(self, mark: EventMark, time_s: float) -> None:
        if self._events is not None:
            self._events.push_sample([f"{mark.side}_{mark.event}"], time_s)

    def send_status(self, line: str) -> None:
        if self._status is not None:
            self._status.push_sample([line], self.now_s())

    def _outlet(
        self, what: str, kind: str, labels: list[str], rate_hz: float, number: str, streams: LiveStreams
    ) -> Any:
        info = self._pylsl.StreamInfo(f"{NAME} {what}", kind, len(labels), rate_hz, number, f"{NAME}-{what}".lower())
        desc = info.desc()
        desc.append_child_value("manufacturer", NAME)
        desc.append_child_value("simulated", "yes" if streams.is_simulated else "no")
        if number != "string":
            desc.append_child_value("positive", "flexion" if "knee" in what else "dorsiflexion")
            desc.append_child_value("status", ", ".join(f"{k} {one.value}" for k, one in enumerate(STATUSES)))
        channels = desc.append_child("channels")
        for label in labels:
            channel = channels.append_child("channel")
            channel.append_child_value("label", label)
            channel.append_child_value("unit", "deg" if label.endswith("_deg") else "none")
        return self._pylsl.StreamOutlet(info, max_buffered=BUFFER_S)
