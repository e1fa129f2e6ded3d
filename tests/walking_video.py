"""Videos of simulated walkers, drawn with a known time of each frame. Knows nothing of how videos are synchronised.

A walker's legs, trunk, head and swinging arms are striped sticks before a room, seen by a camera in perspective, with
the blur of its exposure, its noise, and JPEG's loss. The kind camera is still and gives every frame; `Scene` names
what makes it unkind.
"""

import io
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from scipy.ndimage import gaussian_filter1d
from scipy.ndimage import shift as shifted_picture

from core.body import Side
from core.samples import FloatArray
from devices.simulation.walker_body import HEEL_M, TOE_M
from devices.simulation.walker_motion import LegMotion
from devices.simulation.walker_truth import MovedRecording

WIDTH, HEIGHT, SCALE = 160, 90, 2  # of what is given; it is drawn so much larger
FILLS = 0.47  # of the picture, from its middle, the walk takes so much
SUBFRAMES = 2  # of one exposure
GRAINS = 16  # pictures of noise, each moved about for every frame
EYE_M, LOOKS_AT_M = 1.2, 0.9
VIEWS_DEG = {"side": 90.0, "behind": 180.0, "front": 0.0, "oblique": 50.0}  # where the camera is, from straight ahead
HIPS_TO_NECK_M, HEAD_M, SHOULDER_M, UPPER_ARM_M, FOREARM_M = 0.52, 0.2, 0.2, 0.29, 0.25
ARM_SWING = 0.6  # of the other thigh's

Picture = NDArray[np.uint8]


@dataclass(frozen=True, slots=True)
class Scene:
    """Where the camera is, and what makes its video hard to understand.

    Attributes
    ----------
    noise
        Of each pixel, standard deviation in grey values of 255.
    flicker
        By what share the light changes, as that of lamps at 50 Hz and of a camera that adapts.
    shake_m
        How far a hand moves the camera's view, standard deviation at the walker's distance.
    is_passed
        Somebody else walks through the picture, nearer to the camera.
    lost
        The share of frames that never came.
    jitter_s
        Of the frames' stamps, standard deviation.
    contrast
        Of the clothes against the room, 1 for black trousers before a white wall.
    """

    view: str = "side"
    seed: int = 0
    rate_hz: float = 30.0
    noise: float = 3.0
    flicker: float = 0.0
    shake_m: float = 0.0
    is_passed: bool = False
    lost: float = 0.0
    jitter_s: float = 0.002
    contrast: float = 0.6
    exposure_s: float = 0.012
    is_on_treadmill: bool = False


@dataclass(frozen=True, slots=True)
class WalkingVideo:
    """`time_s` (n,): when each frame was taken, by the walker's clock, with the jitter of stamps; `grey` (n, h, w)."""

    time_s: FloatArray
    grey: Picture


@dataclass(frozen=True, slots=True)
class _Stick:
    ends_m: tuple[FloatArray, FloatArray]  # (n, 3) each
    radius_m: float
    shade: float  # from -1 to 1
    stripes: float


class _Body:
    """The sticks of one body at any time."""

    def __init__(self, moved: MovedRecording, is_on_treadmill: bool) -> None:
        self.legs = [moved.legs[side] for side in Side]
        if is_on_treadmill:
            self.legs = _seen_from_the_room(self.legs)
        self.time_s = self.legs[0].time_s
        hips = 0.5 * (self.legs[0].origins_m[0] + self.legs[1].origins_m[0])
        self.hips_m = hips
        forward: FloatArray = self.legs[0].rotations[2, :, :, 0] + self.legs[1].rotations[2, :, :, 0]
        step_s = float(self.time_s[1] - self.time_s[0])
        forward = gaussian_filter1d(forward, 0.4 / step_s, axis=0)
        forward[:, 2] = 0.0
        self.forward = forward / np.linalg.norm(forward, axis=1)[:, None]
        self.sticks = self._sticks()

    def _sticks(self) -> list[_Stick]:
        up = np.array([0.0, 0.0, 1.0])
        neck = self.hips_m + HIPS_TO_NECK_M * up
        left = np.cross(up, self.forward)
        found = [
            _Stick((self.hips_m, neck), 0.14, 0.1, 3.0),
            _Stick((neck + 0.6 * HEAD_M * up, neck + HEAD_M * up), 0.1, 0.7, 1.0),
        ]
        for number, leg in enumerate(self.legs):
            hip, knee, ankle = leg.origins_m
            foot = leg.rotations[2]
            shade = (-0.9, -0.75)[number]
            found += [
                _Stick((hip, knee), 0.08, shade, 2.0),
                _Stick((knee, ankle), 0.05, shade + 0.1, 2.0),
                _Stick((ankle + foot @ HEEL_M, ankle + foot @ TOE_M), 0.035, 0.9, 1.0),
            ]
            shoulder = neck - 0.05 * up + (SHOULDER_M, -SHOULDER_M)[number] * left
            other = -self.legs[1 - number].rotations[0, :, :, 2]
            lean = ARM_SWING * np.einsum("ni,ni->n", other, self.forward)[:, None]
            down = lean * self.forward - up
            down = down / np.linalg.norm(down, axis=1)[:, None]
            elbow = shoulder + UPPER_ARM_M * down
            lower = down + 0.3 * self.forward
            found += [
                _Stick((shoulder, elbow), 0.045, 0.3, 1.0),
                _Stick((elbow, elbow + FOREARM_M * lower), 0.035, 0.6, 1.0),
            ]
        return found

    def at(self, when_s: float) -> list[tuple[FloatArray, FloatArray]]:
        """Both ends of each stick."""
        place = np.clip(np.interp(when_s, self.time_s, np.arange(len(self.time_s))), 0, len(self.time_s) - 1.001)
        row, part = int(place), place % 1.0
        return [
            (
                (1 - part) * stick.ends_m[0][row] + part * stick.ends_m[0][row + 1],
                (1 - part) * stick.ends_m[1][row] + part * stick.ends_m[1][row + 1],
            )
            for stick in self.sticks
        ]


