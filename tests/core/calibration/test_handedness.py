"""An accelerometer is called reversed only where its joint agrees better with it negated."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from core.body import Site
from core.samples import FloatArray, ImuBlock
from core.session import Recording, RecordingKind, Session
from core.verdicts.quality import look_at
from devices.simulation.walker_sensors import acceleration, angular_rate
from tests.core.recorded_joints import recorded_mechanisms, recorded_people

FindData = Callable[[str], Path]
THIGH, SHANK = Site.LEFT_THIGH, Site.LEFT_SHANK
STEP_S = 0.01
PIECE_S = 20.0


def reversed_in(session: Session) -> list[str]:
    return [found.where for found in look_at(session).findings if found.key == "acc_reversed"]


def worn(turn: Rotation, place_m: FloatArray, sensor: str) -> ImuBlock:
    """A sensor on a segment, 0.2 m from the joint, whose place over time is `place_m` (n, 3)."""
    rotations = turn.as_matrix()
    force = acceleration(place_m + rotations @ np.array([0.0, 0.05, -0.2]), STEP_S) + np.array([0.0, 0.0, 9.81])
    return ImuBlock(
        sensor,
        STEP_S * np.arange(len(rotations)),
        angular_rate(rotations, STEP_S),
        np.einsum("nji,nj->ni", rotations, force),
    )


@pytest.fixture(scope="module")
def two_axes() -> Session:
    """A joint moved by hand that bends, and twists about the vertical: its segments turn against each other."""
    t = STEP_S * np.arange(2000)
    bend, twist = 0.5 * np.sin(2.9 * t), 0.7 * np.sin(1.7 * t) + 0.3 * np.sin(3.1 * t)
    sway = 0.2 * np.sin(2.3 * t)
    one = Rotation.from_euler("ZYX", np.stack([twist, bend, sway], axis=1))
    other = Rotation.from_euler("ZYX", np.stack([-0.8 * twist, -bend, 0.5 * sway], axis=1))
    place_m = 0.1 * np.stack([np.sin(2.0 * t), np.cos(1.6 * t), np.sin(2.7 * t)], axis=1)
    imu = {THIGH: worn(one, place_m, "one"), SHANK: worn(other, place_m, "other")}
    return Session((Recording("by hand", RecordingKind.FREE_MOTION, "by_hand", imu),))


def test_a_joint_of_two_axes_whose_segments_turn_apart_is_not_refused(two_axes: Session) -> None:
    assert reversed_in(two_axes) == []


def negated(session: Session, *sites: Site) -> Session:
    recordings = []
    for recording in session.recordings:
        imu = {s: replace(b, acc_m_s2=-b.acc_m_s2) if s in sites else b for s, b in recording.imu.items()}
        recordings.append(replace(recording, imu=imu))
    return replace(session, recordings=tuple(recordings))


def pieces(session: Session) -> Iterator[Session]:
    """The recordings, and each twenty seconds of them."""
    yield session
    for recording in session.recordings:
        first_s = min(float(block.time_s[0]) for block in recording.imu.values())
        last_s = max(float(block.time_s[-1]) for block in recording.imu.values())
        for from_s in np.arange(first_s, last_s - 0.5 * PIECE_S, PIECE_S):
            imu = {site: part(block, from_s, from_s + PIECE_S) for site, block in recording.imu.items()}
            yield replace(session, recordings=(replace(recording, imu=imu),))


def part(b: ImuBlock, from_s: float, to_s: float) -> ImuBlock:
    return b.select((b.time_s >= from_s) & (b.time_s < to_s))


def test_no_recorded_mechanism_is_refused(test_data: FindData) -> None:
    """The third piece of the one with two axes was."""
    assert [name for name, s in recorded_mechanisms(test_data) for one in pieces(s) if reversed_in(one)] == []


@pytest.mark.endurance
def test_no_recorded_person_is_refused(test_data: FindData) -> None:
    assert [name for name, s in recorded_people(test_data) for one in pieces(s) if reversed_in(one)] == []


@pytest.mark.endurance
def test_recorded_people_with_one_accelerometer_reversed_are_refused(test_data: FindData) -> None:
    """Where they turn enough to show it."""
    shanks = Site.LEFT_SHANK, Site.RIGHT_SHANK
    found = {name: reversed_in(negated(session, *shanks)) for name, session in recorded_people(test_data)}
    assert {name for name, where in found.items() if not where} <= {"stroke03"}
