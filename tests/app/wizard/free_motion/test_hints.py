"""Which words ask for a motion, how long they stay, and what stopping early is stated to cost."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np
import pytest
from syrupy.assertion import SnapshotAssertion

from app.widgets.hint import Hint
from app.wizard.free_motion.hints import (
    HELD_S,
    LETTERS,
    ONCE_MORE_S,
    RESTS_S,
    HintHold,
    absent_note,
    enough_for,
    first_hint,
    hint_for,
    hip_hint,
    last_hint,
    played_hint,
    price_of_stopping,
    recorded_hint,
    unplaced_hint,
)
from core.body import LEG_JOINTS, LEG_SITES, Joint, Side, Site
from core.live.excitation import ExcitationState, Missing, Movement
from core.live.free_motion import FreeMotionState
from core.live.hip_heading import HipHeadingState

LEFT_LEG = Missing(Site.LEFT_SHANK, Movement.CIRCLE)
RIGHT_KNEE = Missing(Site.RIGHT_SHANK, Movement.BEND)


def state(axis_deg: float, centre_mm: float, missing: Missing | None = LEFT_LEG, **more: object) -> ExcitationState:
    known = ExcitationState(
        axis_sd_rad=float(np.deg2rad(axis_deg)),
        centre_sd_m=centre_mm / 1000,
        axis_sd_with_floor_rad=float(np.deg2rad(np.hypot(axis_deg, 4.0))),
        centre_sd_with_floor_m=centre_mm / 1000,
        sign_margin=2.0,
        wanting=max(axis_deg / 1.5, centre_mm / 10),
        is_closed=False,
        is_plateau=False,
        trend=0.5,
        missing=missing,
        moved_s=6.0,
    )
    return replace(known, **more)  # type: ignore[arg-type]  # any of its fields


def motion(joints: Mapping[Joint, ExcitationState]) -> FreeMotionState:
    is_open = [joint for joint, one in joints.items() if not (one.is_closed or one.is_plateau)]
    return FreeMotionState(joints, {}, max(is_open, key=lambda joint: joints[joint].wanting, default=None))


def every_hint() -> Iterator[Hint]:
    for site in LEG_SITES:
        for movement in Movement:
            yield hint_for(Missing(site, movement))
    yield first_hint()
    yield unplaced_hint()
    yield played_hint(has_played=True)
    yield played_hint(has_played=False)
    yield last_hint(motion({Joint.LEFT_KNEE: state(1, 9, None, is_closed=True)}))
    yield last_hint(motion({Joint.LEFT_KNEE: state(4, 9, is_plateau=True)}))
    loose = state(0.4, 4, None, is_closed=True, axis_sd_with_floor_rad=float(np.deg2rad(6.0)))
    for joint in (Joint.LEFT_KNEE, Joint.RIGHT_KNEE):
        yield last_hint(motion({joint: loose}), frozenset(Joint))
    yield last_hint(motion({Joint.LEFT_KNEE: loose, Joint.RIGHT_KNEE: loose}), frozenset(Joint))
    yield hip_hint()
    for found in ({}, {Joint.LEFT_KNEE: state(9, 40)}):
        yield recorded_hint(motion(found))


def test_every_hint_is_read_from_two_metres() -> None:
    too_long = [hint.sentence for hint in every_hint() if len(hint.sentence) > LETTERS]
    assert too_long == []


def test_a_hint_names_the_limb_and_who_moves_it(snapshot: SnapshotAssertion) -> None:
    thigh, foot = Missing(Site.LEFT_THIGH, Movement.CIRCLE), Missing(Site.LEFT_FOOT, Movement.BEND)
    below, above = frozenset({Joint.LEFT_ANKLE}), frozenset({Joint.LEFT_KNEE, Joint.LEFT_ANKLE})
    assert {
        "circle": hint_for(LEFT_LEG),
        "bend a knee": hint_for(Missing(Site.LEFT_SHANK, Movement.BEND)),
        "bend an ankle": hint_for(Missing(Site.RIGHT_FOOT, Movement.BEND)),
        "on a prosthetic side the therapist": hint_for(LEFT_LEG, above),
        "below a transtibial level the therapist": hint_for(foot, below),
        "a foot of one's own": hint_for(foot),
    } == snapshot
    assert hint_for(RIGHT_KNEE, above) == hint_for(RIGHT_KNEE)
    for missing in (LEFT_LEG, thigh):  # above a transtibial prosthesis
        assert hint_for(missing, below) == hint_for(missing)


def test_nothing_is_asked_of_one_leg_before_anything_moved() -> None:
    still = motion({Joint.LEFT_KNEE: state(57, 250, moved_s=0.0)})
    assert HintHold().ask(still, 0.0).hint.sentence == "Move either leg"


def test_a_hint_stays_long_enough_to_be_followed() -> None:
    hold = HintHold()
    left = motion({Joint.LEFT_KNEE: state(11, 34), Joint.RIGHT_KNEE: state(3, 12, RIGHT_KNEE)})
    right = motion({Joint.LEFT_KNEE: state(2, 12), Joint.RIGHT_KNEE: state(3, 12, RIGHT_KNEE)})
    assert hold.ask(left, 10.0).joint is Joint.LEFT_KNEE
    assert hold.ask(right, 10.0 + HELD_S - 0.1).joint is Joint.LEFT_KNEE
    assert hold.ask(right, 10.0 + HELD_S).joint is Joint.RIGHT_KNEE
    assert hold.ask(left, 10.0 + HELD_S + 0.1).joint is Joint.RIGHT_KNEE


@pytest.mark.parametrize(("is_closed", "is_plateau"), [(True, False), (False, True)])
def test_a_hint_goes_at_once_when_its_joint_is_settled(is_closed: bool, is_plateau: bool) -> None:
    hold = HintHold()
    right = state(3, 12, RIGHT_KNEE)
    hold.ask(motion({Joint.LEFT_KNEE: state(11, 34), Joint.RIGHT_KNEE: right}), 10.0)
    settled = state(1, 8, is_closed=is_closed, is_plateau=is_plateau)
    asked = hold.ask(motion({Joint.LEFT_KNEE: settled, Joint.RIGHT_KNEE: right}), 10.1)
    assert asked.joint is Joint.RIGHT_KNEE
    assert asked.site is Site.RIGHT_SHANK


ENOUGH = state(0.4, 4, None, is_closed=True, axis_sd_with_floor_rad=float(np.deg2rad(0.5)))
LOOSE = replace(ENOUGH, axis_sd_with_floor_rad=float(np.deg2rad(6.0)))
PROSTHETIC = frozenset({Joint.LEFT_KNEE})


CLOSED = state(1, 8, None, is_closed=True)


def test_at_the_end_it_states_what_came_of_the_motion(snapshot: SnapshotAssertion) -> None:
    all_four = dict.fromkeys(LEG_JOINTS, ENOUGH)
    one, both = motion(all_four | {Joint.LEFT_KNEE: LOOSE}), motion(dict.fromkeys(LEG_JOINTS, LOOSE))
    mixed = motion({Joint.LEFT_KNEE: CLOSED, Joint.RIGHT_KNEE: state(4, 8, is_plateau=True)})
    shown = dict.fromkeys(OPEN_HIPS, hip(4.0, is_sure=True))
    assert {
        "enough": last_hint(motion({Joint.LEFT_KNEE: CLOSED})),
        "some only as good as they get": HintHold().ask(mixed, 0.0).hint,
        "no ankle wears sensors": last_hint(motion(dict.fromkeys((Joint.LEFT_KNEE, Joint.RIGHT_KNEE), ENOUGH))),
        "one ankle wears sensors": last_hint(motion(dict.fromkeys((Joint.LEFT_KNEE, Joint.LEFT_ANKLE), ENOUGH))),
        "both ankles wear sensors": last_hint(motion(all_four), PROSTHETIC),
        "no hinge in place of enough": last_hint(one, PROSTHETIC),
        "no hinge, recorded": recorded_hint(one, PROSTHETIC),
        "no hinges": last_hint(both, frozenset(LEG_JOINTS)),
        "of a living knee no hinge is expected": last_hint(one),
        "hips that the walk is to show": last_hint(replace(motion(ALL_ENOUGH), hips=OPEN_HIPS)),
        "hips that are shown": last_hint(replace(motion(ALL_ENOUGH), hips=shown)),
    } == snapshot


def test_the_rail_states_which_joints_have_enough_motion_and_an_ankle_by_its_centre(
    snapshot: SnapshotAssertion,
) -> None:
    far, none = state(11, 34), frozenset[Joint]()
    all_four = dict.fromkeys(LEG_JOINTS, ENOUGH)
    loose = motion(all_four | {Joint.LEFT_KNEE: LOOSE})
    assert {
        "one knee is far": enough_for(motion(all_four | {Joint.RIGHT_KNEE: far}), none),
        "all": enough_for(motion(all_four), none),
        "one knee only": enough_for(motion({Joint.LEFT_KNEE: far}), none),
        "one ankle only": enough_for(motion({Joint.LEFT_ANKLE: far}), none),
        "no hinge is named and not counted": enough_for(loose, PROSTHETIC),
        "of a living knee": enough_for(loose, none),
        "hips are not waited for": enough_for(replace(motion(ALL_ENOUGH), hips=OPEN_HIPS), none),
    } == snapshot


def test_what_was_given_up_is_asked_for_once_more_worst_first_and_then_no_more() -> None:
    hold = HintHold()
    better, worse = state(4, 8, is_plateau=True), state(6, 8, RIGHT_KNEE, is_plateau=True)
    left = motion({Joint.LEFT_KNEE: better, Joint.RIGHT_KNEE: worse})
    asked = [hold.ask(left, float(now_s)).joint for now_s in range(60)]
    in_turn = [joint for joint, before in zip(asked, [asked[0], *asked], strict=False) if joint is not before]
    assert in_turn == [Joint.RIGHT_KNEE, Joint.LEFT_KNEE, None]
    assert asked.index(Joint.RIGHT_KNEE) == RESTS_S
    assert asked.count(Joint.RIGHT_KNEE) == asked.count(Joint.LEFT_KNEE) == ONCE_MORE_S
    assert hold.ask(left, 60.0).hint.sentence == "Uncertainty no longer falls"


def test_what_has_enough_the_second_time_is_asked_for_no_longer() -> None:
    hold = HintHold()
    left = motion({Joint.LEFT_KNEE: state(4, 8, is_plateau=True)})
    for now_s in range(round(RESTS_S) + 1):
        asked = hold.ask(left, float(now_s))
    assert asked.joint is Joint.LEFT_KNEE
    enough = motion({Joint.LEFT_KNEE: CLOSED})
    assert hold.ask(enough, RESTS_S + 1.0).hint.sentence == "Enough movement"


def test_stopping_before_a_joint_is_found_costs_its_angles() -> None:
    unknown = state(57, 250)
    one = motion({Joint.LEFT_KNEE: unknown, Joint.RIGHT_KNEE: CLOSED})
    assert price_of_stopping(one) == "If you stop now, angles are unreliable for the left knee."
    both = motion({Joint.LEFT_KNEE: unknown, Joint.RIGHT_KNEE: unknown})
    assert price_of_stopping(both) == "If you stop now, angles are unreliable for the left knee and the right knee."
    assert price_of_stopping(FreeMotionState()) == "No joint is calibrated yet."


def test_a_joint_that_is_nearly_there_is_reported_with_both_figures_and_what_helps(snapshot: SnapshotAssertion) -> None:
    nearly = motion({Joint.LEFT_KNEE: state(3.8, 9)})
    assert {
        "enough": price_of_stopping(motion({Joint.LEFT_KNEE: CLOSED})),
        "moving on helps": price_of_stopping(nearly),
        "moving on brings nothing": price_of_stopping(motion({Joint.RIGHT_ANKLE: state(9, 18, is_plateau=True)})),
        "the replay has ended": price_of_stopping(nearly, can_move=False),
        "of a prosthesis more is required": price_of_stopping(motion({Joint.LEFT_KNEE: state(1.2, 6)}), PROSTHETIC),
        "hips keep nobody from walking": price_of_stopping(replace(motion(ALL_ENOUGH), hips=OPEN_HIPS)),
    } == snapshot


def test_a_joint_without_gauge_states_why(snapshot: SnapshotAssertion) -> None:
    worn = set(LEG_SITES) - {Site.RIGHT_FOOT}
    hips = {Site.PELVIS, Site.LEFT_SHANK, Site.RIGHT_THIGH}
    assert {
        "no foot sensor": absent_note(Joint.RIGHT_ANKLE, worn, ()),
        "both sensors": absent_note(Joint.RIGHT_KNEE, worn, ()),
        "no joint": absent_note(Joint.LEFT_ANKLE, worn, {Side.LEFT}),
        "the knee above no joint": absent_note(Joint.LEFT_KNEE, worn, {Side.LEFT}),
        "no thigh sensor for a hip": absent_note(Joint.LEFT_HIP, hips, ()),
        "a hip": absent_note(Joint.RIGHT_HIP, hips, {Side.RIGHT}),
    } == snapshot


def hip(sd_deg: float, *, is_sure: bool = False) -> HipHeadingState:
    return HipHeadingState(1.0, 0.0, float(np.deg2rad(sd_deg)), 4.0, 0.05, 9.0, is_sure)


OPEN_HIPS = {Joint.LEFT_HIP: hip(12.0), Joint.RIGHT_HIP: hip(4.0, is_sure=True)}
ALL_ENOUGH = dict.fromkeys(LEG_JOINTS, state(0.8, 6, None, is_closed=True))


def test_hips_never_keep_anybody_from_walking() -> None:
    assert replace(motion(ALL_ENOUGH), hips=OPEN_HIPS).is_done


def test_hips_are_asked_for_once_nothing_else_brings_more() -> None:
    plateau = dict.fromkeys(LEG_JOINTS, state(2.4, 6, is_plateau=True))
    hold = HintHold()
    asked = hold.ask(replace(motion(plateau), hips=OPEN_HIPS), 0.0)
    assert asked.hint == hip_hint()
    assert (asked.joint, asked.site) == (Joint.LEFT_HIP, Site.PELVIS)
    assert "Circling the legs does not calibrate the hips; walking does" in asked.hint.how
    without = HintHold().ask(motion(plateau), 0.0)
    assert without.hint.sentence == "Uncertainty no longer falls"
    open_knee = {**plateau, Joint.LEFT_KNEE: state(3.0, 6)}
    assert HintHold().ask(replace(motion(open_knee), hips=OPEN_HIPS), 0.0).joint is Joint.LEFT_KNEE


def test_a_hip_that_is_shown_is_asked_for_no_longer() -> None:
    plateau = dict.fromkeys(LEG_JOINTS, state(2.4, 6, is_plateau=True))
    hold = HintHold()
    hold.ask(replace(motion(plateau), hips=OPEN_HIPS), 0.0)
    shown = dict.fromkeys(OPEN_HIPS, hip(4.0, is_sure=True))
    assert hold.ask(replace(motion(plateau), hips=shown), 0.5).hint.sentence == "Uncertainty no longer falls"
