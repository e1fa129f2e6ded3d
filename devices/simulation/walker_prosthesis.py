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

Not modelled: that people compensate. Where the knee of above-knee users was moved by 2 cm, the hip's moment, the length
of the step and the trunk answered (Koehler-McNicholas, Lipschutz & Gard 2016, J Rehabil Res Dev 53(6):1089, abstract
read); in ten with a prosthesis below the knee neither angles nor times changed (Jonkergouw 2019, Gait Posture 68:122,
abstract and highlights read). So a change here moves more than it will on people, and proves nothing about them.
"""

from dataclasses import dataclass

import numpy as np

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
