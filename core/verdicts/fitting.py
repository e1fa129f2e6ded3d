"""The measures that a prosthetist reads: what each is, where it comes from, and what it cannot say.

Measures that the walk had before stand here beside those of fitting.csv. The verdict that gates each is that of its
class in `core.verdicts.quantities`, its error that of its kind in `core.verdicts.measurement_error`. The inclinations
are relative to standing, step length is none of them: how far the feet stand apart is unknown.
"""

from dataclasses import dataclass

_OWEN = "Owen 2010, Prosthet Orthot Int 34(3):254-269, doi:10.3109/03093646.2010.485597"
_PERRY = "Perry & Burnfield 2010, Gait Analysis"
_ROLL = "after Hansen & Childress 2010, Disabil Rehabil 32(26):2201-2209, who measure the centre of pressure"
_OURS = "this software"
_RELATIVE = "How the patient stands is its zero: it is no angle of the bone to the vertical"
_SOFT = "Soft tissue moves the sensor of the thigh by degrees"
_EVENTS = "On a prosthetic foot the heel rises late or never, so its end may lie anywhere in late stance"


@dataclass(frozen=True, slots=True)
class FittingMeasure:
    """One measure, by its column, whose unit ends its name.

    `is_source_read` is False where the source's text could not be read: what rests on it prints a dagger.
    """

    column: str
    definition: str
    cannot_say: str
    source: str = _OURS
    is_source_read: bool = True


def _cited(column: str, definition: str, cannot_say: str, source: str) -> FittingMeasure:
    return FittingMeasure(column, definition, cannot_say, source, is_source_read=False)


MEASURES = (
    _cited(
        "knee_while_loading_deg",
        "stance-knee flexion: largest knee angle from 5 to 30 % of the stride less that at initial contact",
        "Nothing of a knee that only passes through: without a peak there is no figure. No load is measured",
        _PERRY,
    ),
    _cited(
        "knee_loading_peak_deg",
        "stance-knee flexion from standing: largest knee angle from 5 to 30 % of the stride",
        _RELATIVE,
        _PERRY,
    ),
    FittingMeasure(
        "knee_swing_peak_percent",
        "when the largest knee angle from 55 to 90 % of the stride comes",
        "Contacts may be detected early or late alike in every stride, and with them this instant",
    ),
    FittingMeasure(
        "knee_terminal_extension_deg",
        "smallest knee angle from the peak in swing to the contact that ends the stride",
        "Whether a stop was hit, and how hard",
    ),
    FittingMeasure(
        "knee_extended_before_contact_percent",
        "how long before that contact the knee has come within 3 deg of its smallest angle, of the stride",
        "Contacts may be detected early or late alike in every stride, and with them this time",
    ),
    FittingMeasure(
        "foot_heel_rise_deg",
        "greatest pitch of the foot, toes down, from heel rise to the middle of swing; zero is the standing foot",
        "How high the heel is: the length of the foot and where its sensor sits are unknown",
    ),
    FittingMeasure(
        "foot_pitch_at_contact_deg",
        "pitch of the foot at initial contact, toes up positive; zero is the foot as it stands in the same stance",
        "A foot turns by up to 4 deg in 10 ms when it lands, and contacts may be detected 25 ms late",
    ),
    _cited(
        "foot_flat_percent",
        "from full contact to heel rise, share of the stride",
        f"Where the load is. {_EVENTS}",
        _PERRY,
    ),
    _cited("ankle_heel_rocker_deg", "ankle at initial contact less its smallest to 20 %", "No moment", _PERRY),
    _cited("ankle_rocker_deg", "largest ankle angle from 20 to 60 % less its smallest to 20 %", "No moment", _PERRY),
    _cited("ankle_push_off_deg", "largest ankle angle from 20 to 60 % less its smallest to 80 %", "No power", _PERRY),
    _cited(
        "shank_heel_rocker_deg",
        "by how much the shank turns forward from initial contact to full contact",
        "A foot that lands flat or toes first has none",
        _OWEN,
    ),
    _cited(
        "shank_over_flat_foot_deg",
        "by how much the shank turns forward from full contact to heel rise: the roll over a flat foot",
        f"No roll-over shape: the centre of pressure is not measured. {_EVENTS}",
        _ROLL,
    ),
    _cited(
        "shank_forefoot_rocker_deg",
        "by how much the shank turns forward from heel rise to toe-off",
        _EVENTS,
        _OWEN,
    ),
    *(
        _cited(
            f"{segment}_at_{instant}_deg",
            f"forward inclination of the {segment} at {words}, its upper end forward positive, relative to standing",
            _RELATIVE if segment == "shank" else f"{_RELATIVE}. {_SOFT}",
            _OWEN,
        )
        for segment in ("shank", "thigh")
        for instant, words in (
            ("initial_contact", "initial contact"),
            ("mid_stance", "the middle between initial contact and toe-off"),
            ("toe_off", "toe-off"),
        )
    ),
    FittingMeasure(
        "shank_to_foot_in_swing_deg",
        "mean angle of the foot against the shank, dorsiflexion positive, from a quarter of swing to 85 % of it",
        f"{_RELATIVE}. Between two walks with the sensors left on it is how the foot was set, if no joint moves there",
    ),
    FittingMeasure(
        "step_time_s",
        "from the other foot's initial contact to this foot's, which ends the stride; compared between the legs",
        "Nothing where the clocks of both legs are not tied",
    ),
    FittingMeasure(
        "stride_length_m",
        "how far the foot travels in the swing that ends the stride",
        "Step length: the feet's distance is unknown, and in walking straight on both feet travel equally far",
    ),
    FittingMeasure(
        "clearance_m",
        "how high the foot's sensor rises in swing over its places in the stances around",
        "How close the toes come to the floor: where they are is unknown, and they come much closer",
    ),
)
BY_COLUMN = {measure.column: measure for measure in MEASURES}
