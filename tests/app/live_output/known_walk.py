"""A walk of chunks whose every sample is known: its number is its angle."""

import numpy as np

from app.live_output.chunks import AngleChunk, EventMark, LiveChunk, LiveStreams, angle_chunk
from core.body import LEG_JOINTS, Joint, Side
from core.gait.live import FootEvent
from core.verdicts.model import Verdict

RATE_HZ = 200.0
STREAMS = LiveStreams(dict.fromkeys(LEG_JOINTS, RATE_HZ), tuple(Side), is_simulated=True)
BEGAN_S = 10.0


def samples(first: int, count: int, verdict: Verdict = Verdict.CARE) -> AngleChunk:
    """Samples whose angle is their number in degrees, from `BEGAN_S` on."""
    number = np.arange(first, first + count, dtype=float)
    return angle_chunk(BEGAN_S + number / RATE_HZ, np.deg2rad(number), np.deg2rad(np.full(count, 1.5)), verdict)


def walk(count: int, each: int = 6, joints: tuple[Joint, ...] = LEG_JOINTS) -> list[LiveChunk]:
    """`count` samples of each joint, `each` at a time, with an event every hundred."""
    chunks = []
    for first in range(0, count, each):
        angles = {joint: samples(first, min(each, count - first)) for joint in joints}
        marks = []
        for number in range(first, min(first + each, count)):
            if number % 100 == 0:
                side, event = list(Side)[number // 100 % 2], FootEvent.INITIAL_CONTACT
                time_s = BEGAN_S + number / RATE_HZ
                marks.append(EventMark(side, event, time_s, time_s))
        chunks.append(LiveChunk(angles, tuple(marks)))
    return chunks
