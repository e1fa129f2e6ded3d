"""Do the events of a walking foot come in time, and are they those of the whole walk looked at afterwards?"""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from core.body import Site
from core.calibration.rest import rest_of
from core.gait.events import FootEvents, gait_of
from core.gait.live import MAX_DELAY_S, FootEvent, LiveEvent, LiveEvents
from core.gait.phases import Phase
from core.orientation import oriented
from core.samples import RateKind
from core.tracks import even_tracks
from devices.walker import Standing, Tissue, Walk, WalkerSettings, simulate

FOOT = Site.RIGHT_FOOT
LEARNING_STEPS = 2  # the first teaches the pitch axis, the second the peaks


def both_ways(settings: WalkerSettings, turn: Rotation | None = None) -> tuple[list[LiveEvent], FootEvents]:
    made = simulate(settings)
    standing, walk = (recording.imu[FOOT] for recording in made.session.recordings)
    rest = rest_of(standing)
    assert rest is not None
    (track,) = even_tracks(walk)
    foot = oriented(track, RateKind.INSTANTANEOUS, rest.gyr_rad_s)
    rates = foot.track.gyr_rad_s if turn is None else turn.apply(foot.track.gyr_rad_s)
    live = LiveEvents(track.step_s)
    told = [event for t, rate in zip(track.time_s, rates, strict=True) for event in live.update(float(t), rate)]
    return told, gait_of(foot)


def walking(speed_m_s: float, rate_hz: float, tissue: Tissue) -> WalkerSettings:
    recordings = (Standing(), Walk(speed_m_s=speed_m_s, strides=12))
    return WalkerSettings(seed=2, recordings=recordings, sites=(FOOT,), rate_hz=rate_hz, tissue=tissue)


@pytest.mark.parametrize("tissue", [Tissue.RIGID, Tissue.SOFT])
@pytest.mark.parametrize(
    ("speed_m_s", "rate_hz"), [(0.3, 100.0), (0.6, 60.0), (1.19, 100.0), (2.0, 60.0), (2.0, 200.0)]
)
def test_live_events_are_the_offline_ones_and_in_time(speed_m_s: float, rate_hz: float, tissue: Tissue) -> None:
    told, offline = both_ways(walking(speed_m_s, rate_hz, tissue))
    for event in FootEvent:
        at_s = np.array([e.time_s for e in told if e.event is event])
        # the last step arrives in standing, where landing is slow
        expected = getattr(offline, f"{event.value}_s")[LEARNING_STEPS:-1]
        away = [float(np.min(np.abs(at_s - t))) for t in expected]
        assert max(away) < 0.030, event
        assert len(at_s) <= len(offline), event
    assert max(e.told_s - e.time_s for e in told) <= MAX_DELAY_S


def test_turning_the_sensor_in_its_mounting_changes_no_live_event() -> None:
    settings = walking(1.19, 100.0, Tissue.RIGID)
    one, _ = both_ways(settings)
    other, _ = both_ways(settings, Rotation.from_rotvec([2.0, 0.4, -1.0]))
    assert [e.event for e in one] == [e.event for e in other]
    np.testing.assert_allclose([e.time_s for e in one], [e.time_s for e in other], atol=1e-6)


def test_standing_tells_nothing() -> None:
    live = LiveEvents(0.01)
    rates = 0.02 * np.random.default_rng(1).normal(size=(1000, 3))
    assert [event for k, rate in enumerate(rates) for event in live.update(0.01 * k, rate)] == []
    assert live.phase is Phase.UNKNOWN
