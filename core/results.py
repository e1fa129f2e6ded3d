"""What an analysis finds: calibrations, angles, findings."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from types import ModuleType
from typing import TYPE_CHECKING

from core.body import Joint, Side, Site
from core.findings import Finding
from core.gait.clocks import LegClocks
from core.gait.events import FootEvents
from core.gait.strides import Strides
from core.hip.results import HipAngle, LegClock, PelvisAngles, PelvisTurn
from core.prosthesis import JointNature, Prostheses
from core.samples import FloatArray, IntArray
from core.session import RecordingKind
from core.signal.reception import Reception
from core.timed.found import TimedTest
from core.verdicts.model import Verdicts

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr


class Method(StrEnum):
    """How joints are identified and angles computed: robustly, or as published."""

    ROBUST = "robust"
    PUBLISHED = "published"


class AxisSource(StrEnum):
    """The motion, or the further step, that a joint axis comes from."""

    FREE_MOTION = "free_motion"
    WALKING = "walking"
    POOLED = "pooled"
    HINGE = "hinge"
    REFINED = "refined"


class ZeroKind(StrEnum):
    """What the zero of an angle rests on."""

    STANDING = "standing"
    GONIOMETER = "goniometer"
    NONE = "none"


@dataclass(frozen=True, slots=True)
class JointCalibration:
    """How two sensors sit on one joint, and how sure that is. None: could not be found.

    Axes are unit vectors, centres point from the joint to the sensor (eq 7), each in its own sensor's axes, as are the
    biases; those of the accelerometers were found together with the centres.
    `clinical_sign` (1 or -1) turns the twist about the axes (distal against proximal) into flexion or dorsiflexion;
    where `is_sign_certain` is False it is no more than the likelier one. `zero_rad` is subtracted from the twist
    before the sign, `offset_rad` (the goniometer's value) added after it.
    `is_same_joint` is False where both sensors do not move as adjacent segments; its evidence is `disagreement`, what
    the best common joint leaves of their accelerations (0 nothing, 1 all), and `is_lag_at_border`, that they would
    coincide best at a lag that no clock has. `is_clock_shared`: both sensors are declared to share one clock, so there
    is no lag to find. `nature`: what the joint is declared to be.
    """

    joint: Joint
    method: Method
    axis_proximal: FloatArray
    axis_distal: FloatArray
    axis_source: AxisSource
    axis_sd_rad: float | None
    centre_proximal_m: FloatArray | None
    centre_distal_m: FloatArray | None
    centre_sd_m: float | None
    sign_margin: float | None
    clinical_sign: int
    is_sign_certain: bool
    clinical_sign_margin: float | None
    lag_s: float
    lag_sd_s: float | None
    hinge_residual_rad_s: float | None
    is_hinge: bool
    gyro_bias_proximal_rad_s: FloatArray | None
    gyro_bias_distal_rad_s: FloatArray | None
    zero: ZeroKind
    zero_rad: float
    offset_rad: float
    standing_from: str | None
    free_motion_from: str | None
    walks_from: tuple[str, ...] = ()
    acc_bias_proximal_m_s2: FloatArray | None = None
    acc_bias_distal_m_s2: FloatArray | None = None
    is_same_joint: bool = True
    is_lag_at_border: bool = False
    is_clock_shared: bool = False
    disagreement: float | None = None
    nature: JointNature = JointNature.NOT_STATED


@dataclass(frozen=True, slots=True)
class Calibration:
    """The joints' calibrations that hold for `walks` (names of recordings)."""

    walks: tuple[str, ...]
    joints: Mapping[Joint, JointCalibration]


@dataclass(frozen=True, slots=True)
class JointAngle:
    """One joint's flexion over one recording; NaN in gaps. All arrays (n,), radians, clinical sign.

    `angle` is the result (the twist of the relative orientation; with the published method eq 15), `published` eq (15),
    `orientation` eq (10) from the device's quaternions or from VQF with magnetometer, None where there is neither.
    """

    angle_rad: FloatArray
    sd_rad: FloatArray
    published_rad: FloatArray
    orientation_rad: FloatArray | None


@dataclass(frozen=True, slots=True)
class SideGait:
    """One side of one walk. Times are on the recording's clock.

    `parameters`: per stride (k,): time and distance, peaks and ranges, named as in strides.csv; angles are radians and
    named so.
    `cycles`: per joint the angle over each stride, (k, 101) radians; NaN rows where it is not known.
    `is_toe_off_biased`: the side's toe-offs may be early or late, alike in every stride, so its stance and swing are
    neither to be judged against a band nor compared with another side's: a prosthetic foot rolls on where a heel would
    rise.
    """

    events: tuple[FootEvents, ...]  # one item per stretch without gaps
    strides: Strides
    parameters: Mapping[str, FloatArray]
    cycles: Mapping[Joint, FloatArray]
    phase: IntArray  # (n,): index into `core.gait.phases.PHASES` at each sample of the recording
    is_toe_off_biased: bool = False


@dataclass(frozen=True, slots=True)
class AxisHalves:
    """How far a joint's axes are apart as two parts of the data show them, each by itself.

    `spread`: by the name of a stride's parameter, rad: half of what its mean over the walk differs by with the axes of
    either part, beyond chance.
    """

    apart_rad: float  # between the lines of the axes, of the sensor at which it is more
    sd_rad: float  # formal standard deviation of a part's axes, of both parts root mean square
    is_free_motion: bool  # the parts are a free motion and the walks; else both halves of the walks
    spread: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class RecordingAnalysis:
    """Angles of one recording, all on the clock `time_s` (n,); gait of the sides that walked with a foot sensor.

    Attributes
    ----------
    received
        What it holds of each sensor, by site: gaps, samples at the end of the range, the rate.
    slipped_from_s
        From when on a side's straps are not to be trusted, on the recording's clock; -inf throughout.
    drifting_percent
        How much faster than its leg's clock that of a site runs, where it does.
    doubted_sites
        Whose sensors the motion wants exchanged: what they show is of another segment.
    axis_halves
        Of a walk's knees and ankles; a joint is missing where two parts of the data hold too little movement.
    clocks
        What ties the clocks of both legs; None where not both were measured.
    hips, pelvis, turns, leg_clock
        What a sensor on the pelvis adds: hip angles, the pelvis itself, turns of the body, and how far the legs' clocks
        are apart. Empty and None without one.
    verdicts
        What may be stated about it; whoever changes what is above makes them again.
    timed
        Of a walk that is a timed test.
    """

    name: str
    folder: str
    kind: RecordingKind
    time_s: FloatArray
    joints: Mapping[Joint, JointAngle]
    gait: Mapping[Side, SideGait] = field(default_factory=dict)
    received: Mapping[Site, Reception] = field(default_factory=dict)
    slipped_from_s: Mapping[Side, float] = field(default_factory=dict)
    drifting_percent: Mapping[Site, float] = field(default_factory=dict)
    doubted_sites: frozenset[Site] = frozenset()
    axis_halves: Mapping[Joint, AxisHalves] = field(default_factory=dict)
    clocks: LegClocks | None = None
    hips: Mapping[Joint, HipAngle] = field(default_factory=dict)
    pelvis: PelvisAngles | None = None
    turns: tuple[PelvisTurn, ...] = ()
    leg_clock: LegClock | None = None
    verdicts: Verdicts = field(default_factory=Verdicts)
    timed: TimedTest | None = None

    @property
    def lost_percent(self) -> Mapping[Site, float]:
        """Samples missing, by site."""
        return {site: one.lost_percent for site, one in self.received.items()}

    @property
    def measured(self) -> Mapping[Joint, JointAngle | HipAngle]:
        """Every joint that has an angle, the hips last."""
        return {**self.joints, **self.hips}


@dataclass(frozen=True, slots=True)
class Analysis:
    """Everything one session gives. `calibrations` one per span of validity, in order of time.

    `stiff_sides` are those that a patient's device or condition may stiffen: the affected and the prosthetic ones.
    `prostheses`: what was stated of those that are worn, and is taken for true here.
    """

    method: Method
    is_simulated: bool
    calibrations: tuple[Calibration, ...]
    recordings: tuple[RecordingAnalysis, ...]
    findings: tuple[Finding, ...] = ()
    affected_side: Side | None = None
    stiff_sides: frozenset[Side] = frozenset()
    prostheses: Prostheses = field(default_factory=dict)

    def calibrated_for(self, recording: RecordingAnalysis) -> Mapping[Joint, JointCalibration]:
        """The calibrations that `recording` was measured with."""
        for calibration in self.calibrations:
            if recording.name in calibration.walks:
                return calibration.joints
        for calibration in self.calibrations:  # a free motion is measured with what it gave
            if any(found.free_motion_from == recording.name for found in calibration.joints.values()):
                return calibration.joints
        return self.calibrations[-1].joints if self.calibrations else {}

    def to_dataframe(self, table: str = "angles") -> "pd.DataFrame":
        """One tidy table of all recordings, with the gaps and the status that the CSV files have.

        Parameters
        ----------
        table
            "angles": a row for each sample. "cycles": a row for each percent of the mean gait cycle. "strides": a row
            for each stride and figure.

        Returns
        -------
        pandas.DataFrame
            Columns `recording`, `side` (left, right, or empty for the pelvis), `time_s` (of a stride its start) or
            `percent`, `quantity`, `value` and `sd` in the unit that the quantity's name ends with, `status`. An sd is
            that of the angle, or that over `n` strides; NaN where none is known. Strides also have `used` and `reason`.
            `status` is "read", "care", "no_zero" (the shape holds, the absolute angle does not), "range_only" (neither
            does the direction), "withheld" (not reported), "not_measured", or empty. As in angles.csv, samples that are
            not reported keep their value; in the other tables it is NaN.

        Raises
        ------
        ImportError
            pandas is not installed; the message states what to install.
        ValueError
            There is no such table.
        """
        return _frames().to_dataframe(self, table)

    def to_xarray(self, recording: str, table: str = "angles") -> "xr.Dataset":
        """Angles or cycles of one recording with named axes.

        Parameters
        ----------
        recording
            Its name.
        table
            "angles" or "cycles", as `to_dataframe` has them.

        Returns
        -------
        xarray.Dataset
            `value`, `sd` and `status` by `quantity`, `side`, and `time_s` or `percent`; of cycles also `n` by quantity
            and side. What a side does not have is NaN with an empty status.

        Raises
        ------
        ImportError
            xarray is not installed; the message states what to install.
        KeyError
            There is no such recording.
        ValueError
            There is no such table, or it is that of strides, which have no common axis.
        """
        return _frames().to_xarray(self, recording, table)


def _frames() -> ModuleType:
    from core import frames  # it is made of these classes

    return frames
