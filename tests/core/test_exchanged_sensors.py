"""Tests that sensors that hang where another should be are named, in the default run.

`test_placement.py` tries many more.
"""

from dataclasses import replace

import numpy as np
import pytest

from app.wording.findings import sentence
from core.analysis import analyse
from core.body import Joint, Side, Site
from core.findings import Finding
from core.placement.chains import find_chains
from core.placement.labels import exchanged_sites
from core.results import Analysis
from core.session import Session
from core.signal.pair import OrientedTrack
from core.signal.tracks import Track
from core.verdicts.model import Verdict
from devices.simulation.walker import FreeMotion, Standing, Walk, WalkerSettings
from tests.benchmarks.placement import swapped
from tests.simulated import simulation_of

LEFT_LEG = (Site.LEFT_THIGH, Site.LEFT_SHANK, Site.LEFT_FOOT)


@pytest.fixture(scope="module")
def worn() -> Session:
    """The left leg's three sensors, standing, moving freely and walking."""
    recordings = (Standing(), FreeMotion(duration_s=6.0), Walk(strides=8))
    made = simulation_of(WalkerSettings(seed=4, sites=LEFT_LEG, recordings=recordings))
    return made.session


def about_labels(analysis: Analysis) -> list[Finding]:
    return [finding for finding in analysis.findings if finding.key.startswith("labels")]


def test_sensors_where_their_labels_say_are_not_doubted(worn: Session) -> None:
    analysis = analyse(worn)
    assert about_labels(analysis) == []
    assert analysis.recordings[-1].verdicts.joint(Joint.LEFT_KNEE).shape.is_reported


@pytest.mark.parametrize(
    ("exchanged", "named"),
    [
        ((Site.LEFT_THIGH, Site.LEFT_SHANK), "L thigh and L shank"),
        ((Site.LEFT_SHANK, Site.LEFT_FOOT), "L shank and L foot"),
    ],
)
def test_exchanged_sensors_of_a_leg_are_named_and_what_they_show_is_not_reported(
    worn: Session, exchanged: tuple[Site, Site], named: str
) -> None:
    analysis = analyse(swapped(worn, *exchanged))
    (finding,) = about_labels(analysis)
    assert sentence(finding).startswith(f"{named}, free motion: These sensors look swapped")
    walk = analysis.recordings[-1]
    for joint in walk.joints:
        assert walk.verdicts.joint(joint).shape.verdict is Verdict.NOT_REPORTED
        assert "labels" in {reason.gate for reason in walk.verdicts.joint(joint).shape.reasons}
    is_foot_doubted = Site.LEFT_FOOT in exchanged
    assert (walk.verdicts.legs[Side.LEFT].timing.verdict is Verdict.NOT_REPORTED) is is_foot_doubted


def test_sensors_of_a_leg_in_a_circle_are_one_finding(worn: Session) -> None:
    circled = swapped(swapped(worn, Site.LEFT_THIGH, Site.LEFT_SHANK), Site.LEFT_SHANK, Site.LEFT_FOOT)
    (finding,) = about_labels(analyse(circled))
    assert finding.key == "labels_look_mixed"


def test_a_recording_that_is_called_like_a_site_brings_no_doubt_on_the_sensor_there(worn: Session) -> None:
    exchanged = swapped(worn, Site.LEFT_THIGH, Site.LEFT_SHANK)
    standing, moving, walk = exchanged.recordings
    called = replace(exchanged, recordings=(standing, replace(moving, name="left_foot"), walk))
    assert analyse(called).recordings[-1].doubted_sites == {Site.LEFT_THIGH, Site.LEFT_SHANK}


def test_sensors_that_lie_still_show_neither_chains_nor_which_end_is_up() -> None:
    """With rates of zero no joint has a place, and no leg a length."""
    rng = np.random.default_rng(3)
    upright = np.tile([1.0, 0.0, 0.0, 0.0], (300, 1))
    tracks = {}
    for site in LEFT_LEG:
        acc = np.array([0.0, 0.0, 9.81]) + rng.normal(scale=0.01, size=(300, 3))
        track = Track(0.0, 0.01, np.zeros((300, 3)), acc, None, None, np.ones(300, dtype=bool))
        tracks[str(site)] = [OrientedTrack(track, upright)]
    chains = find_chains(tracks)
    assert chains is not None
    assert not chains.is_certain
    assert exchanged_sites(tracks, {}) == []
