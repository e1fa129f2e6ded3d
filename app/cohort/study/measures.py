"""What the parameters of a table are called, their units and how many decimals they are told with."""

from dataclasses import dataclass

from app.wording.translation import later, tr

DEGREES, PERCENT, SECONDS, METRES, SPEED = "°", "%", "s", "m", "m/s"
NAMES = {
    "walk_speed_m_s": later("Walking speed"),
    "speed_m_s": later("Speed by leg"),
    "stride_length_m": later("Stride length"),
    "stride_time_s": later("Stride time"),
    "step_time_s": later("Step time"),
    "cadence_steps_min": later("Cadence"),
    "stance_percent": later("Stance"),
    "swing_percent": later("Swing"),
    "double_support_percent": later("Double support"),
    "clearance_m": later("Foot clearance"),
    "knee_range_deg": later("Knee range"),
    "knee_stance_to_swing_deg": later("Knee, stance to swing"),
    "knee_while_loading_deg": later("Knee while loading"),
    "knee_straightening_deg": later("Knee straightening in stance"),
    "knee_at_initial_contact_deg": later("Knee at initial contact"),
    "knee_loading_peak_deg": later("Knee loading peak"),
    "knee_stance_minimum_deg": later("Knee stance minimum"),
    "knee_swing_peak_deg": later("Knee swing peak"),
    "knee_swing_peak_percent": later("Knee swing peak, when"),
    "ankle_range_deg": later("Ankle range"),
    "ankle_push_off_deg": later("Ankle push-off"),
    "ankle_rocker_deg": later("Ankle rocker"),
    "ankle_heel_rocker_deg": later("Ankle heel rocker"),
    "ankle_toes_lifted_deg": later("Ankle, toes lifted in swing"),
    "ankle_at_initial_contact_deg": later("Ankle at initial contact"),
    "ankle_loading_plantarflexion_deg": later("Ankle loading plantarflexion"),
    "ankle_stance_dorsiflexion_deg": later("Ankle stance dorsiflexion"),
    "ankle_push_off_plantarflexion_deg": later("Ankle push-off plantarflexion"),
    "ankle_swing_dorsiflexion_deg": later("Ankle swing dorsiflexion"),
    "hip_range_deg": later("Hip range"),
    "hip_flexion_peak_deg": later("Hip, most flexed"),
    "hip_extension_peak_deg": later("Hip, most extended"),
    "hip_abduction_range_deg": later("Hip abduction range"),
    "hip_abduction_peak_deg": later("Hip, most abducted"),
    "hip_adduction_peak_deg": later("Hip, most adducted"),
    "pelvis_obliquity_range_deg": later("Pelvis, obliquity range"),
    "pelvis_drop_deg": later("Pelvis drop in swing"),
    "pelvis_rotation_range_deg": later("Pelvis, rotation range"),
    "pelvis_tilt_range_deg": later("Pelvis, tilt range"),
    "pelvis_lean_deg": later("Pelvis, lean"),
}
UNITS = {  # by the end of a name, longer ends first; and the decimals
    "_steps_min": (later("steps/min"), 0),
    "_m_s": (SPEED, 2),
    "_percent": (PERCENT, 1),
    "_deg": (DEGREES, 1),
    "_s": (SECONDS, 2),
    "_m": (METRES, 2),
}


@dataclass(frozen=True, slots=True)
class MeasureWords:
    """`name` in words, its unit (empty: none), and the decimals that it is told with."""

    name: str
    unit: str
    decimals: int

    @property
    def with_unit(self) -> str:
        return f"{self.name}, {self.unit}" if self.unit else self.name


def measure_words(column: str) -> MeasureWords:
    """Give the words of a parameter; one that nobody has named yet is called as its column."""
    end = next((end for end in UNITS if column.endswith(end)), "")
    unit, decimals = UNITS.get(end, ("", 2))
    name = tr(NAMES[column]) if column in NAMES else column.removesuffix(end).replace("_", " ").capitalize()
    return MeasureWords(name, tr(unit), decimals)


def in_order(columns: tuple[str, ...]) -> list[str]:
    """Parameters in the order of this list, those without a name last."""
    known = list(NAMES)
    return sorted(columns, key=lambda column: (known.index(column) if column in NAMES else len(known), column))
