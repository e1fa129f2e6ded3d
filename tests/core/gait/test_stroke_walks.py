"""Tests that all strides of people after a stroke are found, none invented, and nearly all used.

How many contacts a reader counts in the plotted pitch, speed, vertical acceleration and shank rate of each foot; a
swing that the recording cuts at either end does not count.
"""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from core.body import Segment, Side, Site
from core.calibration.rest import rest_of
from core.gait.events import FootEvents, gait_of
from core.gait.shank import gait_of_shank
from core.gait.strides import strides_of
from core.samples import ImuBlock, RateKind
from core.signal.orientation import oriented
from core.signal.pair import OrientedTrack
from core.signal.tracks import even_tracks
from devices.files.session_folder import read_session

COUNTED = {
    "stroke01": {Side.LEFT: 31, Side.RIGHT: 31},
    "stroke02": {Side.LEFT: 63, Side.RIGHT: 63},
    "stroke03": {Side.LEFT: 62, Side.RIGHT: 63},
    "stroke04": {Side.LEFT: 61, Side.RIGHT: 60},
    "stroke05": {Side.LEFT: 53, Side.RIGHT: 53},
    "stroke06": {Side.LEFT: 54, Side.RIGHT: 54},
}
DEFAULT = ("stroke01", "stroke03")  # the feet that hardly roll


def oriented_block(block: ImuBlock) -> OrientedTrack:
    (track,) = even_tracks(block)
    rest = rest_of(block)
    return oriented(track, RateKind.INSTANTANEOUS, rest.gyr_rad_s if rest is not None else np.zeros(3))


def events_of(folder: Path, side: Side) -> tuple[FootEvents, FootEvents]:
    """From the foot and from the shank."""
    (walk,) = read_session(folder).recordings
    foot, shank = (oriented_block(walk.imu[Site(f"{side}_{segment}")]) for segment in (Segment.FOOT, Segment.SHANK))
    return gait_of(foot), gait_of_shank(shank)


@pytest.mark.parametrize("side", list(Side))
@pytest.mark.parametrize(
    "name", [name if name in DEFAULT else pytest.param(name, marks=pytest.mark.endurance) for name in COUNTED]
)
def test_what_a_reader_counts_is_found_and_used(test_data: Callable[[str], Path], name: str, side: Side) -> None:
    found, of_shank = events_of(test_data("stroke_treadmill") / name, side)
    assert len(found) == COUNTED[name][side]
    assert np.all(np.diff(found.initial_contact_s) > 0.6)
    # the shank, by other equations, reports each of them as well, but for one at either end
    inner = found.initial_contact_s[1:-1]
    apart_s = np.abs(of_shank.initial_contact_s[:, None] - inner).min(axis=0)
    assert np.mean(apart_s < 0.3) > 0.95
    strides = strides_of([found])
    assert np.mean(strides.is_used) >= 0.85
    known = strides.stance_percent[strides.is_used]
    assert np.isfinite(known).all()
    assert np.all((known > 35.0) & (known < 90.0))
