"""A person's joint is never called a hinge, however long the person rests; a hinge stays one."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from core.analysis import analyse
from core.body import LEG_SITES, Side
from core.results import Analysis
from core.samples import ImuBlock
from core.session import Session
from devices.simulation.walker import Standing, Tissue, Walk, WalkerSettings
from tests.core.recorded_joints import recorded_people
from tests.simulated import session_of

LEFT = tuple(site for site in LEG_SITES if site.side is Side.LEFT)


def rested(tissue: Tissue, seed: int) -> Session:
    """Two short walks in one recording, with half a minute of standing between them."""
    settings = WalkerSettings(seed, (Standing(), Walk(strides=3, standing_after_s=30.0)), LEFT, tissue)
    session = session_of(settings)
    walk = session.recordings[-1]
    imu = {site: twice(block) for site, block in walk.imu.items()}
    return replace(session, recordings=(*session.recordings[:-1], replace(walk, imu=imu)))


def twice(b: ImuBlock) -> ImuBlock:
    time_s = np.concatenate([b.time_s, b.time_s + b.time_s[-1] - b.time_s[0] + 0.01])
    return replace(b, time_s=time_s, gyr_rad_s=np.tile(b.gyr_rad_s, (2, 1)), acc_m_s2=np.tile(b.acc_m_s2, (2, 1)))


def hinges(found: Analysis) -> list[str]:
    return [str(joint) for one in found.calibrations for joint, c in one.joints.items() if c.is_hinge]


@pytest.mark.parametrize("tissue", [Tissue.SOFT, Tissue.REAL])
def test_a_person_who_rests_between_two_walks_has_no_hinge(tissue: Tissue) -> None:
    assert hinges(analyse(rested(tissue, seed=1))) == []


def test_a_hinge_that_rests_for_most_of_the_time_stays_one() -> None:
    assert hinges(analyse(rested(Tissue.RIGID, seed=1))) == ["left_knee"]


@pytest.mark.endurance
def test_no_joint_of_a_recorded_person_is_a_hinge(test_data: Callable[[str], Path]) -> None:
    assert [name for name, session in recorded_people(test_data) if hinges(analyse(session))] == []
