"""The free motion: gauges, one leg again, labels that are wrong, and sensors whose sites nobody has stated."""

import numpy as np
import pytest

from app.wizard.free_motion.estimator import FreeMotionEstimator, FreeMotionView, UnplacedFreeMotionEstimator
from core.body import LEG_JOINTS, Joint, Side, Site
from core.live.free_motion import FreeMotionState
from core.samples import ImuBlock
from tests.app.wizard.dressed_patient import BEGIN_S, Worn, in_blocks
from tests.core.cut_blocks import part_of

pytestmark = pytest.mark.endurance  # minutes in all: the default run has three

LEFT_MOVES_S, RIGHT_MOVES_S = BEGIN_S, BEGIN_S + 11.0


def fed(
    estimator: FreeMotionEstimator | UnplacedFreeMotionEstimator, streams: dict[str, ImuBlock], block_s: float = 0.1
) -> list[FreeMotionView]:
    reported = []
    for block in in_blocks(streams, block_s):
        estimator.update(block)
        reported.append(estimator.state)
    return reported


def assert_same(one: FreeMotionState, two: FreeMotionState) -> None:
    assert one.joints == two.joints
    assert one.lags == two.lags
    assert one.weakest == two.weakest


def shortened(dressed: Worn, from_s: float, to_s: float) -> dict[str, ImuBlock]:
    return {name: part_of(block, from_s, to_s) for name, block in dressed.free_motion.items()}


def exchanged(dressed: Worn, one: Site, other: Site) -> dict[str, Site]:
    swap = {one: other, other: one}
    return {name: swap.get(site, site) for name, site in dressed.site_of.items()}


@pytest.fixture(scope="module")
def usual(dressed: Worn) -> list[FreeMotionView]:
    return fed(FreeMotionEstimator(dressed.site_of, dressed.live_sensors), dict(dressed.free_motion), 0.03)


