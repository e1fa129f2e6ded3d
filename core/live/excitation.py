"""How well a free motion would identify a joint, were it stopped now, and which motion is missing.

Every tenth of a second, from what the calibration itself uses: for the axis the relative rate under all relative
headings, for the centre eq 8 of Seel et al. 2014 (doi 10.3390/s140406891) with the accelerometers' biases and the
distal sensor's lag among the unknowns. How far tissue misleads both was measured on simulated calibrations stopped at
random times (tests/benchmarks/excitation.py).
"""

import math
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from core.body import LEG_JOINTS, Joint, Site
from core.calibration.certainty import AXIS_FLOOR_HINGE_RAD, AXIS_FLOOR_HUMAN_RAD
from core.calibration.coincidence import BIAS_PRIOR_M_S2, CENTRE_PRIOR_M
from core.calibration.joint_centre import IN_STEP_M, MIN_SCALE_M_S2, MIN_SD_HINGE_M, MIN_SD_HUMAN_M, SD_FACTOR_HUMAN
from core.live.heading_profile import HeadingProfile, profile_headings
from core.live.orientation import OrientedSamples
from core.live.sample_sets import NODE_S, SPACING_S, SetCollector, Sets, parabola
from core.samples import FloatArray
from core.signal.pair import MOVING_RAD_S
from core.signal.robust import robust_sd

MIN_SETS = 10  # a second of movement; before, nothing is known
REFIT_SETS, SELDOM_SETS = 10, 20  # the best hypothesis is determined again each second, later each other second
LAG_PRIOR_S = 0.03
MAX_LAG_S = 1.5 * NODE_S  # farther the parabola through three instants does not reach
FIRST_STEPS = 10
MAX_CENTRE_STEP_M = 0.1
MIN_RATE_SCALE_RAD_S = 0.01
AXIS_PRIOR_RAD = 1.0
MIN_MARGIN = 1.3
REOPENS_AT = 1.25  # of what closes it
PLATEAU_AFTER = round(10.0 / SPACING_S)
PROGRESS_OVER = round(4.0 / SPACING_S)
MIN_PROGRESS = 0.1
SHARED = 0.25  # of the least certain direction


@dataclass(frozen=True, slots=True)
class Required:
    """What closes a joint, what no motion can reduce, and how far its sensors move against their segments.

    `tilt_rad`, `shift_m`: in step with the motion, so that no length of it averages them out.
    `is_hinge`: one axis by construction: its floors grow with what the sensors turn across it, and no centre shows
    along it.
    """

    axis_rad: float
    centre_m: float
    axis_floor_rad: float
    centre_floor_m: float
    tilt_rad: float
    shift_m: float
    wobble: float  # share of a segment's rate that its sensor may turn beside it; a relative rate below shows no joint
    is_hinge: bool


HUMAN = Required(
    axis_rad=np.deg2rad(1.5),
    centre_m=0.010,
    axis_floor_rad=float(AXIS_FLOOR_HUMAN_RAD),
    centre_floor_m=MIN_SD_HUMAN_M,
    tilt_rad=np.deg2rad(0.5),
    shift_m=IN_STEP_M,
    wobble=0.06,
    is_hinge=False,
)
PROSTHESIS = Required(
    axis_rad=np.deg2rad(0.5),
    centre_m=0.005,
    axis_floor_rad=float(AXIS_FLOOR_HINGE_RAD),
    centre_floor_m=MIN_SD_HINGE_M,
    tilt_rad=np.deg2rad(0.1),
    shift_m=0.3 * IN_STEP_M,
    wobble=0.02,
    is_hinge=True,
)


class Movement(StrEnum):
    """CIRCLE: the segment's far end describes circles. BEND: the joint at its near end bends and stretches."""

    CIRCLE = "circle"
    BEND = "bend"


@dataclass(frozen=True, slots=True)
class Missing:
    """The motion that would be most informative: of the segment that carries `site`."""

    site: Site
    movement: Movement


