"""The offset between a video's clock and the samples', from the motion that both saw.

How much of the picture changes from frame to frame follows the legs' angular rates. Where the two fit best, in when
somebody walks and in each step, is the offset; it is reported only where no other is likely, and where most parts of
the walk state the same.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter
from scipy.signal import butter, correlate, sosfiltfilt

from core.body import Segment, Site
from core.samples import BoolArray, FloatArray, ImuBlock
from core.video.clip import Sync, SyncBy

# A camera's frames come late, and so do sensors' samples. Steps repeat every 0.45 to 0.7 s: in less than that only one
# fits. A camera that is later is not certain or a step off, which is seen at a contact and put right by hand.
LIVE_SEARCH_S = (-0.45, 0.05)
WHOLE_SEARCH_S = (-math.inf, math.inf)  # of a video that was made elsewhere: all that overlaps

NOISE_WIDTH = 3  # pixels over which pictures are averaged first
NOISE_LIMIT = 3.5  # robust standard deviations of what changes between two frames; less is noise of the camera
STILL_LIMIT = 2.5  # as above: what changes by more is not part of the room
FITS = 3  # how often the room is told apart from what moves in it
LEAST_GREY = 1e-3  # so that a picture of one colour can be fitted

GRID_HZ = 50.0  # of the comparison: more than the frames, less than the samples
WALKING = 0.8  # quantile of the values: while walking
AT_REST, LEAST_MOTION = 0.2, 1e-9  # of that, and at least: less is no motion
# Limits and independent values a second, chosen on cases 0 to 22 of tests.validation.video_cases, tried on others.
# What is compared, Hz: whether somebody walks, and each step. Slower is how near the camera is, quicker is noise. Then
# the order of its filter, the independent values (of steps fewer, as they repeat), and the least correlation.
BANDS = (((0.1, 0.6), 1, 1.5, 0.4), ((0.7, 4.0), 2, 3.0, 0.3))
LEAST_SURE = 0.98  # probability that it is no other offset
STEP_S = 0.7  # of a slow walker: what fits better so far beyond the search makes a camera's offset uncertain
LONGEST_GAP_S = 0.2  # of samples
# what is seen most comes so much before the rates are greatest, in simulated walks from all sides: python -m
# tests.validation.video_sync prints what is left of it
SEEN_EARLY_S, SEEN_EARLY_SD_S = 0.025, 0.03
LEAST_OVERLAP_S = 5.0  # of video and samples: five steps
MOST_STILL = 0.02  # rad/s, standard deviation: legs that rest turn by less
PARTS = 5  # of the walk, of which each states an offset of its own
APART_S = 0.2  # two offsets closer than this are one: half a quick step
MOST_APART_S = 0.04  # the median part of the walk from the whole: another walk at nearly that pace drifts by more

Grey = NDArray[np.uint8]


def picture_motion(grey: Grey, time_s: FloatArray) -> FloatArray:
    """How much moves in the lower half of a video, where the legs are.

    Parameters
    ----------
    grey : (n, h, w)
        The frames, some 160 pixels wide; smaller ones show no leg, larger ones take longer.
    time_s : (n,)
        When each was taken, ascending: what changed over a frame that is missing is shared out.

    Returns
    -------
    (n,)
        Mean change of brightness since the frame before, grey values per frame; NaN for the first. What the whole room
        does is taken out: light that changes, a camera that is moved a little, and noise.
    """
    return motion_per_frame(picture_changes(grey), time_s)


def picture_changes(grey: Iterable[Grey]) -> FloatArray:
    """As `picture_motion`, of pictures that come one by one (two are held), and not yet for each frame."""
    changes = list[float]()
    before: FloatArray | None = None
    for picture in grey:
        now = _lower_half(picture)
        changes.append(math.nan if before is None else _change(before, now))
        before = now
    return np.array(changes)


def motion_per_frame(changes: FloatArray, time_s: FloatArray) -> FloatArray:
    """Share out what changed, (n,), over frames that are missing, by the pictures' times, (n,) in s."""
    if len(changes) < 2:
        return changes
    step_s = np.diff(time_s)
    frames = np.maximum(1.0, np.round(step_s / np.median(step_s)))
    return np.concatenate([changes[:1], changes[1:] / frames])


