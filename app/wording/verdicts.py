"""Reasons why a figure is read with care or not reported, and what is to be done.

There is one for each gate of `core.verdicts.gates`.
"""

from typing import NamedTuple

from app.wording.body import name_of
from app.wording.translation import capitalised, figure_text, joined, later, tr
from core.verdicts.model import GateReason, Verdict

VERDICTS = {
    Verdict.READ: later("good"),
    Verdict.CARE: later("caution"),
    Verdict.NOT_REPORTED: later("not reported"),
    Verdict.NOT_MEASURED: later("not measured"),
}
SHARES = ("hip_disagreement",)  # gates whose figures are shares of one, written in percent
DECIMALS = {"deg": 1, "ms": 1, "m/s": 2, "%": 1, "s": 1, "m": 2}


class GateWords(NamedTuple):
    """What was found, and what to do about it; `to_do` is empty where nothing can be done."""

    why: str
    to_do: str = ""


_ONE_RECEIVER = later("Use one receiver for all sensors.")
_LOOK_AT_SIGN = later("Check the curve, then confirm or reverse the sign of the angle.")
_STRAP_PELVIS = later(
    "Strap the pelvis sensor to the sacrum, not to a waistband. Then let the patient walk 15 s "
    "with a turn, or do lunges."
)
_FREE_MOTION = later("Tighten the strap and record free motion again.")

# {value} and {limit} carry their units; where a gate has no figure the first sentence is without one
WORDS = {
    "pairing": GateWords(
        later("Sensor positions could not be confirmed (clarity {value}, required {limit})."),
        later("Check the sensor positions, or record free motion."),
    ),
    "disagreement": GateWords(
        later("The two sensors do not move like the two sides of one joint (disagreement {value}, limit {limit})."),
        later("Check the sensor positions, or record free motion."),
    ),
    "labels": GateWords(
        later("{sites} look swapped: another order fits the movement better."),
        later("Check the sensor positions."),
    ),
    "hip_disagreement": GateWords(
        later(
            "Pelvis and thigh sensors measure different accelerations at the hip (difference {value}, limit {limit})."
        ),
        _STRAP_PELVIS,
    ),
    "hip_centre": GateWords(later("The hip joint centre lies {value} from a sensor (limit {limit})."), _STRAP_PELVIS),
    "hips_apart": GateWords(
        later("The left hip joint centre lies {value} to the left of the right one (limit {limit})."),
        later("Check whether the thigh sensors are swapped."),
    ),
    "hip_found": GateWords(
        later(
            "The hip joint could not be located. Required are standing still, thigh and shank sensors, "
            "and enough hip movement."
        ),
        later("Let the patient stand still for three seconds, then walk 15 s with a turn, or do lunges."),
    ),
    "hip_heading": GateWords(
        later(
            "The direction of the thigh relative to the pelvis is too uncertain ({value}, limit {limit}). "
            "Abduction is not reported."
        ),
        later("Let the patient walk 15 s with a turn, or do lunges."),
    ),
    "hip_deep": GateWords(
        later(
            "Hip flexion reaches {value} (limit {limit}). In such deep flexion, the sensor shows only "
            "half of the pelvic tilt."
        )
    ),
    "pelvis_tilt": GateWords(
        later("Pelvic tilt range is {value}. A range up to {limit} cannot be distinguished from measurement error.")
    ),
    "sign": GateWords(
        later(
            "Flexion and extension could not be distinguished (clarity {value}, required {limit}). Only "
            "range of motion is reported."
        ),
        _LOOK_AT_SIGN,
    ),
    "axis": GateWords(
        later("The calibration has an uncertainty of ±{value} (limit ±{limit})."),
        later("Record free motion, or let the patient move longer and in more directions."),
    ),
    "axis_halves": GateWords(
        later("The {joint}'s axis came out {value} apart in the two halves of the walk (limit {limit})."),
        later("Record free motion."),
    ),
    "axis_motions": GateWords(
        later("The {joint}'s axis came out {value} apart in free motion and in the walk (limit {limit})."),
        _FREE_MOTION,
    ),
    "lag": GateWords(later("The two sensors are synchronised only to ±{value} (limit ±{limit})."), _ONE_RECEIVER),
    "plausible": GateWords(
        later("Range of motion is {value} (limit {limit})."), later("Check the curve and the sensors.")
    ),
    "plausible_height": GateWords(
        later("The absolute angle reaches {value} (limit {limit})."), later("Record the standing reference again.")
    ),
    "zero": GateWords(
        later("There is no standing reference, so absolute angles are not reported."),
        later("Let the patient stand still for three seconds."),
    ),
    "clock_drift": GateWords(
        later("One sensor's clock runs {value} faster or slower than the others."),
        later("Use one receiver for all sensors, then record again."),
    ),
    "strap": GateWords(later("Strap moved; strides from {value} on are excluded."), _FREE_MOTION),
    "strides": GateWords(later("Few strides ({value} used, {limit} required)."), later("Let the patient walk longer.")),
    "halves": GateWords(
        later("The values in the first and second half of the walk differ by {value} (limit {limit}).")
    ),
    "halves_time": GateWords(later("Stride time differs by {value} between the halves of the walk (limit {limit}).")),
    "drift": GateWords(later("The values in the first and last third of the walk differ by {value} (limit {limit}).")),
    "odd_even": GateWords(
        later("Every second stride differs from the others by {value} standard errors (limit {limit}).")
    ),
    "loss": GateWords(
        later("Signal gaps over 50 ms take up {value} of the strides used ({limit} at most)."),
        later("Move the receiver closer."),
    ),
    "clipping": GateWords(
        later("The motion exceeded a sensor's range in {value} of the strides used ({limit} at most)."),
        later("Choose a wider sensor range, then record again."),
    ),
    "rate": GateWords(
        later("A sensor sent samples at {value} of the set sample rate (limit {limit})."),
        later("Check the sensor's sample rate, then record again."),
    ),
    "every_second": GateWords(
        later("Every second sample of a sensor is missing: {value} of the samples arrived (limit {limit})."),
        later("Check the sensor's sample rate, move the receiver closer, then record again."),
    ),
    "events": GateWords(later("Stance is {value} of the gait cycle (limit {limit}). Gait events may be wrong.")),
    "distance": GateWords(later("Left and right stride length differ by {value} (limit {limit}).")),
    "speed": GateWords(later("Walking speed is {value} (limit {limit}). Distance may be wrong.")),
    "toe_off": GateWords(
        later("A prosthetic foot rolls on, so toe-off is detected late. Stance is not compared or judged.")
    ),
    "step_share": GateWords(
        later(
            "Left and right sensors are not synchronised. The left step takes {value} of the time of both "
            "steps (limit {limit}), with equal stance times."
        ),
        _ONE_RECEIVER,
    ),
    "leg_clock": GateWords(
        later("Left and right sensors are not synchronised. Synchronising them by hip movement takes 20 s of walking."),
        later("Let the patient walk for 20 s or longer, or use one receiver for all sensors."),
    ),
    "clocks": GateWords(later("Left and right sensors may be {value} out of sync (limit {limit})."), _ONE_RECEIVER),
}
NOT_REPORTED = {  # gates whose sentence is another where nothing is reported
    "axis_halves": GateWords(
        later(
            "The {joint}'s axis came out {value} apart in the two halves of the walk, so its angles are not compared."
        ),
        later("Record free motion."),
    ),
    "axis_motions": GateWords(
        later(
            "The {joint}'s axis came out {value} apart in free motion and in the walk, so its angles are not compared."
        ),
        _FREE_MOTION,
    ),
}
WITHOUT_FIGURES = {
    "axis_halves": GateWords(
        later("The joint's axis differs between the two halves of the walk."), later("Record free motion.")
    ),
    "axis_motions": GateWords(later("The joint's axis differs between free motion and the walk."), _FREE_MOTION),
    "pairing": GateWords(
        later("Sensor positions could not be confirmed."),
        later("Check the sensor positions, or record free motion."),
    ),
    "sign": GateWords(
        later("Flexion and extension could not be distinguished. Only range of motion is reported."), _LOOK_AT_SIGN
    ),
    "axis": GateWords(later("The uncertainty of the joint axis is not known."), later("Record free motion.")),
    "lag": GateWords(later("The two sensors could not be synchronised from the movement."), _ONE_RECEIVER),
    "strap": GateWords(later("Strap moved before this walk."), _FREE_MOTION),
    "labels": GateWords(
        later("Sensors look swapped: another order fits the movement better."),
        later("Check the sensor positions."),
    ),
    "step_share": GateWords(
        later("Left and right sensors are not synchronised: step times differ, although stance times are equal."),
        _ONE_RECEIVER,
    ),
    "clocks": GateWords(
        later("Left and right sensors are not synchronised. Times that involve both legs are not reported."),
        _ONE_RECEIVER,
    ),
}


