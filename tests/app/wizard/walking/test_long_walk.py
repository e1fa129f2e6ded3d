"""A walk may last as long as it likes: what is held of it does not grow, and no stride is forgotten."""

from dataclasses import replace

import pytest

from app.wizard.walking.estimator import KEPT_S, _Foot
from core.gait.live import FootEvent, LiveEvent, PhaseChange
from core.gait.phases import Phase
from core.gait.strides import MAX_STRIDE_S
from core.live.walking import LiveFoot


def contact(time_s: float) -> LiveFoot:
    """What a foot gives when it touches the floor."""
    event = LiveEvent(FootEvent.INITIAL_CONTACT, time_s, time_s)
    return LiveFoot((event,), (PhaseChange(Phase.LOADING, time_s, time_s),), Phase.LOADING, 100.0, 0)


@pytest.mark.parametrize("begins", [0, 1000])
def test_no_stride_is_forgotten_and_no_contact_kept_for_ever(begins: int) -> None:
    """Strides of 1.2 s for an hour with a pause after each hundred; the walk that is counted begins amid them."""
    foot, time_s, from_s, counted = _Foot(), 0.0, -1.0, 0
    for k in range(3000):
        is_pause = k % 100 == 0
        time_s += MAX_STRIDE_S + 1.0 if is_pause else 1.2
        foot.take(contact(time_s), None)
        foot.lane(time_s - KEPT_S, is_silent=False)
        counted += k > begins and not is_pause
        if k == begins:
            from_s = time_s
        assert k < begins or foot.strides_since(from_s, time_s - KEPT_S) == counted
        if k < begins:
            foot.strides_since(-1.0, time_s - KEPT_S)
    assert len(foot._contacts_s) <= KEPT_S / 1.2 + 2


def test_a_count_that_the_knee_has_once_contradicted_is_blank_until_the_next_walk() -> None:
    foot = _Foot()
    for k in range(4):
        foot.take(replace(contact(1.2 * k), is_doubtful=k == 2, doubtful_from_s=1.2 * k), None)
        foot.strides_since(-1.0, -KEPT_S)
        assert foot.is_doubtful is (k >= 2)
    foot.strides_since(4.0, -KEPT_S)
    assert not foot.is_doubtful


def test_steps_that_were_odd_before_the_walk_began_leave_its_count() -> None:
    """As those of a leg that circled in the free motion, a second before."""
    foot = _Foot()
    foot.strides_since(4.0, -KEPT_S)
    foot.take(replace(contact(4.5), is_doubtful=True, doubtful_from_s=2.0), None)
    assert not foot.is_doubtful
    foot.take(replace(contact(5.7), is_doubtful=True, doubtful_from_s=4.6), None)
    assert foot.is_doubtful


def test_knees_that_bend_before_the_first_contact_of_a_walk_leave_its_count() -> None:
    """Of who ends another movement when the walk is already recorded: no foot lands, and then they walk."""
    foot = _Foot()
    foot.strides_since(4.0, -KEPT_S)
    in_the_air = LiveFoot((), (), Phase.SWING, 0.0, 0, is_doubtful=True, doubtful_from_s=4.6)
    steps = [replace(contact(9.0 + 1.2 * k), is_doubtful=k < 4, doubtful_from_s=4.6) for k in range(5)]
    lost = replace(contact(15.0), is_doubtful=True, doubtful_from_s=13.8)
    doubts = []
    for one in (in_the_air, *steps, lost, contact(16.2)):
        foot.take(one, None)
        doubts.append(foot.is_doubtful)
    # until four steps are as they should be, the air's are among the last; one that is lost later stays
    assert doubts == [*[True] * 5, False, True, True]
    assert foot.strides_since(4.0, -KEPT_S) == 6
