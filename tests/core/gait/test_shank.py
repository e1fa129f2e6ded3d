"""Tests that landings and leavings are found from the shank alone, and that it is stated that they are."""

from dataclasses import replace

import numpy as np
import pytest

from core.body import Side, Site
from core.gait.events import FootEvents
from core.gait.phases import PHASES, Phase, phases_at
from core.gait.shank import gait_of_shank
from core.gait.strides import strides_of
from devices.simulation.walker import Standing, Tissue, Walk, WalkerSettings
from devices.simulation.walker_motion import TrueFootEvents
from tests.core.gait.feet import foot_of
from tests.core.standing import bias_of
from tests.simulated import simulation_of

SHANK = Site.RIGHT_SHANK


def events_of(settings: WalkerSettings) -> tuple[FootEvents, TrueFootEvents]:
    made = simulation_of(replace(settings, sites=(SHANK,)))
    standing, moving = made.session.recordings
    found = gait_of_shank(foot_of(moving.imu[SHANK], bias_of(standing.imu[SHANK])))
    return found, made.truth.recordings[moving.name].feet[Side.RIGHT].events


@pytest.mark.endurance
@pytest.mark.parametrize("tissue", [Tissue.RIGID, Tissue.SOFT])
@pytest.mark.parametrize(("speed_m_s", "rate_hz"), [(0.3, 100.0), (1.19, 60.0), (2.0, 200.0)])
def test_contact_and_toe_off_are_found_from_the_shank(speed_m_s: float, rate_hz: float, tissue: Tissue) -> None:
    recordings = (Standing(), Walk(speed_m_s=speed_m_s))
    found, truth = events_of(WalkerSettings(seed=6, recordings=recordings, rate_hz=rate_hz, tissue=tissue))
    assert len(found) == len(truth.toe_off_s)
    for ours, true in (
        (found.initial_contact_s, truth.initial_contact_s),
        (found.toe_off_s, truth.toe_off_s),
    ):
        error = (ours - true)[1:-1]
        assert np.std(error) < 0.010
        assert abs(np.mean(error)) < 0.040
    assert found.is_from_shank


def test_what_a_shank_cannot_show_stays_unknown() -> None:
    found, _ = events_of(WalkerSettings(recordings=(Standing(), Walk())))
    strides = strides_of([found])
    assert strides.is_used.any()
    assert np.isnan(strides.length_m).all()
    assert np.isnan(found.heel_rise_s).all()
    phases = phases_at(np.linspace(0.0, 12.0, 500), [found])
    assert {PHASES[k] for k in phases} == {Phase.UNKNOWN, Phase.SWING}


def test_a_turn_is_seen_by_the_shank() -> None:
    found, _ = events_of(WalkerSettings(recordings=(Standing(), Walk(turn_rad=-np.pi / 2, strides=12))))
    assert np.sum(found.turn_rad) == pytest.approx(-np.pi / 2, abs=0.15)


def test_standing_has_no_events() -> None:
    found, _ = events_of(WalkerSettings(recordings=(Standing(), Standing("still", duration_s=8.0))))
    assert len(found) == 0