def gate_words(reason: GateReason) -> GateWords:
    """Why this gate is not passed, and what to do, in the language of the application."""
    is_bare = reason.value is None and not reason.sites and reason.gate in WITHOUT_FIGURES
    is_grave = reason.verdict is Verdict.NOT_REPORTED and reason.gate in NOT_REPORTED
    words = (WITHOUT_FIGURES if is_bare else NOT_REPORTED if is_grave else WORDS)[reason.gate]
    is_share = reason.gate in SHARES
    value, limit = (_figure(figure, reason.unit, is_share=is_share) for figure in (reason.value, reason.limit))
    sites = capitalised(joined([name_of(site) for site in reason.sites]))
    joint = name_of(reason.joint) if reason.joint else ""
    why = tr(words.why).format(value=value, limit=limit, sites=sites, joint=joint)
    return GateWords(why, tr(words.to_do) if words.to_do else "")


def gate_figures(reason: GateReason) -> str:
    """What was found and the limit, where a sentence has no room: "±9.8°, limit ±9.0°"; empty without figures."""
    if reason.value is None or reason.limit is None:
        return ""
    words, is_share = WORDS[reason.gate].why, reason.gate in SHARES
    sign = "±" if "±{value}" in words else ""
    value, limit = (sign + _figure(figure, reason.unit, is_share=is_share) for figure in (reason.value, reason.limit))
    pattern = tr("{value}, required {limit}") if "required" in words else tr("{value}, limit {limit}")
    return pattern.format(value=value, limit=limit)


def gate_sentence(reason: GateReason) -> str:
    """The same in one piece."""
    return " ".join(filter(None, gate_words(reason)))


def verdict_word(verdict: Verdict) -> str:
    """A verdict as it is written beside a quantity's name."""
    return tr(VERDICTS[verdict])


def verdict_alone(verdict: Verdict) -> str:
    """The same where it is shown alone, as in a cell, a chip or a title."""
    return capitalised(verdict_word(verdict))


def _figure(value: float | None, unit: str, *, is_share: bool = False) -> str:
    if value is None:
        return tr("unknown")
    if is_share:
        return f"{figure_text(100.0 * value, '.0f')}\N{NO-BREAK SPACE}%"
    if not unit:
        return f"{value:.0f}" if value == round(value) else figure_text(value, ".2f")
    number = figure_text(value, f".{DECIMALS[unit]}f")
    return f"{number}°" if unit == "deg" else f"{number}\N{NO-BREAK SPACE}{unit}"
