"""Tests that a video finds its place among the samples by what moves, and that what does not state it stays open."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from core.body import Segment, Site
from core.samples import FloatArray, ImuBlock
from core.video.clip import SyncBy
from core.video.synchronising import LIVE_SEARCH_S, WHOLE_SEARCH_S, picture_motion, sync_from_motion
from tests.validation.video_cases import draw_case, video_of, walked

RIGHT_S = 2 / 30
CASE = draw_case(0, is_imported=False)  # a walk of seven strides from the side, with standing before and after
RATE_HZ = 30.0
Samples = Mapping[Site, ImuBlock]


@cache
def seen() -> tuple[FloatArray, FloatArray]:
    """Times of the frames by the walker's clock, and what moved."""
    video = video_of(CASE)
    return video.time_s + CASE.offset_s, picture_motion(video.grey, video.time_s)


@cache
def samples() -> Samples:
    return walked(CASE.person, CASE.number).session.recordings[0].imu


@pytest.mark.parametrize("offset_s", [-0.4, -0.15, 0.0])
def test_a_live_camera_is_found_within_two_frames(offset_s: float) -> None:
    time_s, motion = seen()
    sync = sync_from_motion(time_s - offset_s, motion, samples(), search_s=LIVE_SEARCH_S)
    assert sync is not None
    assert sync.by is SyncBy.MOTION
    assert sync.offset_s == pytest.approx(offset_s, abs=RIGHT_S)
    assert 1.0 / RATE_HZ / np.sqrt(12.0) < sync.sd_s < RIGHT_S


@pytest.mark.parametrize("offset_s", [-0.9, -0.6, 0.2, 0.6])
def test_a_camera_whose_offset_is_beyond_the_search_states_none(offset_s: float) -> None:
    time_s, motion = seen()
    assert sync_from_motion(time_s - offset_s, motion, samples(), search_s=LIVE_SEARCH_S) is None


@pytest.mark.parametrize("search_s", [LIVE_SEARCH_S, WHOLE_SEARCH_S])
def test_another_walk_at_nearly_that_pace_states_no_offset(search_s: tuple[float, float]) -> None:
    time_s, motion = seen()
    middle_s = float(np.mean(time_s))
    for pace in (0.94, 1.06):
        other_s = middle_s + pace * (time_s - middle_s)
        assert sync_from_motion(other_s, motion, samples(), search_s=search_s) is None


def test_a_leg_that_comes_nearer_to_the_camera_is_found_too() -> None:
    time_s, motion = seen()
    nearer = motion * np.geomspace(1.0, 16.0, len(motion))
    sync = sync_from_motion(time_s, nearer, samples(), search_s=LIVE_SEARCH_S)
    assert sync is not None
    assert sync.offset_s == pytest.approx(0.0, abs=RIGHT_S)


def test_a_file_is_found_wherever_its_clock_is() -> None:
    time_s, motion = seen()
    for offset_s in (-1000.0, 37.0):
        sync = sync_from_motion(time_s - offset_s, motion, samples(), search_s=WHOLE_SEARCH_S)
        assert sync is not None
        assert sync.offset_s == pytest.approx(offset_s, abs=RIGHT_S)


def test_sensors_at_the_feet_alone_are_enough_or_it_stays_open() -> None:
    time_s, motion = seen()
    feet = {site: block for site, block in samples().items() if site.segment is Segment.FOOT}
    sync = sync_from_motion(time_s, motion, feet)
    assert sync is None or abs(sync.offset_s) < RIGHT_S


def test_samples_and_frames_that_are_missing_move_nothing() -> None:
    time_s, motion = seen()
    holes = {site: replace(block, gyr_rad_s=block.gyr_rad_s.copy()) for site, block in samples().items()}
    for block in holes.values():
        block.gyr_rad_s[400:440] = np.nan
    is_there = np.arange(len(motion)) % 7 != 3
    sync = sync_from_motion(time_s[is_there], motion[is_there], holes)
    assert sync is not None
    assert sync.offset_s == pytest.approx(0.0, abs=RIGHT_S)


def block(time_s: FloatArray, rate: FloatArray) -> ImuBlock:
    gyr = np.zeros((len(time_s), 3))
    gyr[:, 1] = rate
    return ImuBlock("one", time_s, gyr, np.zeros((len(time_s), 3)))


def stepping(time_s: FloatArray) -> FloatArray:
    """Steps that are all alike, without beginning or end."""
    return np.asarray(3.0 + 2.0 * np.sin(2 * np.pi * time_s / 0.5))


def test_steps_that_are_all_alike_state_no_offset() -> None:
    frames_s, samples_s = np.arange(0.0, 30.0, 1 / RATE_HZ), np.arange(-2.0, 32.0, 0.01)
    alike = {Site.LEFT_SHANK: block(samples_s, stepping(samples_s))}
    assert sync_from_motion(frames_s, stepping(frames_s), alike, search_s=LIVE_SEARCH_S) is None
    assert sync_from_motion(frames_s, stepping(frames_s), alike, search_s=WHOLE_SEARCH_S) is None
    once = np.where(np.abs(samples_s - 12.0) < 2.0, stepping(samples_s), 0.1)
    motion = np.where(np.abs(frames_s - 12.0) < 2.0, stepping(frames_s), 0.1) ** 2
    found = sync_from_motion(frames_s, motion, {Site.LEFT_SHANK: block(samples_s, once)}, search_s=WHOLE_SEARCH_S)
    assert found is not None
    assert found.offset_s == pytest.approx(0.0, abs=RIGHT_S)