def _seen_from_the_room(legs: list[LegMotion]) -> list[LegMotion]:
    """A treadmill's walk is simulated as seen from its belt."""
    step_s = float(legs[0].time_s[1] - legs[0].time_s[0])
    hips_m = 0.5 * (legs[0].origins_m[0] + legs[1].origins_m[0])
    path_m = gaussian_filter1d(hips_m, 0.5 / step_s, axis=0) * [1.0, 1.0, 0.0]
    return [replace(leg, origins_m=leg.origins_m - path_m) for leg in legs]


class _Camera:
    """A camera without lens errors, turned once so that the whole walk is in its picture."""

    def __init__(self, body: _Body, view: str, rng: np.random.Generator) -> None:
        angle = np.deg2rad(VIEWS_DEG[view] + rng.uniform(-12.0, 12.0)) * rng.choice((-1.0, 1.0))
        ahead = body.forward[len(body.forward) // 4]
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        towards = np.append(turn @ ahead[:2], 0.0)
        path = body.hips_m
        middle = 0.5 * (path.min(axis=0) + path.max(axis=0))
        reach_m = float(np.max((path - middle) @ towards))
        self.place_m = (
            middle + (reach_m + max(0.7 * float(np.ptp(path @ np.cross(towards, [0.0, 0.0, 1.0]))), 2.0)) * towards
        )
        self.place_m += rng.uniform(0.8, 2.0) * towards
        self.place_m[2] = EYE_M
        looks = np.append(middle[:2], LOOKS_AT_M) - self.place_m
        self.depth = looks / np.linalg.norm(looks)
        self.right = np.cross(self.depth, [0.0, 0.0, 1.0])
        self.right /= np.linalg.norm(self.right)
        self.down = np.cross(self.depth, self.right)
        self.focal = 1.0
        rows = slice(None, None, 50)
        ends = np.concatenate([end[rows] for stick in body.sticks for end in stick.ends_m])
        seen = np.abs(self.project(ends)[0] - (np.array([WIDTH, HEIGHT]) * SCALE / 2))
        self.focal = float(FILLS * min(WIDTH * SCALE / seen[:, 0].max(), HEIGHT * SCALE / seen[:, 1].max()))
        self.distance_m = float(np.linalg.norm(looks))

    def project(self, points_m: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Pixels (n, 2) and pixels per metre there (n,)."""
        away = points_m - self.place_m
        scale = self.focal / np.maximum(away @ self.depth, 0.3)
        middle = np.array([WIDTH, HEIGHT]) * SCALE / 2
        return np.stack([away @ self.right, away @ self.down], axis=-1) * scale[:, None] + middle, scale


def render(moved: MovedRecording, scene: Scene, from_s: float, to_s: float) -> WalkingVideo:
    """Draw the walk between two of its times; before and after its motion the walker is still."""
    rng = np.random.default_rng([scene.seed, 77])
    body = _Body(moved, scene.is_on_treadmill)
    camera = _Camera(body, scene.view, rng)
    room = _room(rng)
    taken_s = np.arange(from_s, to_s, 1.0 / scene.rate_hz)
    taken_s = taken_s[rng.uniform(size=len(taken_s)) >= scene.lost]
    lamp = rng.uniform(0.0, 2 * np.pi, 2)
    light = 1.0 + scene.flicker * (
        np.sin(2 * np.pi * 100.0 * taken_s + lamp[0]) + np.sin(2 * np.pi * 0.7 * taken_s + lamp[1])
    )
    shaken = _shaken(len(taken_s), scene, camera, rng)
    passes_s = rng.uniform(from_s + 1.0, max(from_s + 1.5, to_s - 4.0)) if scene.is_passed else None
    grains = rng.normal(0.0, scene.noise * SCALE, (GRAINS, HEIGHT * SCALE, WIDTH * SCALE))
    frames = np.empty((len(taken_s), HEIGHT, WIDTH), np.uint8)
    for number, when_s in enumerate(taken_s):
        mean = np.zeros((HEIGHT * SCALE, WIDTH * SCALE))
        for part in (np.arange(SUBFRAMES) + 0.5) / SUBFRAMES - 0.5:
            mean += _drawn(body, camera, room, when_s + part * scene.exposure_s, shaken[number], scene, passes_s)
        grain = np.roll(grains[rng.integers(GRAINS)], rng.integers(mean.shape), axis=(0, 1))
        lit = mean / SUBFRAMES * light[number] + grain
        frames[number] = _compressed(np.clip(lit, 0, 255).astype(np.uint8))
    return WalkingVideo(taken_s + rng.normal(0.0, scene.jitter_s, len(taken_s)), frames)


def _room(rng: np.random.Generator) -> FloatArray:
    """A wall and a floor with some things, larger than the picture."""
    size = (2 * HEIGHT * SCALE, 2 * WIDTH * SCALE)
    room = 150.0 + 12.0 * np.kron(rng.normal(size=(size[0] // 20, size[1] // 20)), np.ones((20, 20)))
    room[int(0.6 * size[0]) :] -= 30.0
    return np.clip(room, 60.0, 230.0)


def _shaken(count: int, scene: Scene, camera: _Camera, rng: np.random.Generator) -> FloatArray:
    """How far the picture is moved, pixels (n, 2): a hand that sways and trembles."""
    if scene.shake_m == 0.0:
        return np.zeros((count, 2))
    spread = scene.shake_m * camera.focal / camera.distance_m
    raw = rng.normal(size=(count, 2))
    slow = gaussian_filter1d(raw, 0.5 * scene.rate_hz, axis=0)
    quick = gaussian_filter1d(raw[::-1], 0.08 * scene.rate_hz, axis=0)
    return spread * (slow / slow.std() + 0.15 * quick / quick.std())


def _drawn(
    body: _Body,
    camera: _Camera,
    room: FloatArray,
    when_s: float,
    moved_px: FloatArray,
    scene: Scene,
    passes_s: float | None,
) -> FloatArray:
    top, left = (room.shape[0] - HEIGHT * SCALE) // 2, (room.shape[1] - WIDTH * SCALE) // 2
    whole = shifted_picture(room, moved_px[::-1], order=1, mode="nearest") if scene.shake_m else room
    picture = whole[top : top + HEIGHT * SCALE, left : left + WIDTH * SCALE].copy()
    _draw(picture, body.sticks, body.at(when_s), camera, scene.contrast, moved_px)
    if passes_s is not None and 0.0 < when_s - passes_s < 5.0:
        # the same legs at another pace and another time, on the way across between camera and walker
        ends = body.at(float(body.time_s[len(body.time_s) // 2]) + 0.83 * (when_s - passes_s))
        hips = 0.5 * (ends[0][0] + ends[0][1])
        across = camera.place_m + 0.6 * camera.distance_m * camera.depth
        here = across + (when_s - passes_s - 2.5) * 1.1 * camera.right
        shifted = here - hips
        shifted[2] = 0.0
        moved_ends = [(a + shifted, b + shifted) for a, b in ends]
        _draw(picture, body.sticks, moved_ends, camera, scene.contrast, moved_px)
    return picture


def _draw(
    picture: FloatArray,
    sticks: list[_Stick],
    ends_m: list[tuple[FloatArray, FloatArray]],
    camera: _Camera,
    contrast: float,
    shift: FloatArray,
) -> None:
    points = np.array(ends_m)  # (sticks, 2, 3)
    far_first = np.argsort(-((points.mean(axis=1) - camera.place_m) @ camera.depth))
    pixels, scales = camera.project(points.reshape(-1, 3))
    pixels = pixels.reshape(-1, 2, 2) + shift
    scales = scales.reshape(-1, 2).mean(axis=1)
    for number in far_first:
        stick = sticks[number]
        a, b = pixels[number]
        radius = stick.radius_m * scales[number]
        low = np.maximum(np.floor(np.minimum(a, b) - radius - 1), 0).astype(int)
        high = np.minimum(np.ceil(np.maximum(a, b) + radius + 2), [picture.shape[1], picture.shape[0]]).astype(int)
        if np.any(high <= low):
            continue
        x, y = np.arange(low[0], high[0]), np.arange(low[1], high[1])[:, None]
        along = b - a
        u = np.clip(((x - a[0]) * along[0] + (y - a[1]) * along[1]) / max(along @ along, 1e-9), 0.0, 1.0)
        distance = np.hypot(x - a[0] - u * along[0], y - a[1] - u * along[1])
        cover = np.clip(radius + 0.5 - distance, 0.0, 1.0)
        shade = 140.0 + 130.0 * contrast * stick.shade + 12.0 * np.sin(2 * np.pi * stick.stripes * u)
        part = picture[low[1] : high[1], low[0] : high[0]]
        part += cover * (shade - part)


def _compressed(picture: Picture) -> Picture:
    stored = io.BytesIO()
    Image.fromarray(picture).save(stored, "JPEG", quality=70)
    return np.asarray(Image.open(stored).reduce(SCALE), np.uint8)
