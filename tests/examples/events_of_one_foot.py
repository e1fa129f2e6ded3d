"""Find the gait events of one foot, from a single sensor strapped to it in any orientation.

    python -m tests.examples.events_of_one_foot SESSION

SESSION needs a standing and a walk of the left foot; no other sensor. Printed is one line per stride: its time, the
share of stance, its length, and why it is not used, if it is not (a start, a stop, a turn); then how many swings.
"""

import sys
from pathlib import Path

import numpy as np

from core import RateKind, RecordingKind, Site, even_tracks, follow, gait_of, oriented, rest_of, strides_of
from devices import read_session

SITE = Site.LEFT_FOOT


def main(folder: Path) -> None:
    recordings = read_session(folder).recordings
    standing, walk = (
        next(recording for recording in recordings if recording.kind is kind)
        for kind in (RecordingKind.STANDING, RecordingKind.WALKING)
    )
    rest = rest_of(standing.imu[SITE])
    bias_rad_s = np.zeros(3) if rest is None else rest.gyr_rad_s
    # a stretch without a long gap on an even clock, then its orientation
    feet = [oriented(track, RateKind.INSTANTANEOUS, bias_rad_s) for track in even_tracks(walk.imu[SITE])]
    strides = strides_of([gait_of(foot) for foot in feet])
    for k, reason in enumerate(strides.reason):
        time_s, stance_percent = strides.time_s[k], strides.stance_percent[k]
        print(f"{time_s:.2f} s, stance {stance_percent:.0f} %, {strides.length_m[k]:.2f} m {reason}".rstrip())
    # what the events are read from: pitch, velocity, path of the foot
    motions = [follow(foot) for foot in feet]
    fastest_m_s = max(float(np.linalg.norm(motion.velocity_m_s, axis=1).max()) for motion in motions)
    print(f"{sum(len(motion.swings) for motion in motions)} swings, the fastest {fastest_m_s:.1f} m/s")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
