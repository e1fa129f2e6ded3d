"""Tests that axes which two parts of the data do not agree on are seen, and those they agree on are not doubted."""

from dataclasses import replace

import numpy as np
import pytest

from core.analysis import analyse
from core.body import Joint, Side, Site
from core.prosthesis import AmputationLevel, FootKind, Prosthesis
from core.results import Method, RecordingAnalysis
from core.session import Patient
from core.verdicts.model import Verdict
from devices.simulation.walker import FreeMotion, Manner, Standing, Tissue, Walk, WalkerSettings
from tests.benchmarks.axis_halves import HARDLY_MOVING, JUMP_DEG, WALK, of_seed
from tests.simulated import session_of

ANKLE = Joint.LEFT_ANKLE
LEG = (Site.LEFT_THIGH, Site.LEFT_SHANK, Site.LEFT_FOOT)
SOUND = WalkerSettings(seed=1, tissue=Tissue.REAL, recordings=(Standing(), Walk(strides=12)), sites=LEG)
STIFF = replace(SOUND, recordings=(Standing(), Walk(strides=12, manner=Manner.STIFF)), seed=4)


WALK_AFTER_FREE_MOTION = (Standing(), FreeMotion(), Walk(strides=12))


def walk_of(settings: WalkerSettings, method: Method = Method.ROBUST) -> RecordingAnalysis:
    return analyse(session_of(settings), method).recordings[-1]


def gates_of(walk: RecordingAnalysis, joint: Joint) -> list[str]:
    return [reason.gate for reason in walk.verdicts.joint(joint).shape.reasons if reason.gate.startswith("axis_")]


def test_an_ankle_that_hardly_moves_and_whose_axes_jump_is_not_reported() -> None:
    walk = walk_of(STIFF)
    ankle = walk.axis_halves[ANKLE]
    assert np.rad2deg(ankle.apart_rad) > 60.0
    assert not ankle.is_free_motion
    assert walk.verdicts.joint(ANKLE).shape.verdict is Verdict.NOT_REPORTED
    assert gates_of(walk, ANKLE) == ["axis_halves"]
    assert gates_of(walk, Joint.LEFT_KNEE) == []
    # what the jump changes of the means by far exceeds what a part's formal deviation would
    assert np.rad2deg(ankle.spread["ankle_at_initial_contact_rad"]) > 1.5


def test_the_joints_of_a_leg_that_walks_have_one_axis_in_both_halves() -> None:
    walk = walk_of(SOUND)
    assert set(walk.axis_halves) == {Joint.LEFT_KNEE, ANKLE}
    for joint, halves in walk.axis_halves.items():
        assert np.rad2deg(halves.apart_rad) < 5.0
        assert np.rad2deg(max(halves.spread.values())) < 0.5
        assert {f"{joint.kind}_range_rad", f"{joint.kind}_at_initial_contact_rad"} <= set(halves.spread)
        assert gates_of(walk, joint) == []


@pytest.mark.parametrize("method", Method)
def test_free_motion_is_compared_with_the_walk(method: Method) -> None:
    walk = walk_of(replace(SOUND, recordings=WALK_AFTER_FREE_MOTION), method)
    assert all(halves.is_free_motion for halves in walk.axis_halves.values())
    assert [gates_of(walk, joint) for joint in walk.axis_halves] == [[], []]
    stiff = replace(WALK_AFTER_FREE_MOTION[-1], manner=Manner.STIFF)
    walk = walk_of(replace(SOUND, recordings=(*WALK_AFTER_FREE_MOTION[:-1], stiff)), method)
    assert [gates_of(walk, joint) for joint in walk.axis_halves] == [[], ["axis_motions"]]


def test_a_foot_without_a_joint_which_hands_cannot_bend_is_compared_between_halves_of_the_walk() -> None:
    """Of the side alone its axis in free motion, which is nothing's, took its ankle out of the report."""
    springy = Prosthesis(AmputationLevel.TRANSTIBIAL, foot=FootKind.ENERGY_STORING)
    made = session_of(
        replace(
            SOUND,
            tissue=Tissue.SOFT,
            seed=101,
            prosthetic_side=Side.LEFT,
            fitted=springy,
            recordings=WALK_AFTER_FREE_MOTION,
        )
    )
    stated, alone = (
        analyse(replace(made, patient=patient)).recordings[-1]
        for patient in (made.patient, Patient(prosthetic_side="left"))
    )
    assert made.patient.worn == {Side.LEFT: springy}
    assert stated.axis_halves[Joint.LEFT_KNEE].is_free_motion
    assert not stated.axis_halves[ANKLE].is_free_motion
    assert (gates_of(alone, ANKLE), gates_of(stated, ANKLE)) == (["axis_motions"], [])


def test_a_foot_stated_to_have_no_joint_whose_axes_jump_is_not_reported_either() -> None:
    rigid = {Side.LEFT: Prosthesis(foot=FootKind.SACH)}
    free = session_of(replace(STIFF, recordings=(Standing(), FreeMotion(), *STIFF.recordings[1:])))
    for made in (session_of(STIFF), free):
        walk = analyse(replace(made, patient=Patient(prosthetic_side="left", prostheses=rigid))).recordings[-1]
        assert gates_of(walk, ANKLE) == ["axis_halves"]


def test_where_a_half_holds_too_little_movement_nothing_is_compared() -> None:
    assert walk_of(replace(SOUND, recordings=(Standing(), Walk(strides=2)))).axis_halves == {}


@pytest.mark.endurance
def test_jumping_ankles_are_gated_and_sound_joints_are_not() -> None:
    """In walking alone; tests/benchmarks/axis_halves.py has the table."""
    walk = HARDLY_MOVING["stiff, 1.0 m/s"]
    seen = [one for seed in range(6) for one in of_seed(seed, Tissue.REAL, walk, "walking alone", has_jumps=True)]
    jumping = [one.verdict != "read" for one in seen if not one.joint.is_knee and one.jump_deg > JUMP_DEG]
    assert len(jumping) >= 3
    assert np.mean(jumping) >= 0.95
    for before in ("walking alone", "free motion"):
        sound = [one.verdict != "read" for seed in range(3) for one in of_seed(seed, Tissue.REAL, WALK, before)]
        assert np.mean(sound) < 0.03