def _lower_half(picture: Grey) -> FloatArray:
    return np.asarray(uniform_filter(picture[picture.shape[0] // 2 :].astype(np.float32), NOISE_WIDTH))


def _change(before: FloatArray, now: FloatArray) -> float:
    """Mean change that is neither of the light nor of the whole picture's place nor noise."""
    change = (now - before).ravel()
    down, right = np.gradient(0.5 * (before + now))
    room = np.stack([right.ravel(), down.ravel(), before.ravel(), np.ones_like(change)], axis=1)
    is_room = np.ones(len(change), bool)
    left = np.abs(change)
    noise = 0.0
    for _ in range(FITS):
        part = room[is_room]
        fit = np.linalg.solve(part.T @ part + LEAST_GREY * np.eye(4), part.T @ change[is_room])
        left = np.abs(change - room @ fit)
        noise = float(np.median(left)) / 0.6745  # of a normal distribution
        is_room = left <= STILL_LIMIT * noise
        if np.count_nonzero(is_room) <= room.shape[1]:
            break
    return float(np.maximum(left - NOISE_LIMIT * noise, 0.0).mean())


@dataclass(frozen=True, slots=True)
class _MotionTrack:
    """Values at `GRID_HZ` from `start_s` on, a row for each of `BANDS`."""

    start_s: float
    values: FloatArray
    is_there: BoolArray


def sync_from_motion(
    frame_s: FloatArray,
    motion: FloatArray,
    samples: Mapping[Site, ImuBlock],
    *,
    search_s: tuple[float, float] = LIVE_SEARCH_S,
) -> Sync | None:
    """The offset that makes frame times those of the samples, by cross-correlation of the logarithms of both motions.

    Parameters
    ----------
    frame_s : (n,)
        When each frame was taken, ascending, seconds.
    motion : (n,)
        Of `picture_motion`.
    samples
        What the sensors at thighs, shanks and feet recorded; at least one.
    search_s
        Least and greatest offset that is possible, seconds; infinite: whatever lets both overlap.

    Returns
    -------
    Sync or None
        `sd_s` is by how much the offset differs from part to part, no less than an even distribution over one frame,
        and by how much what is seen most differs from walk to walk. None where it is not certain: nothing moves, the
        video is too short, or another offset fits about as well, as with steps that are all alike. Another walk with
        as many steps at the same pace gives an offset, too.
    """
    seen = _seen(frame_s, motion)
    turned = _turned(samples)
    if seen is None or turned is None:
        return None
    found = _found(seen, turned, search_s, STEP_S)
    if found is None or found.sure < LEAST_SURE or np.any(found.fits < [least for _, _, _, least in BANDS]):
        return None
    parts_s = _of_each_part(seen, turned, found.offset_s)
    if np.median(np.abs(parts_s)) > MOST_APART_S:
        return None
    spread_s = float(np.std(parts_s)) / math.sqrt(PARTS)
    frame_step_s = float(np.median(np.diff(frame_s)))
    sd_s = math.hypot(max(spread_s, frame_step_s / math.sqrt(12.0)), SEEN_EARLY_SD_S)
    return Sync(found.offset_s - SEEN_EARLY_S, sd_s, SyncBy.MOTION)


def _seen(frame_s: FloatArray, motion: FloatArray) -> _MotionTrack | None:
    """The picture's motion, in the middle between the two frames that it is the difference of."""
    is_known = np.isfinite(motion[1:])
    between_s = 0.5 * (frame_s[1:] + frame_s[:-1])[is_known]
    if len(between_s) < 2 or between_s[-1] - between_s[0] < LEAST_OVERLAP_S:
        return None
    values = np.sqrt(motion[1:][is_known])  # nearer to the speed: a leg covers more of the picture near the camera
    grid_s = np.arange(between_s[0], between_s[-1], 1.0 / GRID_HZ)
    return _MotionTrack(float(grid_s[0]), _banded(np.interp(grid_s, between_s, values)), np.ones(len(grid_s), bool))


def _turned(samples: Mapping[Site, ImuBlock]) -> _MotionTrack | None:
    """The sum of the legs' angular rates. Feet count only where nothing else is: they turn most as they are lifted."""
    legs = {site: block for site, block in samples.items() if site is not Site.PELVIS and len(block) > 1}
    chosen = {site: block for site, block in legs.items() if site.segment is not Segment.FOOT} or legs
    if not chosen:
        return None
    start_s = max(float(block.time_s[0]) for block in chosen.values())
    end_s = min(float(block.time_s[-1]) for block in chosen.values())
    if end_s - start_s < LEAST_OVERLAP_S:
        return None
    grid_s = np.arange(start_s, end_s, 1.0 / GRID_HZ)
    total, is_there = np.zeros(len(grid_s)), np.ones(len(grid_s), bool)
    for block in chosen.values():
        rate = np.linalg.norm(block.gyr_rad_s, axis=1)
        is_known = np.isfinite(rate)
        if np.count_nonzero(is_known) < 2:
            return None
        known_s = block.time_s[is_known]
        total += np.interp(grid_s, known_s, rate[is_known])
        after = np.clip(np.searchsorted(known_s, grid_s), 1, len(known_s) - 1)
        is_there &= known_s[after] - known_s[after - 1] < LONGEST_GAP_S
    if float(np.std(total)) < MOST_STILL * len(chosen):
        return None
    return _MotionTrack(start_s, _banded(total), is_there)


def _banded(values: FloatArray) -> FloatArray:
    """The logarithm: a leg's distance from the camera and its contrast only add to it. A row for each band."""
    rest = max(AT_REST * float(np.quantile(values, WALKING)), LEAST_MOTION)
    level = np.log(np.maximum(values, 0.0) + rest)
    return np.stack(
        [sosfiltfilt(butter(order, band, "bandpass", fs=GRID_HZ, output="sos"), level) for band, order, _, _ in BANDS]
    )


@dataclass(frozen=True, slots=True)
class _Found:
    """The best offset, its correlation in each band, and the probability that it is no other one."""

    offset_s: float
    fits: FloatArray
    sure: float


def _found(
    seen: _MotionTrack, turned: _MotionTrack, search_s: tuple[float, float], beyond_s: float = 0.0
) -> _Found | None:
    """None where nothing fits, or where what is up to `beyond_s` beyond the search fits better."""
    count = np.round(_summed(seen.is_there, turned.is_there))
    fits = np.stack(
        [
            _fits(row, turned_row, seen.is_there, turned.is_there, count)
            for row, turned_row in zip(seen.values, turned.values, strict=True)
        ]
    )
    offsets_s = np.arange(-len(seen.is_there) + 1, len(turned.is_there)) / GRID_HZ - (seen.start_s - turned.start_s)
    # how much likelier both are, as a logarithm, with what they have in common than without: of normal distributions
    independent = np.array([hz for _, _, hz, _ in BANDS])[:, None] * count / GRID_HZ
    likelier = -0.5 * np.sum(independent * np.log1p(-(np.maximum(fits, 0.0) ** 2)), axis=0)
    may_be = (offsets_s >= search_s[0]) & (offsets_s <= search_s[1])
    nearly = (offsets_s >= search_s[0] - beyond_s) & (offsets_s <= search_s[1] + beyond_s)
    best = int(np.argmax(np.where(nearly, likelier, 0.0)))
    if likelier[best] <= 0.0 or not may_be[best]:
        return None
    near = np.abs(offsets_s - offsets_s[best]) <= APART_S
    chances = np.exp(likelier - likelier[best])
    here, elsewhere = float(np.sum(chances[near])), float(np.sum(chances[may_be & ~near]))
    return _Found(_refined(offsets_s, likelier, best), fits[:, best], here / (here + elsewhere))


def _refined(offsets_s: FloatArray, likelier: FloatArray, best: int) -> float:
    """The top of a parabola through the best and both beside it."""
    if 0 < best < len(likelier) - 1:
        before, here, after = likelier[best - 1 : best + 2].tolist()
        bend = before - 2.0 * here + after
        if bend < 0.0:
            return float(offsets_s[best] + np.clip(0.5 * (before - after) / bend, -0.5, 0.5) / GRID_HZ)
    return float(offsets_s[best])


def _summed(a: NDArray[np.generic], b: NDArray[np.generic]) -> FloatArray:
    """The sum of the products at each shift of `a` along `b`."""
    return np.asarray(correlate(b.astype(float), a.astype(float), method="fft"))


def _fits(a: FloatArray, b: FloatArray, a_is_there: BoolArray, b_is_there: BoolArray, count: FloatArray) -> FloatArray:
    """Correlation at each shift, of what is there of both; 0 where too little is, or where nothing moves."""
    a, b = np.where(a_is_there, a, 0.0), np.where(b_is_there, b, 0.0)
    sum_a, sum_b = _summed(a, b_is_there), _summed(a_is_there, b)
    with np.errstate(divide="ignore", invalid="ignore"):
        spread_a = _summed(a**2, b_is_there) - sum_a**2 / count
        spread_b = _summed(a_is_there, b**2) - sum_b**2 / count
        fits = (_summed(a, b) - sum_a * sum_b / count) / np.sqrt(spread_a * spread_b)
    least_a, least_b = 1e-3 * float(np.sum(a**2)), 1e-3 * float(np.sum(b**2))
    is_enough = (count >= LEAST_OVERLAP_S * GRID_HZ) & (spread_a > least_a) & (spread_b > least_b)
    return np.where(is_enough, np.clip(fits, -1.0 + 1e-9, 1.0 - 1e-9), 0.0)


def _of_each_part(seen: _MotionTrack, turned: _MotionTrack, best_s: float) -> FloatArray:
    """By how much another offset fits the steps of each part of the walk better; parts in which as much moves."""
    seen_s = seen.start_s + np.arange(len(seen.is_there)) / GRID_HZ + best_s
    turned_s = turned.start_s + np.arange(len(turned.is_there)) / GRID_HZ
    is_both = (seen_s >= turned_s[0]) & (seen_s <= turned_s[-1]) & seen.is_there
    seen_s, steps = seen_s[is_both], seen.values[-1][is_both]
    shifts_s = np.arange(-APART_S, APART_S, 1.0 / GRID_HZ)
    moved = np.stack([np.interp(seen_s + shift_s, turned_s, turned.values[-1]) for shift_s in shifts_s])
    moves = np.cumsum(np.abs(np.interp(seen_s, turned_s, turned.values[-1]) * steps))
    found = []
    for part in np.split(np.arange(len(steps)), np.searchsorted(moves, moves[-1] * np.arange(1, PARTS) / PARTS)):
        a, b = steps[part], moved[:, part]
        a, b = a - a.mean(), b - b.mean(axis=1, keepdims=True)
        fits = b @ a / np.maximum(np.linalg.norm(a) * np.linalg.norm(b, axis=1), LEAST_MOTION)
        found.append(_refined(shifts_s, fits, int(np.argmax(fits))))
    return np.array(found)