@dataclass(frozen=True, slots=True)
class ExcitationState:
    """What the motion so far would give.

    `axis_sd_rad`, `centre_sd_m`: what motion can still reduce: for the gauge. The centre's along the least certain
    observable direction.
    `axis_sd_with_floor_rad`, `centre_sd_with_floor_m`: how far the calibration may be from the truth.
    `is_plateau`: not closed, and ten seconds of movement in, four more brought less than a tenth: as good as this
    motion gives.
    `trend`: share of what is wanting that the last four seconds of movement took away; negative where it grew, 1
    before.
    """

    axis_sd_rad: float
    centre_sd_m: float
    axis_sd_with_floor_rad: float
    centre_sd_with_floor_m: float
    sign_margin: float  # cost of the best rival over the best hypothesis; 1 while nothing is known
    wanting: float  # the worse of both gauges' figures over what closes it
    is_closed: bool  # good enough
    is_plateau: bool
    trend: float
    missing: Missing | None  # None once closed
    moved_s: float  # how much movement has been used


class Excitation:
    """The excitation of one joint during a free motion; an ankle's axis, which walking closes, is not asked for."""

    def __init__(self, joint: Joint, closes_at: Required = HUMAN) -> None:
        self._joint, self._required = joint, closes_at
        self._collector = SetCollector()
        self._axis = _AxisInformation(closes_at.tilt_rad, closes_at.wobble)
        self._centre = _CentreInformation(closes_at.shift_m)
        self._used = 0
        self._next_refit = MIN_SETS + LEG_JOINTS.index(joint)  # not all joints at the same moment
        self._heading_in_force = 0  # of the sets that show the axis: where an orientation restarted, the longer part
        self._wanting: deque[float] = deque(maxlen=PROGRESS_OVER + 1)
        self._is_closed = False
        shank = joint.distal if joint.is_knee else joint.proximal
        self._missing = Missing(shank, Movement.CIRCLE)  # which moves what lies above and below it, too
        self.state = self._judged()

    @property
    def heading_rad(self) -> float | None:
        """Of the distal earth in the proximal one, None while it is not known."""
        return None if self._axis.profile is None else self._axis.profile.heading_rad

    def update(self, proximal: OrientedSamples, distal: OrientedSamples) -> ExcitationState:
        """Take samples of both sensors, any number of either; the state after the last whole tenth of a second."""
        for _ in self.states(proximal, distal):
            pass
        return self.state

    def states(self, proximal: OrientedSamples, distal: OrientedSamples) -> Iterator[ExcitationState]:
        """The same, telling the state after every tenth of a second."""
        for is_new in self._collector.feed(proximal, distal):
            if is_new:
                is_refitted = self._add()
                self.state = self._judged(is_refitted)
            yield self.state

    def _add(self) -> bool:
        """Take the newest set; whether the best hypothesis was determined again."""
        self._used += 1
        if self._used < self._next_refit:
            newest = self._collector.newest
            self._centre.add(newest)
            if self._collector.headings == self._heading_in_force:
                self._axis.add(newest, self._centre.lag_s)
            return False
        self._next_refit = self._used + (REFIT_SETS if self._used < PLATEAU_AFTER // 2 else SELDOM_SETS)
        self._centre.refit(self._collector.sets)
        of_one_heading = self._collector.of_one_heading
        is_same = self._collector.headings == self._heading_in_force
        if len(of_one_heading) >= (MIN_SETS if is_same else max(MIN_SETS, self._axis.count)):
            self._axis.refit(of_one_heading, self._centre.lag_s)
            self._heading_in_force = self._collector.headings
        return True

    def _judged(self, is_refitted: bool = False) -> ExcitationState:
        profile, required = self._axis.profile, self._required
        axis_rad = self._axis.sd_rad()
        covariance = self._centre.covariance()
        if (self._joint.is_knee or required.is_hinge) and profile is not None:
            covariance = profile.across @ covariance @ profile.across
        of_each = np.linalg.eigvalsh(np.stack([covariance[:3, :3], covariance[3:, 3:]]))
        centre_m = math.sqrt(of_each[:, -1].max())
        margin = profile.margin if profile is not None else 1.0

        axis_wanting = axis_rad / required.axis_rad if self._joint.is_knee else 0.0
        wanting = max(axis_wanting, centre_m / required.centre_m)
        limit = REOPENS_AT if self._is_closed else 1.0
        self._is_closed = profile is not None and wanting <= limit and (margin >= MIN_MARGIN or not self._joint.is_knee)
        if self._used:
            self._wanting.append(wanting)
        if is_refitted:  # not more often: nobody can follow a hint that changes ten times a second
            self._missing = self._hint(axis_wanting, wanting, margin, covariance)
        loose = self._axis.looseness if required.is_hinge else 0.0
        trend = 1 - wanting / self._wanting[0] if len(self._wanting) > PROGRESS_OVER else 1.0
        is_plateau = not self._is_closed and self._used >= PLATEAU_AFTER and trend < MIN_PROGRESS
        return ExcitationState(
            axis_sd_rad=axis_rad,
            centre_sd_m=centre_m,
            axis_sd_with_floor_rad=math.hypot(axis_rad, required.axis_floor_rad, loose),
            centre_sd_with_floor_m=math.hypot(
                SD_FACTOR_HUMAN * centre_m, required.centre_floor_m, CENTRE_PRIOR_M * loose
            ),
            sign_margin=margin,
            wanting=wanting,
            is_closed=self._is_closed,
            is_plateau=is_plateau,
            trend=trend,
            missing=None if self._is_closed else self._missing,
            moved_s=self._used * SPACING_S,
        )

    def _hint(self, axis_wanting: float, wanting: float, margin: float, covariance: FloatArray) -> Missing:
        """The motion that would be most informative now."""
        proximal, distal = self._joint.proximal, self._joint.distal
        # a foot bends too little about one line to show where its joint lies
        is_bending_enough = self._joint.is_knee or self._required.is_hinge
        bending = Missing(distal, Movement.BEND if is_bending_enough else Movement.CIRCLE)
        profile = self._axis.profile
        if profile is None:
            return self._missing
        if profile.bending_rad_s < MOVING_RAD_S:
            return bending
        if self._joint.is_knee and (margin < MIN_MARGIN or axis_wanting == wanting):
            if margin >= MIN_MARGIN and not self._axis.is_in_doubt:
                return bending
            energy_1, energy_2 = self._centre.energies
            return Missing(proximal if energy_1 < energy_2 else distal, Movement.CIRCLE)
        weakest = np.linalg.eigh(covariance)[1][:, -1]
        share = float(weakest[:3] @ weakest[:3])
        if min(share, 1 - share) > SHARED:  # both sensors agree on the point, but any would do
            return bending
        return Missing(proximal if share > 0.5 else distal, Movement.CIRCLE)


class _AxisInformation:
    """How well the relative rate shows both axes, at the heading that fits best."""

    def __init__(self, tilt_rad: float, wobble: float) -> None:
        self._tilt_rad, self._wobble = tilt_rad, wobble
        self.profile: HeadingProfile | None = None
        self.count, self._along, self._across, self._felt = 0, 0.0, 0.0, 0.0

    def refit(self, sets: Sets, lag_s: float) -> None:
        self.profile = profile_headings(sets, lag_s)
        self.count, self._along, self._across, self._felt = 0, 0.0, 0.0, 0.0
        self.add(sets, lag_s)

    def add(self, sets: Sets, lag_s: float) -> None:
        if self.profile is None:
            return
        rate_1, rate_2 = sets.rates_in_earth(lag_s)
        c, s = math.cos(self.profile.heading_rad), math.sin(self.profile.heading_rad)
        relative = rate_2 @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) - rate_1
        along = np.einsum("ni,ni->n", relative, sets.earth_from_1 @ self.profile.axis_1)
        energy = float(along @ along)
        self.count += len(sets)
        self._along += energy
        self._across += float(np.vdot(relative, relative)) - energy
        self._felt += float(np.vdot(rate_1, rate_1) + np.vdot(rate_2, rate_2))

    def _of_motion_rad(self) -> float:
        """Standard deviation of an axis at the best heading."""
        # the principal direction of rates that scatter by s across it and amount to A along it is uncertain by s /
        # sqrt(A) where A dominates; a tilt in step with the motion adds to every sample alike
        if self.profile is None or not self.count:
            return AXIS_PRIOR_RAD
        across = max(0.5 * self._across, 0.5 * self._wobble**2 * self._felt, self.count * MIN_RATE_SCALE_RAD_S**2)
        along = min(self._along, self.count * self.profile.bending_rad_s**2)
        information = self.count * max(along / across - 1, 0.0)
        in_step = self.count * self._tilt_rad**2 * along / across
        return 1 / math.sqrt(information / (1 + in_step) + AXIS_PRIOR_RAD**-2)

    @property
    def looseness(self) -> float:
        """Rate across the axis over the rate along it, as `certainty.looseness` has it."""
        return math.sqrt(0.5 * self._across / max(self._along, 1e-12))

    def sd_rad(self) -> float:
        if self.profile is None:
            return AXIS_PRIOR_RAD
        return math.hypot(self._of_motion_rad(), max(self.profile.spread_1_rad, self.profile.spread_2_rad))

    @property
    def is_in_doubt(self) -> bool:
        """Whether other headings, rather than too little bending, make the axis uncertain."""
        profile = self.profile
        return profile is not None and max(profile.spread_1_rad, profile.spread_2_rad) > self._of_motion_rad()


