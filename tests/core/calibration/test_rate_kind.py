"""Tests that instants and averages are distinguished where no sensor states which its rates are."""

from dataclasses import replace

import pytest

from core.body import Site
from core.calibration.rate_kind import tracks_of_kind
from core.samples import RateKind, SensorInfo
from core.session import Session
from devices.simulation.walker import FreeMotion, Standing, Tissue, Walk, WalkerSettings
from tests.simulated import session_of

LEFT = (Site.LEFT_THIGH, Site.LEFT_SHANK, Site.LEFT_FOOT)
RECORDINGS = (Standing(duration_s=2.0), FreeMotion(duration_s=6.0), Walk(strides=5))


def not_reported(settings: WalkerSettings) -> Session:
    """A session whose sensors do not say what their rates stand for."""
    session = session_of(settings)
    return replace(session, sensors=dict.fromkeys(session.sensors, SensorInfo()))


@pytest.mark.endurance
@pytest.mark.parametrize("kind", list(RateKind))
@pytest.mark.parametrize("tissue", [Tissue.RIGID, Tissue.SOFT])
def test_all_joints_together_show_instants_from_averages(tissue: Tissue, kind: RateKind) -> None:
    rate_hz = 200.0 if tissue is Tissue.RIGID else 60.0
    settings = WalkerSettings(seed=1, recordings=RECORDINGS, sites=LEFT, rate_hz=rate_hz, tissue=tissue, rate_kind=kind)
    session = not_reported(settings)
    tracks, findings = tracks_of_kind(session, session.recordings, frozenset())
    assert tracks.rate_kind is kind
    assert [f.key for f in findings] == (["rate_kind_found"] if kind is RateKind.AVERAGED else [])


def test_sensors_that_show_their_kind_are_not_asked() -> None:
    session = session_of(WalkerSettings(recordings=(Walk(strides=3),), sites=LEFT, rate_kind=RateKind.AVERAGED))
    tracks, findings = tracks_of_kind(session, session.recordings, frozenset())
    assert tracks.rate_kind is RateKind.INSTANTANEOUS  # what holds for sensors that do not report
    assert not findings
