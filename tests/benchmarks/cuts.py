"""Sessions in which nothing differs: one walk cut into parts that are given as conditions."""

from dataclasses import replace

import numpy as np

from core.session import Recording, RecordingKind, Session
from tests.core.cut_blocks import part_of

NAMES = "ABCDEF"


def cut(session: Session, parts: int) -> Session:
    """The session with every walk cut into parts of equal length, the first called A, the second B, and so on."""
    recordings: list[Recording] = []
    for recording in session.recordings:
        if recording.kind is not RecordingKind.WALKING:
            recordings.append(recording)
            continue
        stamps = [block.time_s for block in recording.imu.values() if len(block)]
        first_s, last_s = max(float(t[0]) for t in stamps), min(float(t[-1]) for t in stamps)
        edges_s = np.linspace(first_s, last_s, parts + 1)
        for letter, from_s, to_s in zip(NAMES, edges_s[:-1], edges_s[1:], strict=False):
            name = f"{recording.name} {letter}"
            imu = {site: part_of(block, from_s, to_s) for site, block in recording.imu.items()}
            recordings.append(
                replace(recording, name=name, folder=name.replace(" ", "_"), imu=imu, condition=letter, left_out_s={})
            )
    return replace(session, recordings=tuple(recordings))
