"""Tests of contacts where the patient turns about and samples are lost.

Those on the straight are found, and none invented.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from core.body import Side, Site
from core.gait.events import FootEvents, gait_of
from core.gait.strides import Reason, strides_of
from core.samples import FloatArray, ImuBlock, RateKind
from core.signal.orientation import oriented
from core.signal.tracks import MAX_BRIDGED_GAP_S, even_tracks
from devices.files.session_folder import read_session
from devices.simulation.walker import Standing, Tissue, Walk, WalkerSettings
from tests.core.standing import bias_of
from tests.simulated import simulation_of

FEET = {Side.LEFT: Site.LEFT_FOOT, Side.RIGHT: Site.RIGHT_FOOT}
SAME_S = 0.05
REACH_S = 1.2  # a contact needs the swing before it and the stance after it


@dataclass
class Count:
    """Contacts that can be known, those of them found, all that were reported, and those of them that were none."""

    known: int = 0
    found: int = 0
    reported: int = 0
    invented: int = 0

    def add(self, reported_s: FloatArray, true_s: FloatArray, is_known: FloatArray, same_s: float = SAME_S) -> None:
        apart_s = np.abs(reported_s[:, None] - true_s)
        self.known += int(np.sum(is_known))
        self.found += int(np.sum(apart_s.min(axis=0, initial=np.inf)[is_known] < same_s))
        self.reported += len(reported_s)
        self.invented += int(np.sum(apart_s.min(axis=1, initial=np.inf) > 2.0 * same_s))


def events_of(block: ImuBlock, bias_rad_s: FloatArray) -> list[FootEvents]:
    return [gait_of(oriented(track, RateKind.INSTANTANEOUS, bias_rad_s)) for track in even_tracks(block)]


def contacts_s(stretches: list[FootEvents]) -> FloatArray:
    return np.concatenate([np.empty(0), *(events.initial_contact_s for events in stretches)])


def is_received(time_s: FloatArray, at_s: FloatArray) -> FloatArray:
    """Around which instants no gap is too long to be bridged."""
    gaps = np.flatnonzero(np.diff(time_s) > MAX_BRIDGED_GAP_S)
    away = (time_s[gaps + 1][:, None] < at_s - REACH_S) | (time_s[gaps][:, None] > at_s + REACH_S)
    return np.asarray(away.all(axis=0))


def without_packets(block: ImuBlock, share: float, rng: np.random.Generator) -> ImuBlock:
    """Without `share` of its samples, in packets of one to six."""
    is_lost = np.zeros(len(block), dtype=bool)
    while np.mean(is_lost) < share:
        start = int(rng.integers(len(block)))
        is_lost[start : start + int(rng.integers(1, 7))] = True
    return block.select(~is_lost)


@pytest.mark.endurance
@pytest.mark.parametrize(
    ("loss", "speed_m_s", "tissue"),
    [
        (0.0, 1.2, Tissue.SOFT),
        (0.05, 1.2, Tissue.REAL),
        *(
            pytest.param(loss, speed_m_s, tissue, marks=pytest.mark.endurance)
            for loss in (0.0, 0.02, 0.05, 0.1)
            for speed_m_s in (0.6, 1.2, 1.8)
            for tissue in Tissue
        ),
    ],
)
def test_contacts_on_the_straight_are_found_and_turns_left_out(loss: float, speed_m_s: float, tissue: Tissue) -> None:
    count = Count()
    walk = Walk(speed_m_s=speed_m_s, strides=18, turn_rad=np.pi)
    for seed in range(2):
        settings = WalkerSettings(seed=seed, recordings=(Standing(), walk), tissue=tissue, loss_fraction=loss)
        made = simulation_of(replace(settings, sites=tuple(FEET.values())))
        standing, walked = made.session.recordings
        for side, site in FEET.items():
            stretches = events_of(walked.imu[site], bias_of(standing.imu[site]))
            true_s = made.truth.recordings[walked.name].feet[side].events.initial_contact_s
            middle_s = 0.5 * (true_s[0] + true_s[-1])
            is_straight = np.abs(true_s - middle_s) > 2.5
            count.add(contacts_s(stretches), true_s, is_straight & is_received(walked.imu[site].time_s, true_s))
            strides = strides_of(stretches)
            in_turn = np.abs(0.5 * (strides.start_s + strides.end_s) - middle_s) < 0.8
            assert not any(strides.is_used[in_turn])
            if loss == 0.0:
                assert strides.reason.count(Reason.TURN) >= 2
    assert count.known > 20
    assert count.found >= count.known - max(1.0, 0.01 * count.known)
    assert count.invented <= max(1.0, 0.01 * count.reported)


@pytest.mark.parametrize(
    "name", ["stroke03", *(pytest.param(f"stroke0{k}", marks=pytest.mark.endurance) for k in (1, 2, 4, 5, 6))]
)
def test_lost_packets_move_no_contact_of_people(test_data: Callable[[str], Path], name: str) -> None:
    (walk,) = read_session(test_data("stroke_treadmill") / name).recordings
    rng = np.random.default_rng(7)
    count = Count()
    for site in FEET.values():
        block = walk.imu[site]
        whole_s = contacts_s(events_of(block, np.zeros(3)))
        for share in (0.02, 0.1):
            lossy = without_packets(block, share, rng)
            found = events_of(lossy, np.zeros(3))
            # a landing of which samples are missing is reported less well, and reports it
            count.add(contacts_s(found), whole_s, is_received(lossy.time_s, whole_s), same_s=0.12)
            sd_s = np.concatenate([events.sd_s[:, 2] for events in found])
            is_measured = np.concatenate([events.is_measured for events in found])
            assert sd_s[~is_measured].min(initial=np.inf) > 0.05
    assert count.known > 80
    assert count.found >= 0.99 * count.known
    assert count.invented <= 0.01 * count.reported
