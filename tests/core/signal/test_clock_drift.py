"""Tests that a clock that runs away from its adjacent ones' is found in a walk. None is found where all keep time."""

from dataclasses import replace

import pytest

from core.body import Site
from core.samples import RateKind
from core.session import Session
from core.signal.clock_drift import about_clocks, clock_drifts
from core.signal.sensors import SensorTracks
from devices.simulation.walker import Tissue, Walk, WalkerSettings
from tests.simulated import session_of

LEFT = (Site.LEFT_THIGH, Site.LEFT_SHANK, Site.LEFT_FOOT)


def walked(tissue: Tissue, seed: int, sites: tuple[Site, ...] = LEFT, strides: int = 20) -> Session:
    return session_of(WalkerSettings(seed=seed, recordings=(Walk(strides=strides),), tissue=tissue, sites=sites))


def with_fast_clock(session: Session, site: Site, share: float) -> Session:
    (walk,) = session.recordings
    block = walk.imu[site]
    stamps = block.time_s[0] + (1 + share) * (block.time_s - block.time_s[0])
    return replace(session, recordings=(replace(walk, imu={**walk.imu, site: replace(block, time_s=stamps)}),))


def drifts(session: Session) -> dict[str, float]:
    tracks = SensorTracks(session, session.recordings, frozenset(), RateKind.INSTANTANEOUS)
    found = about_clocks(clock_drifts(tracks))
    assert {f.key for f in found} <= {"clock_drifts"}
    return {f.where: float(f.numbers["drift_percent"]) for f in found}


@pytest.mark.endurance
@pytest.mark.parametrize("site", LEFT)
@pytest.mark.parametrize("share", [0.02, -0.01])
def test_a_clock_that_runs_away_is_named(site: Site, share: float) -> None:
    found = drifts(with_fast_clock(walked(Tissue.SOFT, 1), site, share))
    assert found == {f"walk 1, {site}": pytest.approx(100 * share, abs=0.2)}


def test_of_two_clocks_the_distal_one_is_named() -> None:
    session = with_fast_clock(walked(Tissue.RIGID, 2, LEFT[:2]), Site.LEFT_SHANK, 0.02)
    assert drifts(session) == {"walk 1, left_shank": pytest.approx(2.0, abs=0.2)}


@pytest.mark.endurance
@pytest.mark.parametrize("tissue", list(Tissue))
@pytest.mark.parametrize("strides", [3, 8, 20])
def test_clocks_that_keep_time_are_left_alone(tissue: Tissue, strides: int) -> None:
    assert not drifts(walked(tissue, 3, strides=strides))