def test_both_legs_are_watched_and_the_weakest_joint_is_of_either(usual: list[FreeMotionView]) -> None:
    last = usual[-1]
    assert set(last.motion.joints) == set(LEG_JOINTS)
    assert last.elapsed_s == pytest.approx(22.0, abs=0.05)
    halfway = usual[len(usual) // 2].motion
    assert halfway.joints[Joint.LEFT_KNEE].moved_s > 9.0
    assert halfway.joints[Joint.RIGHT_KNEE].moved_s < 1.0
    assert halfway.weakest is not None
    assert halfway.weakest.side is Side.RIGHT
    assert not any(state.detected for state in usual)


@pytest.mark.parametrize("block_s", [0.7, 60.0])
def test_the_size_of_the_blocks_changes_nothing(dressed: Worn, usual: list[FreeMotionView], block_s: float) -> None:
    other = fed(FreeMotionEstimator(dressed.site_of, dressed.live_sensors), dict(dressed.free_motion), block_s)[-1]
    assert_same(other.motion, usual[-1].motion)
    assert (other.elapsed_s, other.detected) == (usual[-1].elapsed_s, usual[-1].detected)


def test_one_leg_begins_again_and_the_other_stays_as_it_is(dressed: Worn) -> None:
    estimator = FreeMotionEstimator(dressed.site_of, dressed.live_sensors)
    before = fed(estimator, shortened(dressed, LEFT_MOVES_S, LEFT_MOVES_S + 8.0))[-1]
    estimator.repeat(Side.LEFT)
    after = fed(estimator, shortened(dressed, LEFT_MOVES_S + 8.0, LEFT_MOVES_S + 14.0))
    first, last = after[0], after[-1]
    assert first.repeated is last.repeated is Side.LEFT
    assert first.motion.joints[Joint.LEFT_KNEE].moved_s == 0.0
    assert last.motion.joints[Joint.LEFT_KNEE].moved_s == pytest.approx(3.0, abs=0.7)
    assert last.elapsed_s == pytest.approx(6.0, abs=0.05)
    for joint in (Joint.RIGHT_KNEE, Joint.RIGHT_ANKLE):
        assert last.motion.joints[joint] is before.motion.joints[joint]


@pytest.mark.parametrize(
    ("one", "other"), [(Site.LEFT_THIGH, Site.LEFT_SHANK), (Site.LEFT_FOOT, Site.RIGHT_FOOT)], ids=["leg", "legs"]
)
def test_labels_that_the_motion_contradicts_are_named(dressed: Worn, one: Site, other: Site) -> None:
    standing = {name: rest.acc_m_s2 for name, rest in dressed.rests.items()}
    estimator = FreeMotionEstimator(exchanged(dressed, one, other), dressed.live_sensors, standing=standing)
    reported = fed(estimator, dict(dressed.free_motion))
    assert reported[-1].detected == {one: other, other: one}
    if one.side is other.side:  # across the legs another group may be named until both have moved for long
        assert all(state.detected in ({}, {one: other, other: one}) for state in reported)


@pytest.mark.parametrize("first", [Side.LEFT, None])
def test_sensors_without_sites_are_placed_and_made_up_for(
    dressed: Worn, usual: list[FreeMotionView], first: Side | None
) -> None:
    estimator = UnplacedFreeMotionEstimator(dressed.live_sensors, first)
    reported = fed(estimator, dict(dressed.free_motion), 0.1)
    if first is None:
        assert not reported[-1].site_of
        assert reported[-1].chains is not None
        assert reported[-1].chains.is_first_certain
        assert reported[-1].is_side_open
        return
    assert not reported[-1].is_side_open
    assert all(state.site_of in ({}, dressed.site_of) for state in reported)
    assert reported[-1].site_of == dressed.site_of
    assert_same(reported[-1].motion, usual[-1].motion)
    assert reported[-1].elapsed_s == usual[-1].elapsed_s


def test_a_word_names_the_side_that_nobody_was_asked_to_move_first(dressed: Worn) -> None:
    estimator = UnplacedFreeMotionEstimator(dressed.live_sensors, None)
    left = next(name for name, site in dressed.site_of.items() if site is Site.LEFT_SHANK)
    estimator.name_leg((left, Side.RIGHT))
    last = fed(estimator, dict(dressed.free_motion))[-1]
    assert {name: site.segment for name, site in last.site_of.items()} == {
        name: site.segment for name, site in dressed.site_of.items()
    }
    assert all(last.site_of[name].side is not site.side for name, site in dressed.site_of.items())


def test_a_word_about_the_leg_that_moved_second_names_the_first_the_other(dressed: Worn) -> None:
    """Whoever answers looks at a sensor, not at which leg the search has put first by then."""
    estimator = UnplacedFreeMotionEstimator(dressed.live_sensors, None)
    right = next(name for name, site in dressed.site_of.items() if site is Site.RIGHT_SHANK)
    estimator.name_leg((right, Side.RIGHT))
    assert fed(estimator, dict(dressed.free_motion))[-1].site_of == dressed.site_of


def test_a_word_that_is_undone_places_nobody(dressed: Worn) -> None:
    estimator = UnplacedFreeMotionEstimator(dressed.live_sensors, None)
    estimator.name_leg((next(iter(dressed.site_of)), Side.RIGHT))
    estimator.name_leg(None)
    last = fed(estimator, dict(dressed.free_motion))[-1]
    assert last.is_side_open
    assert not last.site_of


def test_a_single_leg_is_not_taken_for_the_one_that_was_asked(dressed: Worn) -> None:
    right = {name: dressed.live_sensors[name] for name, site in dressed.site_of.items() if site.side is Side.RIGHT}
    estimator = UnplacedFreeMotionEstimator(right, Side.LEFT)
    streams = {name: part_of(dressed.free_motion[name], RIGHT_MOVES_S, RIGHT_MOVES_S + 8.0) for name in right}
    assert fed(estimator, streams)[-1].is_side_open
    assert not estimator.state.site_of
    estimator.name_leg((next(iter(right)), Side.RIGHT))
    later = {name: part_of(dressed.free_motion[name], RIGHT_MOVES_S + 8.0, RIGHT_MOVES_S + 11.0) for name in right}
    assert fed(estimator, later)[-1].site_of == {name: dressed.site_of[name] for name in right}


@pytest.mark.endurance
def test_no_more_than_half_a_minute_is_held_back(dressed: Worn) -> None:
    estimator = UnplacedFreeMotionEstimator(dressed.live_sensors, Side.LEFT)
    stood = {
        name: ImuBlock(name, np.concatenate([block.time_s + 5.0 * k for k in range(8)]), *repeated(block, 8))
        for name, block in dressed.standing.items()
    }
    for block in in_blocks(stood, 0.5):
        estimator.update(block)
    end_s = max(float(block.time_s[-1]) for block in stood.values())
    moved = {
        name: ImuBlock(name, block.time_s - BEGIN_S + end_s + 0.02, block.gyr_rad_s, block.acc_m_s2)
        for name, block in dressed.free_motion.items()
    }
    reported = fed(estimator, moved)
    assert reported[-1].site_of == dressed.site_of
    assert reported[-1].elapsed_s == pytest.approx(62.0, abs=0.2)
    assert reported[-1].motion.joints[Joint.RIGHT_KNEE].moved_s == pytest.approx(11.0, abs=1.0)


def repeated(block: ImuBlock, times: int) -> tuple[np.ndarray, np.ndarray]:
    return np.tile(block.gyr_rad_s, (times, 1)), np.tile(block.acc_m_s2, (times, 1))


def test_a_state_that_was_read_stays_as_it_was(usual: list[FreeMotionView]) -> None:
    moved_s = [state.motion.joints[Joint.LEFT_KNEE].moved_s for state in usual]
    assert moved_s == sorted(moved_s)
    assert len(set(moved_s)) > 50