@pytest.mark.parametrize("search_s", [LIVE_SEARCH_S, WHOLE_SEARCH_S])
def test_a_person_standing_still_gives_no_offset(search_s: tuple[float, float]) -> None:
    time_s, motion = seen()
    rng = np.random.default_rng(3)
    still_s = np.arange(0.0, 15.0, 0.01)
    still = {site: block(still_s, 0.005 * rng.normal(size=len(still_s))) for site in samples()}
    assert sync_from_motion(time_s, motion, still, search_s=search_s) is None  # somebody else walks
    noise = np.abs(rng.normal(size=len(time_s)))
    assert sync_from_motion(time_s, noise, samples(), search_s=search_s) is None  # it shows somebody standing still
    assert sync_from_motion(time_s, np.zeros(len(time_s)), samples(), search_s=search_s) is None


def test_what_is_too_short_or_not_there_states_no_offset() -> None:
    time_s, motion = seen()
    assert sync_from_motion(time_s[:120], motion[:120], samples()) is None
    assert sync_from_motion(time_s[:1], motion[:1], samples()) is None
    assert sync_from_motion(time_s, np.full(len(time_s), np.nan), samples()) is None
    assert sync_from_motion(time_s, motion, {}) is None
    assert sync_from_motion(time_s + 500.0, motion, samples(), search_s=LIVE_SEARCH_S) is None


def room(count: int, seed: int = 1) -> FloatArray:
    """A room of broad patches."""
    patches = np.kron(np.random.default_rng(seed).uniform(60.0, 200.0, (9, 16)), np.ones((10, 10)))
    return np.repeat(patches[None], count, axis=0)


def as_pictures(pictures: FloatArray, noise: float = 2.0) -> FloatArray:
    grain = np.random.default_rng(2).normal(0.0, noise, pictures.shape)
    return picture_motion(np.clip(pictures + grain, 0, 255).astype(np.uint8), np.arange(len(pictures)) / RATE_HZ)


def with_leg(pictures: FloatArray, rows: slice, step: int) -> FloatArray:
    for number, picture in enumerate(pictures):
        picture[rows, 20 + step * number : 28 + step * number] = 20.0
    return pictures


def test_motion_is_of_what_moves_in_the_lower_half() -> None:
    moving = as_pictures(with_leg(room(20), slice(50, 85), 3))
    assert np.isnan(moving[0])
    assert np.all(np.isfinite(moving[1:]))
    still = as_pictures(room(20))
    above = as_pictures(with_leg(room(20), slice(5, 40), 3))
    slower = as_pictures(with_leg(room(20), slice(50, 85), 1))
    assert np.median(moving[1:]) > 20 * np.median(still[1:])
    assert np.median(above[1:]) < 2 * np.median(still[1:]) + 0.01
    assert np.median(still[1:]) < np.median(slower[1:]) < np.median(moving[1:])


def test_changing_light_and_a_hand_that_moves_the_camera_are_no_motion() -> None:
    leg = np.median(as_pictures(with_leg(room(20), slice(50, 85), 3))[1:])
    light = 1.0 + 0.1 * np.sin(np.arange(20))[:, None, None]
    assert np.median(as_pictures(room(20) * light)[1:]) < 0.1 * leg
    shaken = room(20)
    for number in range(1, 20, 2):  # half a pixel to and fro
        shaken[number, :, 1:] = 0.5 * (shaken[number, :, 1:] + shaken[number, :, :-1])
    assert np.median(as_pictures(shaken)[1:]) < 0.3 * leg


def test_what_changed_over_missing_frames_is_shared_out() -> None:
    pictures = np.clip(with_leg(room(30), slice(50, 85), 1), 0, 255).astype(np.uint8)
    time_s = np.arange(30) / RATE_HZ
    whole = picture_motion(pictures, time_s)
    kept = np.array([number for number in range(30) if number % 5 != 2])
    rest = picture_motion(pictures[kept], time_s[kept])
    after_gap = np.diff(kept, prepend=-1) == 2
    assert np.median(rest[after_gap]) == pytest.approx(np.nanmedian(whole), rel=0.35)


def test_pictures_without_any_grey_or_with_one_frame_have_no_motion() -> None:
    assert np.isnan(picture_motion(np.zeros((1, 90, 160), np.uint8), np.zeros(1))).all()
    assert picture_motion(np.empty((0, 90, 160), np.uint8), np.empty(0)).shape == (0,)
    np.testing.assert_array_equal(picture_motion(np.zeros((3, 90, 160), np.uint8), np.arange(3.0))[1:], 0.0)
