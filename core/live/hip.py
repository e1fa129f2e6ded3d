"""Flexion of a hip as it moves: against the vertical at first, and by Cardan angles once the heading is sure.

Both forms are those of `core.hip.frames`, with causal orientations. The first needs no heading; the second is right
where the hip is turned out as well. What is shown goes over from one to the other on half a cosine.
"""

from collections import deque
from collections.abc import Iterable
from copy import copy

import numpy as np

from core.hip.measure import DEEP_RAD, DEEP_SD_RAD, SD_RAD, SD_SHARE
from core.hip.results import HipIdentification
from core.live.angle import (
    BLEND_S,
    MAX_START_RAD,
    SETTLED_RAD,
    SETTLES_S,
    START_MOVING_RAD,
    AngleSamples,
    followed_by_beats,
    start_sd_at,
    start_sd_of,
    still_ahead,
)
from core.live.hip_heading import HipHeadingState
from core.live.joint_frames import orientation_map
from core.live.orientation import OrientedSamples
from core.live.pairing import PairedSamples, Pairing
from core.samples import ComplexArray, FloatArray
from core.signal.rotations import wrap

BEAT_S = 0.5  # heading and posture are looked at once in this time, on the pelvis's grid
BEHIND_S = 1.5  # the heading of an instant is known by then, however the samples were cut into blocks
SETTLED_AFTER = 6.0  # times SETTLES_S: what is left of a start is under a twentieth of a degree
POSTURE_S = 5.0  # over which the usual angle is taken, from which on the standard deviation grows


class LiveHip:
    """The flexion of one hip, from standing, with the frames in force.

    Parameters
    ----------
    pelvis_step_s, thigh_step_s
        Of the two streams' grids.
    """

    def __init__(self, found: HipIdentification, pelvis_step_s: float, thigh_step_s: float) -> None:
        self._step_s = pelvis_step_s
        self._per_beat = max(1, round(BEAT_S / pelvis_step_s))
        self._pairing = Pairing(pelvis_step_s, thigh_step_s, found.lag_s)
        self._form = self._required = _Form(found, None)
        self._coming: deque[HipHeadingState] = deque()
        self._beat, self._next = 0, -1
        self._started_s, self._start_sd_rad = 0.0, START_MOVING_RAD
        self._sum, self._count = 0.0, 0  # of the angles of this beat
        self._usual: float | None = None
        self._blend: tuple[float, float] | None = None  # since when, and how far ahead of the form in force then

    @property
    def is_provisional(self) -> bool:
        """Whether the heading is not sure yet: the angle leans on the vertical alone."""
        return self._form.heading_rad is None

    @property
    def lag_s(self) -> float:
        """What is added to the thigh's stamps to bring them to the pelvis's clock."""
        return self._pairing.lag_s

    def recalibrate(self, found: HipIdentification) -> None:
        """Go over to other frames of the same hip, from the next beat on, without a jump."""
        self._required = _Form(found, self._required.heading_rad)
        self._pairing.lag_s = found.lag_s

    def expect(self, states: Iterable[HipHeadingState]) -> None:
        """Take what is found of the heading, in order; each counts from BEHIND_S after its last sample on."""
        self._coming.extend(states)

    def update(self, pelvis: OrientedSamples, thigh: OrientedSamples) -> AngleSamples:
        """Take new samples of both sensors in order; give the angle up to both, on the thigh's clock."""
        rows = self._pairing.update(pelvis, thigh)
        angle, sd = followed_by_beats(rows, self._per_beat, self._follow)
        return AngleSamples(rows.tick, rows.time_s - self._pairing.lag_s, angle, sd)

    def _follow(self, rows: PairedSamples, beat: int) -> tuple[FloatArray, FloatArray]:
        """Angle and standard deviation (n,) of samples of one beat that follow each other."""
        if rows.tick[0] != self._next:
            self._start(rows)
            self._form = self._required
        elif beat != self._beat:
            self._look(rows)
        self._beat, self._next = beat, int(rows.tick[-1]) + 1
        angle, ahead = self._form.flexion(rows), self._ahead(rows.time_s)
        if self._blend is not None:
            angle = wrap(angle + ahead)
        self._sum, self._count = self._sum + float(angle.sum()), self._count + len(angle)
        usual = self._usual if self._usual is not None else angle
        sd = SD_RAD + SD_SHARE * np.abs(angle - usual) + DEEP_SD_RAD * (angle > DEEP_RAD)
        if rows.time_s[0] > self._started_s + SETTLED_AFTER * SETTLES_S:
            return angle, np.sqrt(sd**2 + (SETTLED_RAD**2 + ahead**2))
        start_sd = start_sd_at(rows.time_s, self._started_s, self._start_sd_rad)
        sd = np.sqrt(sd**2 + start_sd**2 + ahead**2)
        is_unsure = start_sd > MAX_START_RAD
        angle[is_unsure] = sd[is_unsure] = np.nan
        return angle, sd

    def _start(self, rows: PairedSamples) -> None:
        """A stretch begins: resting, where gravity shows the vertical at once, or amid a movement."""
        self._started_s, self._start_sd_rad = float(rows.time_s[0]), start_sd_of(rows)
        while self._coming and self._coming[0].until_s < self._started_s:
            self._coming.popleft()  # of orientations that are no more
        self._required = self._required.turned(None)
        self._blend, self._sum, self._count = None, 0.0, 0

    def _look(self, rows: PairedSamples) -> None:
        """What the beat that has ended shows of the slow things."""
        if self._count:
            mean, share = self._sum / self._count, 1 - np.exp(-self._count * self._step_s / POSTURE_S)
            self._usual = mean if self._usual is None else self._usual + share * (mean - self._usual)
        self._sum, self._count = 0.0, 0
        time_s = float(rows.time_s[0])
        while self._coming and self._coming[0].until_s + BEHIND_S <= time_s:
            state = self._coming.popleft()
            if state.until_s > self._started_s:
                self._required = self._required.turned(state.heading_rad if state.is_sure else None)
        if self._required is not self._form:
            first = rows.part(slice(0, 1))
            ahead = self._form.flexion(first) + self._ahead(first.time_s) - self._required.flexion(first)
            self._form, self._blend = self._required, (time_s, float(wrap(ahead)[0]))

    def _ahead(self, time_s: FloatArray) -> FloatArray | float:
        """How far (n,) what is shown is still ahead of the form in force; 0 where it is not."""
        if self._blend is None:
            return 0.0
        since_s, ahead_rad = self._blend
        if time_s[0] > since_s + BLEND_S:
            self._blend = None
            return 0.0
        return still_ahead(time_s, since_s, ahead_rad)


