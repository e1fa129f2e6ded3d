"""What a prosthetist has set at a simulated leg, and what geometry alone makes of it.

Modelled, since no choice of the patient is in it:

- a foot set more plantarflexed points so much further down wherever nothing bends it: in swing, as it lands and as it
  leaves the floor. It lands flatter, is flat sooner, and the heel rises while the shank leans by so much less;
- a foot set further back is so much further behind the hip: the shank leans further forward in all of stance, and
  the heel rises sooner by what the hip takes for that way;
- what stops the knee stops it so much earlier: in late swing, and wherever it was straighter in stance;
- resistance to extension brings the knee to its stop later, resistance to flexion lowers the peak of swing, and
  resistance in stance lowers the peak of loading;
- a longer pylon is a longer shank.

How prostheses of other make move is drawn by hand: it makes them differ as their kinds do, and is no figure of people.
A foot without a joint bends in itself, an energy-storing one by more and later, and springs back as it leaves the
floor. One with an axis is flat sooner. A hydraulic ankle stays dorsiflexed in swing (Johnson et al. 2014, doi
10.1682/JRRD.2013.05.0126, abstract read). Several axes let the foot invert. A knee of several axes turns about a point
that comes down from above the knee as it bends, which shortens the leg in swing: by 0.9 to 3.2 cm more than one axis
does (Gard, Childress & Uellendahl 1996, J Prosthet Orthot 8(2):34, abstract read).

Not modelled: that people compensate. Where the knee of above-knee users was moved by 2 cm, the hip's moment, the length
of the step and the trunk answered (Koehler-McNicholas, Lipschutz & Gard 2016, J Rehabil Res Dev 53(6):1089, abstract
read); in ten with a prosthesis below the knee neither angles nor times changed (Jonkergouw 2019, Gait Posture 68:122,
abstract and highlights read). So a change here moves more than it will on people, and proves nothing about them.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from core.prosthesis import FootKind, KneeKind, Prosthesis
from core.samples import FloatArray

STOPPED_DEG = 1.5  # where the knee is stopped as built: the least of its curve in swing
LEAST_FLAT_S = 0.03  # of a foot that is hardly flat before its heel rises


@dataclass(frozen=True, slots=True)
class ProsthesisSetting:
    """A prosthesis against how it was built.

    `back_mm`, `height_mm`: the foot further back, the pylon longer.
    """

    plantar_deg: float = 0.0  # the foot against the pylon, plantarflexed positive
    back_mm: float = 0.0
    height_mm: float = 0.0
    stop_deg: float = 0.0  # how much earlier the knee is stopped in extending
    extension: float = 1.0  # resistance to extension in late swing over that as built
    swing_flexion_deg: float = 0.0  # added to the knee's peak in swing, by less resistance to flexion
    stance_flexion: float = 1.0  # of the peak of loading the share that resistance in stance allows
    is_locked: bool = False  # while walking

    def __post_init__(self) -> None:
        if not self.extension > 0.0:
            raise ValueError(f"extension is {self.extension}, expected more than 0")

    @property
    def plantar_rad(self) -> float:
        return float(np.deg2rad(self.plantar_deg))

    def sooner_s(self, leg_m: float, speed_m_s: float) -> float:
        """How much earlier the heel rises when the hip goes by at this speed over a leg of this length."""
        return (self.plantar_rad * leg_m + 1e-3 * self.back_mm) / speed_m_s

    def stopped(self, knee_rad: FloatArray) -> FloatArray:
        """Flexion (n,) of a knee that is stopped sooner."""
        return np.maximum(knee_rad, np.deg2rad(STOPPED_DEG + self.stop_deg)) if self.stop_deg > 0.0 else knee_rad

    def extending(self, share: float, peak: float) -> float:
        """When, as a share of swing, the knee is where it was at `share` as built; it turns at `peak`."""
        if self.extension == 1.0 or share <= peak:
            return share
        return peak + (1.0 - peak) * float(((share - peak) / (1.0 - peak)) ** (1.0 / self.extension))


AS_BUILT = ProsthesisSetting()
# a knee that is held nearly straight in stance, and swings less than a sound one
HELD_STRAIGHT = ProsthesisSetting(stance_flexion=0.2, swing_flexion_deg=-6.0)
_KNEES: Mapping[KneeKind, ProsthesisSetting] = {
    KneeKind.LOCKED: ProsthesisSetting(is_locked=True),
    KneeKind.SINGLE_AXIS: ProsthesisSetting(stance_flexion=0.05, swing_flexion_deg=3.0),
    KneeKind.POLYCENTRIC: ProsthesisSetting(stance_flexion=0.1, swing_flexion_deg=-2.0),
    KneeKind.FLUID_CONTROLLED: HELD_STRAIGHT,
    KneeKind.MICROPROCESSOR: ProsthesisSetting(stance_flexion=0.5),
}
OWN_KNEE_STANCE_FLEXION = 0.6  # above a transtibial prosthesis


def built(fitted: Prosthesis) -> ProsthesisSetting:
    """How a prosthesis of this make walks before anything is changed; one of no stated knee, as a sound leg bends."""
    return _KNEES[fitted.knee] if fitted.knee is not None else AS_BUILT


def with_own_knee(setting: ProsthesisSetting) -> ProsthesisSetting:
    """What of a setting is left where the knee is the patient's: foot and pylon."""
    foot = ProsthesisSetting(setting.plantar_deg, setting.back_mm, setting.height_mm)
    return replace(foot, stance_flexion=OWN_KNEE_STANCE_FLEXION)


