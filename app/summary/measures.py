"""Which measures of strides are compared between walks, visits and legs: their names, units and whose they are."""

from dataclasses import dataclass

from app.wording.translation import later
from core.body import Joint, Side
from core.verdicts.quantities import CLASSES, QuantityClass, joint_of

CADENCE = "cadence_steps_min"  # of both legs; of one, two steps in each of its strides


@dataclass(frozen=True, slots=True)
class Measure:
    """One figure that is compared; `column` is a quantity of strides, `kind` knee, ankle, hip, pelvis or empty.

    `is_of_walk`: both legs have the same, so it is told once, of both.
    """

    column: str
    name: str
    kind: str
    unit: str = "°"
    decimals: int = 1
    is_of_walk: bool = False

    @classmethod
    def of(cls, column: str) -> "Measure":
        """Any column of strides.csv, for tables that write the column itself: without a name or a unit."""
        return cls(column, "", "", unit="")

    def joint(self, side: Side) -> Joint | None:
        """Whose figure it is; None where it is no joint's."""
        return joint_of(self.column, side)

    @property
    def needs_height(self) -> bool:
        """Whether it says something only with a zero of the same kind."""
        return CLASSES.get(self.column) is QuantityClass.HEIGHT


MEASURES = (
    Measure("knee_stance_to_swing_deg", later("Knee, stance to swing"), "knee"),
    Measure("knee_while_loading_deg", later("Knee while loading"), "knee"),
    Measure("knee_swing_peak_deg", later("Knee swing peak"), "knee"),
    Measure("knee_range_deg", later("Knee range"), "knee"),
    Measure("ankle_push_off_deg", later("Ankle push-off"), "ankle"),
    Measure("ankle_rocker_deg", later("Ankle rocker"), "ankle"),
    Measure("ankle_range_deg", later("Ankle range"), "ankle"),
    Measure("hip_range_deg", later("Hip range"), "hip"),
    Measure("hip_extension_peak_deg", later("Hip, most extended"), "hip"),
    Measure("pelvis_obliquity_range_deg", later("Pelvis, obliquity range"), "pelvis"),
    Measure("pelvis_drop_deg", later("Pelvis drop in swing"), "pelvis"),
    Measure("stance_percent", later("Stance time, % of stride"), "", "%"),
    Measure("stride_length_m", later("Stride length, m"), "", "m", 2),
    Measure("speed_m_s", later("Walking speed, m/s"), "", "m/s", 2, is_of_walk=True),
    Measure(CADENCE, later("Cadence, steps/min"), "", "steps/min", 0, is_of_walk=True),
)

FITTED = (  # those of `core.verdicts.fitting` that the bench names where they are larger than their error
    Measure("knee_terminal_extension_deg", later("Knee, straightest in swing"), "knee"),
    Measure("knee_extended_before_contact_percent", later("Knee straight before contact"), "", "%"),
    Measure("foot_heel_rise_deg", later("Heel rise"), ""),
    Measure("foot_pitch_at_contact_deg", later("Foot pitch at contact"), ""),
    Measure("foot_flat_percent", later("Foot flat, % of stride"), "", "%"),
    Measure("shank_over_flat_foot_deg", later("Shank over the flat foot"), ""),
)