class _CentreInformation:
    """Eq 8, linear about the best centres: o1, o2 (m), b1, b2 (m/s2), lag added to the distal stamps (s), (13,)."""

    def __init__(self, shift_m: float) -> None:
        self._shift_m = shift_m
        self._x = np.zeros(13)
        self._prior = np.diag([CENTRE_PRIOR_M**-2] * 6 + [BIAS_PRIOR_M_S2**-2] * 6 + [LAG_PRIOR_S**-2])
        self._scale: float | None = None
        self._information = np.zeros((13, 13))
        self.energies = np.zeros(2)

    @property
    def lag_s(self) -> float:
        """What is to be added to the distal sensor's stamps, as far as the parabola reaches."""
        return max(-MAX_LAG_S, min(MAX_LAG_S, float(self._x[12])))

    def refit(self, sets: Sets) -> None:
        for _ in range(FIRST_STEPS if self._scale is None else 1):
            error, slope = self._linear(sets)
            self._scale = max(robust_sd(error), MIN_SCALE_M_S2)
            weight = self._weight(error)
            information = (slope * weight[:, None]).T @ slope + self._prior
            step = -np.linalg.solve(information, slope.T @ (weight * error) + self._prior @ self._x)
            self._x = self._x + step * min(1.0, MAX_CENTRE_STEP_M / float(np.max(np.abs(step[:6]))))
        self._information, self.energies = np.zeros((13, 13)), np.zeros(2)
        self.add(sets)

    def add(self, sets: Sets) -> None:
        if self._scale is None:
            return
        error, slope = self._linear(sets)
        weight = self._weight(error)
        self._information += (slope * weight[:, None]).T @ slope
        self.energies += weight @ sets.effort

    def covariance(self) -> FloatArray:
        """Of both centres (6, 6)."""
        # a shift in step with the motion looks the same in every sample, so that its energy, counted in residuals,
        # divides the information however long the motion lasts
        in_step = self._shift_m**2 * float(self.energies.sum())
        covariance: FloatArray = np.linalg.inv(self._information / (1 + in_step) + self._prior)
        return covariance[:6, :6]

    def _weight(self, error: FloatArray) -> FloatArray:
        assert self._scale is not None
        return 1 / (self._scale**2 * np.sqrt(1 + (error / self._scale) ** 2))

    def _linear(self, sets: Sets) -> tuple[FloatArray, FloatArray]:
        """Eq 8's residual (n,) and its slopes (n, 13)."""
        x = self._x
        one = sets.a1 - x[6:9] - sets.k1 @ x[0:3]
        two = sets.a2 - x[9:12] - sets.k2 @ x[3:6]
        length_1, length_2 = np.sqrt(np.einsum("ni,ni->n", one, one)), np.sqrt(np.einsum("nmi,nmi->nm", two, two))
        share, slope_of_share = parabola(self.lag_s)
        slope = np.empty((len(sets), 13))
        slope[:, 6:9] = -one / length_1[:, None]
        parts = two * (share / length_2)[:, :, None]
        slope[:, 9:12] = parts.sum(axis=1)
        slope[:, 0:3] = (slope[:, None, 6:9] @ sets.k1)[:, 0]
        slope[:, 3:6] = (parts[:, :, None, :] @ sets.k2).sum(axis=1)[:, 0]
        slope[:, 12] = -length_2 @ slope_of_share
        return length_1 - length_2 @ share, slope
