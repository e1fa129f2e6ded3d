"""Compute one knee by the method of the paper alone, step by step, without the rest of the analysis.

    python -m tests.examples.published_method SESSION

Seel, Raisch and Schauer 2014, doi 10.3390/s140406891: the axes by eqs 3 to 6, their signs by Figure 4, the centres by
eqs 7 to 9, the angle by eq 15. SESSION needs a standing, a free motion and a walk of the left thigh and shank. Printed
are both axes in their sensors' axes and the range of the knee over the walk. Eq 15 has a zero and a sign of its own:
flexion and the zero of standing are what `analyse` adds.
"""

import sys
from pathlib import Path

import numpy as np

from core import (
    OrientedTrack,
    Pair,
    RateKind,
    Recording,
    RecordingKind,
    Session,
    Site,
    even_tracks,
    identify_as_published,
    moving_data,
    oriented,
    pair_up,
    published_angle,
    rest_of,
)
from devices import read_session


def pair_of(recording: Recording, standing: Recording) -> Pair:
    """Both sensors on one clock, each oriented, without the gyroscope's bias, which standing shows."""

    def worn_at(site: Site) -> OrientedTrack:
        rest = rest_of(standing.imu[site])
        assert rest is not None, f"{site} does not lie still in {standing.name}"
        track = even_tracks(recording.imu[site])[0]  # the first stretch without a long gap
        return oriented(track, RateKind.INSTANTANEOUS, rest.gyr_rad_s)

    pair = pair_up(worn_at(Site.LEFT_THIGH), worn_at(Site.LEFT_SHANK), lag_s=0.0)
    assert pair is not None, "the sensors share less than a second"
    return pair


def first(session: Session, kind: RecordingKind) -> Recording:
    return next(recording for recording in session.recordings if recording.kind is kind)


def main(folder: Path) -> None:
    session = read_session(folder)
    standing = first(session, RecordingKind.STANDING)
    moved = moving_data((pair_of(first(session, RecordingKind.FREE_MOTION), standing),))
    assert moved is not None, "the knee hardly moves"
    found = identify_as_published(moved, moved)
    walk = pair_of(first(session, RecordingKind.WALKING), standing)
    angle_rad = published_angle(walk, found.axis_1, found.axis_2, found.centre_1_m, found.centre_2_m)
    print(f"axis in the thigh's sensor {np.round(found.axis_1, 2)}, in the shank's {np.round(found.axis_2, 2)}")
    print(f"range {np.rad2deg(np.ptp(angle_rad)):.1f} deg")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