@dataclass(frozen=True, slots=True)
class ProstheticFoot:
    """How a foot turns against the pylon: when it is flat and its heel rises, as shares of the stride, and how far.

    `moved_by_hand` and `inverts` are shares of what a person's ankle does.
    """

    full_contact: float
    heel_rise: float
    contact_deg: float  # as it lands, dorsiflexed positive
    toe_off_deg: float
    swing_deg: float
    moved_by_hand: float
    inverts: float = 0.0
    springs_back: bool = False  # it has no joint: unloaded it is as built


STIFF_FOOT = ProstheticFoot(0.14, 0.30, -3.0, -2.0, 2.0, 0.2)  # of no stated kind
_HYDRAULIC = ProstheticFoot(0.09, 0.34, -1.0, 5.0, 5.0, 0.6)
_FEET: Mapping[FootKind, ProstheticFoot] = {
    FootKind.SACH: ProstheticFoot(0.15, 0.28, -1.0, 0.0, 0.0, 0.01, springs_back=True),
    FootKind.SINGLE_AXIS: ProstheticFoot(0.08, 0.27, -1.0, 1.0, 0.0, 0.6),
    FootKind.MULTI_AXIAL: ProstheticFoot(0.09, 0.32, -1.0, 1.0, 0.0, 0.6, inverts=0.8),
    FootKind.ENERGY_STORING: ProstheticFoot(0.13, 0.40, -1.0, 0.0, 0.0, 0.01, springs_back=True),
    FootKind.HYDRAULIC_ANKLE: _HYDRAULIC,
    FootKind.MICROPROCESSOR_ANKLE: _HYDRAULIC,
}


def foot_of(fitted: Prosthesis) -> ProstheticFoot | None:
    """The foot of a prosthesis; None where the ankle is the patient's."""
    if not fitted.may_have_foot:
        return None
    return _FEET[fitted.foot] if fitted.foot is not None else STIFF_FOOT


ICR_RAD = np.deg2rad(np.arange(0.0, 121.0))
ICR_ABOVE_M, ICR_BEHIND_M, ICR_DOWN_RAD = 0.10, 0.02, np.deg2rad(40.0)


def _polycentric_path_m() -> FloatArray:
    """Where a polycentric knee brings the end of the shank, (n, 3), thigh axes, as it bends by ICR_RAD (n,)."""
    left = np.maximum(1.0 - ICR_RAD / ICR_DOWN_RAD, 0.0)  # of the way from where it turns about to the knee
    turns_about = np.stack([-ICR_BEHIND_M * left, 0.0 * left, ICR_ABOVE_M * left], axis=1)
    at = np.zeros_like(turns_about)
    for k, step_rad in enumerate(np.diff(ICR_RAD)):
        x, _, z = at[k] - turns_about[k]
        at[k + 1] = at[k] + step_rad * np.array([z, 0.0, -x])
    return at


_POLYCENTRIC_M = _polycentric_path_m()


def polycentric_shift_m(knee_rad: FloatArray) -> FloatArray:
    """How far (n, 3), in the thigh's axes, the shank's end is from where one axis would have it."""
    return np.stack([np.interp(knee_rad, ICR_RAD, along) for along in _POLYCENTRIC_M.T], axis=1)
