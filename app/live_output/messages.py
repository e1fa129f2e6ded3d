"""JSON of the live output: one message a line of text, the same words over the WebSocket and in the status stream."""

import json
from dataclasses import asdict
from typing import Any

import numpy as np

from app.live_output.chunks import STATUSES, AngleChunk, EventMark, LiveStreams
from app.live_output.status import Status
from core.body import Joint
from core.samples import FloatArray

FORMAT = 1
WORDS = np.array([one.value for one in STATUSES])


def hello(streams: LiveStreams | None) -> str:
    """Give what a program has to know before the first sample."""
    described = {
        "program": "Gaitwright",
        "format": FORMAT,
        "clock": "seconds since the live output was switched on",
        "unit": "deg",
        "positive": {"knee": "flexion", "ankle": "dorsiflexion"},
        "status": list(WORDS),
        "simulated": streams is not None and streams.is_simulated,
        "joints": {} if streams is None else {joint.value: rate_hz for joint, rate_hz in streams.rates_hz.items()},
        "feet": [] if streams is None else [side.value for side in streams.feet],
    }
    return _line("hello", described)


def angles(joint: Joint, first: int, time_s: FloatArray, chunk: AngleChunk) -> str:
    """Give samples, the first of which has the number `first` of this joint in this walk; `time_s` as they leave."""
    return _line(
        "angles",
        {
            "joint": joint.value,
            "first": first,
            "time_s": np.round(time_s, 5).tolist(),
            "deg": _figures(chunk.angle_deg),
            "sd_deg": _figures(chunk.sd_deg),
            "status": WORDS[chunk.status].tolist(),
        },
    )


def event(mark: EventMark, number: int, offset_s: float) -> str:
    """Give an event, on the clock that is `offset_s` ahead of the acquisition's."""
    return _line(
        "event",
        {
            "side": mark.side.value,
            "event": mark.event.value,
            "number": number,
            "time_s": round(mark.time_s + offset_s, 5),
            "reported_s": round(mark.reported_s + offset_s, 5),
        },
    )


def status(stated: Status) -> str:
    """Give the status of the stream."""
    return _line("status", asdict(stated))


def _figures(values_deg: FloatArray) -> list[float | None]:
    """Numbers to a hundredth; JSON has no NaN."""
    return [None if value != value else value for value in np.round(values_deg, 2).tolist()]


def _line(kind: str, content: dict[str, Any]) -> str:
    return json.dumps({"type": kind, **content}, separators=(",", ":"), allow_nan=False)
