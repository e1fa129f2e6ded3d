"""Which words ask for a motion, how long they stay, and what stopping early is stated to cost."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np
import pytest

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


def test_a_hint_names_side_and_limb_in_plain_words() -> None:
    assert hint_for(LEFT_LEG).sentence == "Circle the left lower leg"
    assert hint_for(LEFT_LEG).how == (
        "Reverse direction from time to time. The patient may sit or stand; move the limb by hand if needed."
    )
    assert hint_for(Missing(Site.LEFT_SHANK, Movement.BEND)).sentence == "Bend the left knee"
    assert hint_for(Missing(Site.RIGHT_FOOT, Movement.BEND)).sentence == "Bend the right ankle"


def test_on_a_prosthetic_side_the_therapist_moves_the_limb() -> None:
    prosthetic = frozenset({Joint.LEFT_KNEE, Joint.LEFT_ANKLE})
    assert hint_for(LEFT_LEG, prosthetic).how == "The therapist moves the limb. Reverse direction from time to time."
    assert hint_for(RIGHT_KNEE, prosthetic) == hint_for(RIGHT_KNEE)


def test_above_a_transtibial_prosthesis_the_patient_moves_the_limb_and_the_therapist_the_foot() -> None:
    prosthetic = frozenset({Joint.LEFT_ANKLE})
    assert hint_for(LEFT_LEG, prosthetic) == hint_for(LEFT_LEG)
    thigh = Missing(Site.LEFT_THIGH, Movement.CIRCLE)
    assert hint_for(thigh, prosthetic) == hint_for(thigh)
    foot = Missing(Site.LEFT_FOOT, Movement.BEND)
    assert hint_for(foot, prosthetic).how == "The therapist moves the limb."
    assert hint_for(foot).how != "The therapist moves the limb."


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


def test_at_the_end_it_states_whether_the_motion_is_enough_or_all_only_as_good_as_they_get() -> None:
    enough = state(1, 8, None, is_closed=True)
    assert last_hint(motion({Joint.LEFT_KNEE: enough})).sentence == "Enough movement"
    mixed = motion({Joint.LEFT_KNEE: enough, Joint.RIGHT_KNEE: state(4, 8, is_plateau=True)})
    assert HintHold().ask(mixed, 0.0).hint.sentence == "Uncertainty no longer falls"


@pytest.mark.parametrize(
    ("joints", "finds"),
    [
        ((Joint.LEFT_KNEE, Joint.RIGHT_KNEE), ""),
        ((Joint.LEFT_KNEE, Joint.LEFT_ANKLE), " It determines the ankle axis."),
        (LEG_JOINTS, " It determines the ankle axes."),
    ],
)
def test_walking_is_stated_to_find_the_axes_of_ankles_that_wear_sensors(joints: tuple[Joint, ...], finds: str) -> None:
    assert last_hint(motion(dict.fromkeys(joints, ENOUGH))).how == f"Walking follows automatically.{finds}"


def test_a_joint_that_is_no_hinge_is_stated_in_place_of_enough_motion() -> None:
    all_four = dict.fromkeys(LEG_JOINTS, ENOUGH)
    one, both = all_four | {Joint.LEFT_KNEE: LOOSE}, dict.fromkeys(LEG_JOINTS, LOOSE)
    stated = last_hint(motion(one), PROSTHETIC)
    assert stated.sentence == "Left knee: not a hinge"
    assert stated.how == "The angle is the rotation about the main axis. Walking follows automatically."
    assert recorded_hint(motion(one), PROSTHETIC).sentence == "Left knee: not a hinge"
    assert last_hint(motion(both), frozenset(LEG_JOINTS)).sentence == "2 joints: not hinges"
    assert last_hint(motion(one)).sentence == "Enough movement"  # of a living knee none is expected
    assert last_hint(motion(all_four), PROSTHETIC).sentence == "Enough movement"


def test_the_rail_states_which_joints_have_enough_motion_and_an_ankle_by_its_centre() -> None:
    far, none = state(11, 34), frozenset[Joint]()
    some = motion({Joint.LEFT_KNEE: ENOUGH, Joint.RIGHT_KNEE: far, Joint.LEFT_ANKLE: ENOUGH, Joint.RIGHT_ANKLE: ENOUGH})
    assert enough_for(some, none) == "enough movement for 1 of 2 knees, 2 of 2 ankle centres"
    assert enough_for(motion(dict.fromkeys(LEG_JOINTS, ENOUGH)), none) == "enough movement"
    assert enough_for(motion({Joint.LEFT_KNEE: far}), none) == "enough movement for 0 of 1 knee"
    assert enough_for(motion({Joint.LEFT_ANKLE: far}), none) == "enough movement for 0 of 1 ankle centre"


def test_a_joint_that_is_no_hinge_is_named_and_not_counted() -> None:
    loose = motion(dict.fromkeys(LEG_JOINTS, ENOUGH) | {Joint.LEFT_KNEE: LOOSE})
    stated = "enough movement for 1 of 2 knees, 2 of 2 ankle centres; left knee: not a hinge"
    assert enough_for(loose, PROSTHETIC) == stated
    assert enough_for(loose, frozenset()) == "enough movement"


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
    enough = motion({Joint.LEFT_KNEE: state(1, 8, None, is_closed=True)})
    assert hold.ask(enough, RESTS_S + 1.0).hint.sentence == "Enough movement"


def test_stopping_costs_nothing_when_the_motion_is_enough() -> None:
    assert price_of_stopping(motion({Joint.LEFT_KNEE: state(1, 8, None, is_closed=True)})) == ""


def test_stopping_before_a_joint_is_found_costs_its_angles() -> None:
    unknown, enough = state(57, 250), state(1, 8, None, is_closed=True)
    one = motion({Joint.LEFT_KNEE: unknown, Joint.RIGHT_KNEE: enough})
    assert price_of_stopping(one) == "If you stop now, angles are unreliable for the left knee."
    both = motion({Joint.LEFT_KNEE: unknown, Joint.RIGHT_KNEE: unknown})
    assert price_of_stopping(both) == "If you stop now, angles are unreliable for the left knee and the right knee."
    assert price_of_stopping(FreeMotionState()) == "No joint is calibrated yet."


def test_a_joint_that_is_nearly_there_is_reported_with_both_figures_and_what_helps() -> None:
    nearly = motion({Joint.LEFT_KNEE: state(3.8, 9)})
    assert price_of_stopping(nearly) == (
        "Left knee: axis uncertainty 3.8°, limit 1.5°. Move the left leg for 5 more seconds, or continue: the "
        "report then states this."
    )


def test_moving_on_is_not_proposed_where_it_brings_nothing() -> None:
    assert price_of_stopping(motion({Joint.RIGHT_ANKLE: state(9, 18, is_plateau=True)})) == (
        "Right ankle: centre uncertainty 18 mm, limit 10 mm. If you continue, the report states this uncertainty."
    )


def test_a_replayed_patient_who_has_ended_is_not_asked_to_move() -> None:
    nearly = motion({Joint.LEFT_KNEE: state(3.8, 9)})
    stated = price_of_stopping(nearly, can_move=False)
    assert stated == (
        "Left knee: axis uncertainty 3.8°, limit 1.5°. If you continue, the report states this uncertainty."
    )


def test_of_a_prosthesis_more_is_required() -> None:
    stated = price_of_stopping(motion({Joint.LEFT_KNEE: state(1.2, 6)}), frozenset({Joint.LEFT_KNEE}))
    assert stated.startswith("Left knee: axis uncertainty 1.2°, limit 0.5°.")


def test_a_joint_without_gauge_states_why() -> None:
    worn = set(LEG_SITES) - {Site.RIGHT_FOOT}
    assert absent_note(Joint.RIGHT_ANKLE, worn, ()) == "No sensor on R foot: no right ankle angle."
    assert absent_note(Joint.RIGHT_KNEE, worn, ()) == ""
    assert absent_note(Joint.LEFT_ANKLE, worn, {Side.LEFT}).startswith("Foot without ankle joint: nothing to calibrate")
    assert absent_note(Joint.LEFT_KNEE, worn, {Side.LEFT}) == ""


def hip(sd_deg: float, *, is_sure: bool = False) -> HipHeadingState:
    return HipHeadingState(1.0, 0.0, float(np.deg2rad(sd_deg)), 4.0, 0.05, 9.0, is_sure)


OPEN_HIPS = {Joint.LEFT_HIP: hip(12.0), Joint.RIGHT_HIP: hip(4.0, is_sure=True)}
ALL_ENOUGH = dict.fromkeys(LEG_JOINTS, state(0.8, 6, None, is_closed=True))


def test_hips_never_keep_anybody_from_walking() -> None:
    still_open = replace(motion(ALL_ENOUGH), hips=OPEN_HIPS)
    assert still_open.is_done
    assert price_of_stopping(still_open) == ""
    assert enough_for(still_open, frozenset()) == "enough movement"
    hint = last_hint(still_open)
    assert hint.sentence == "Enough movement"
    assert hint.how == (
        "Walking follows automatically. Walking determines the ankle axes and, with a turn, calibrates the hips."
    )


def test_the_walk_is_not_stated_to_show_hips_that_are_shown_or_not_worn() -> None:
    shown = dict.fromkeys(OPEN_HIPS, hip(4.0, is_sure=True))
    for hips in (shown, {}):
        assert "hips" not in last_hint(replace(motion(ALL_ENOUGH), hips=hips)).how


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


def test_the_hint_of_the_hips_can_be_read_from_two_metres() -> None:
    assert len(hip_hint().sentence) <= LETTERS


def test_a_hip_states_which_sensor_it_lacks() -> None:
    worn = {Site.PELVIS, Site.LEFT_SHANK, Site.RIGHT_THIGH}
    assert absent_note(Joint.LEFT_HIP, worn, ()) == "No sensor on L thigh: no left hip angle."
    assert absent_note(Joint.RIGHT_HIP, worn, {Side.RIGHT}) == ""
