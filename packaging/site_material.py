"""Simulated sessions and what is found in them, for the figures of the site's pages of methods."""

from dataclasses import replace
from functools import cache

import numpy as np

from core.analysis import analyse
from core.body import Joint, Site
from core.calibration.identify import moving_data
from core.calibration.rest import rest_of
from core.published.identify import PublishedIdentification, identify_as_published
from core.results import Analysis
from core.samples import FloatArray, RateKind
from core.session import Session
from core.signal.datasets import Datasets
from core.signal.orientation import oriented
from core.signal.pair import OrientedTrack, Pair, pair_up
from core.signal.tracks import even_tracks
from devices.simulation.walker import (
    FreeMotion,
    SimulatedSession,
    Standing,
    Tissue,
    Walk,
    WalkerSettings,
    simulate,
)

KNEE, ANKLE = Joint.LEFT_KNEE, Joint.LEFT_ANKLE
STANDING, FREE, WALK = "standing", "free motion", "walk 1"


@cache
def session_of(tissue: Tissue, seed: int = 5) -> SimulatedSession:
    """Standing, free motion and a walk of one patient."""
    recordings = (Standing(), FreeMotion(), Walk(strides=8))
    return simulate(WalkerSettings(seed=seed, tissue=tissue, recordings=recordings))


@cache
def analysis_of(tissue: Tissue, is_walk_alone: bool = False, seed: int = 5) -> Analysis:
    """What is found in it; `is_walk_alone`: without the free motion."""
    session = session_of(tissue, seed).session
    return analyse(_without_free_motion(session) if is_walk_alone else session)


def _without_free_motion(session: Session) -> Session:
    return replace(session, recordings=tuple(one for one in session.recordings if one.name != FREE))


@cache
def sensor(tissue: Tissue, name: str, site: Site) -> OrientedTrack:
    """One sensor in one recording, its gyroscope's bias taken off as standing shows it."""
    standing, *_ = recordings = session_of(tissue).session.recordings
    (recording,) = (one for one in recordings if one.name == name)
    rest = rest_of(standing.imu[site])
    bias_rad_s = np.zeros(3) if rest is None else rest.gyr_rad_s
    return oriented(even_tracks(recording.imu[site])[0], RateKind.INSTANTANEOUS, bias_rad_s)


def down(tissue: Tissue, site: Site) -> FloatArray:
    """The mean specific force (3,) of a sensor in standing."""
    rest = rest_of(session_of(tissue).session.recordings[0].imu[site])
    return np.array([0.0, 0.0, 1.0]) if rest is None else rest.acc_m_s2


@cache
def pair(tissue: Tissue, name: str, joint: Joint = KNEE) -> Pair:
    """Both sensors of a joint in one recording."""
    found = pair_up(sensor(tissue, name, joint.proximal), sensor(tissue, name, joint.distal), lag_s=0.0)
    if found is None:
        raise ValueError(f"{name} has less than a second of {joint}")
    return found


def moving(tissue: Tissue, name: str, joint: Joint = KNEE) -> Datasets:
    """The samples that identify a joint."""
    found = moving_data((pair(tissue, name, joint),))
    if found is None:
        raise ValueError(f"{joint} hardly moves in {name}")
    return found


@cache
def as_published(tissue: Tissue) -> PublishedIdentification:
    """The knee as the paper identifies it, from the free motion."""
    data = moving(tissue, FREE)
    return identify_as_published(data, data)


def true_flexion(tissue: Tissue, time_s: FloatArray, name: str = WALK, joint: Joint = KNEE) -> FloatArray:
    """The bones' angle (n,) against standing, rad."""
    truth = session_of(tissue).truth.recordings[name].joints[joint]
    return np.asarray(np.interp(time_s, truth.time_s, truth.angle_rad - truth.standing_rad))