class _Form:
    """How the flexion is read off both orientations; `heading_rad` None: against the vertical."""

    # of u and v as in core.live.joint_frames, 2 Im(u* v) is how far the frame's x points down, |u|^2 - |v|^2 its z up
    def __init__(self, found: HipIdentification, heading_rad: float | None) -> None:
        self.found, self.heading_rad = found, heading_rad
        self._maps = orientation_map(found.frame_proximal.T), orientation_map(found.frame_distal.T)

    def turned(self, heading_rad: float | None) -> "_Form":
        """The same with another heading."""
        form = copy(self)
        form.heading_rad = heading_rad
        return form

    def flexion(self, rows: PairedSamples) -> FloatArray:
        """The flexion (n,), rad."""
        (u1, v1), (u2, v2) = (rows.proximal[:, 0:4] @ self._maps[0]).T, (rows.distal[:, 0:4] @ self._maps[1]).T
        if self.heading_rad is None:
            return wrap(_pitch(u1, v1) - _pitch(u2, v2))
        half = np.exp(0.5j * self.heading_rad)
        u2, v2 = half * u2, half * v2
        u, v = np.conj(u1) * u2 + v1 * np.conj(v2), np.conj(u1) * v2 - v1 * np.conj(u2)  # of the thigh in the pelvis
        return np.asarray(-np.arctan2(2 * (u * v).imag, _square(u) - _square(v)))


def _pitch(u: ComplexArray, v: ComplexArray) -> FloatArray:
    return np.asarray(np.arctan2(2 * (np.conj(u) * v).imag, _square(u) - _square(v)))


def _square(z: ComplexArray) -> FloatArray:
    return np.asarray(z.real**2 + z.imag**2)
