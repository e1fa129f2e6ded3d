"""Why is a figure read with care, or withheld, and what is to be done? For each gate of `core.verdicts.gates`."""

from typing import NamedTuple

from app.wording.translation import figure_text, later, tr
from core.verdicts.model import GateReason, Verdict

VERDICTS = {
    Verdict.READ: later("can be read"),
    Verdict.CARE: later("read with care"),
    Verdict.WITHHELD: later("withheld"),
    Verdict.NOT_MEASURED: later("not measured"),
}
DECIMALS = {"deg": 1, "ms": 1, "m/s": 2, "%": 1, "s": 1, "m": 2}


class GateWords(NamedTuple):
    """What was found, and what to do about it; `to_do` is empty where nothing can be done."""

    why: str
    to_do: str = ""


_ONE_RECEIVER = later("Use one receiver for all sensors.")
_LOOK_AT_SIGN = later("Look at the curve, then confirm or turn the sign.")
_STRAP_PELVIS = later(
    "Strap the pelvis sensor to the sacrum, not to a waistband, and walk 15 s with a turn or make lunges."
)
_FREE_MOTION = later("Tighten it and record free motion again.")

# {value} and {limit} carry their units; where a gate has no figure the first sentence is without one
WORDS = {
    "pairing": GateWords(
        later("The two sensors do not move as neighbours (margin {value}, {limit} wanted)."),
        later("Check which sensor is where, or record free motion."),
    ),
    "disagreement": GateWords(
        later("The two sensors disagree about their joint (disagreement {value}, limit {limit})."),
        later("Check which sensor is where, or record free motion."),
    ),
    "labels": GateWords(
        later("The motion fits better if the sensors were worn in another order."),
        later("Check which sensor is where."),
    ),
    "hip_disagreement": GateWords(
        later("Pelvis and thigh disagree about what the hip feels ({value} of it, under {limit} wanted)."),
        _STRAP_PELVIS,
    ),
    "hip_centre": GateWords(later("The hip's centre lies {value} from a sensor (limit {limit})."), _STRAP_PELVIS),
    "hips_apart": GateWords(
        later("The left hip lies {value} to the left of the right one (limit {limit})."),
        later("Check whether the thighs' sensors are swapped."),
    ),
    "hip_found": GateWords(
        later("The hip was not found: that takes standing, the knee's sensors and motion that shows the hip."),
        later("Let the patient stand still for three seconds, then walk 15 s with a turn, or make lunges."),
    ),
    "hip_heading": GateWords(
        later("The heading of the thigh in the pelvis is known to {value} only ({limit} wanted): no abduction."),
        later("Let the patient walk 15 s with a turn, or make lunges."),
    ),
    "hip_deep": GateWords(
        later("A hip bends to {value} (limit {limit}): so deep, the sensor shows half of the pelvis's tilt.")
    ),
    "pelvis_tilt": GateWords(
        later("The pelvis tilts by {value} over the stride: up to {limit} that is not told from measurement error.")
    ),
    "sign": GateWords(
        later(
            "The motion does not tell flexion from extension (margin {value}, {limit} wanted), so only the range holds."
        ),
        _LOOK_AT_SIGN,
    ),
    "axis": GateWords(
        later("The joint's axis is known to {value} only ({limit} wanted)."),
        later("Record free motion, or move longer and in more directions."),
    ),
    "lag": GateWords(
        later("How far the two sensors' clocks are apart is known to {value} only ({limit} wanted)."), _ONE_RECEIVER
    ),
    "plausible": GateWords(
        later("The range over the stride is {value} (limit {limit})."), later("Look at the curve and at the sensors.")
    ),
    "plausible_height": GateWords(later("The curve reaches {value} (limit {limit})."), later("Set the zero again.")),
    "zero": GateWords(
        later("No zero was set, so heights say nothing."), later("Let the patient stand still for three seconds.")
    ),
    "clock_drift": GateWords(
        later("One sensor's clock runs {value} faster or slower than the others'."),
        later("Use one receiver for all sensors, then record again."),
    ),
    "strap": GateWords(later("A strap slipped from {value} on; later strides are left out."), _FREE_MOTION),
    "strides": GateWords(later("Few strides ({value} used, {limit} wanted)."), later("Let the patient walk longer.")),
    "halves": GateWords(later("The second half of the walk differs from the first by {value} ({limit} at most).")),
    "halves_time": GateWords(
        later("The stride time of the second half differs from the first by {value} ({limit} at most).")
    ),
    "drift": GateWords(later("The last third of the walk differs from the first by {value} ({limit} at most).")),
    "odd_even": GateWords(
        later("Every second stride differs from the others by {value} standard errors ({limit} at most).")
    ),
    "loss": GateWords(
        later("Gaps over 50 ms take {value} of the strides used ({limit} at most)."),
        later("Move the receiver nearer."),
    ),
    "clipping": GateWords(
        later("The motion exceeded a sensor's range in {value} of the strides used ({limit} at most)."),
        later("Choose a wider range, then record again."),
    ),
    "rate": GateWords(
        later("A sensor's samples came at {value} of the rate set (limit {limit})."),
        later("Check its sample rate, then record again."),
    ),
    "every_second": GateWords(
        later("Every second sample of a sensor is missing: {value} came (limit {limit})."),
        later("Check its sample rate, move the receiver nearer, then record again."),
    ),
    "events": GateWords(later("Stance takes {value} of the stride (limit {limit}): the events may be wrong.")),
    "distance": GateWords(later("The stride lengths of both feet differ by {value} ({limit} at most).")),
    "speed": GateWords(later("The walking speed found is {value} (limit {limit}): the distance may be wrong.")),
    "toe_off": GateWords(
        later("A prosthetic foot rolls on, so toe-off is found late: stance is not compared or judged.")
    ),
    "step_share": GateWords(
        later(
            "The left step takes {value} of both (limit {limit}), though both feet stand equally long: the legs' "
            "clocks differ."
        ),
        _ONE_RECEIVER,
    ),
    "leg_clock": GateWords(
        later(
            "Nothing ties the clocks of both legs together, and the hips do not tell how far they are apart: that "
            "takes 20 s of walking."
        ),
        later("Let the patient walk for 20 s or longer, or use one receiver for all sensors."),
    ),
    "clocks": GateWords(later("The clocks of both legs may be {value} apart ({limit} at most)."), _ONE_RECEIVER),
}
WITHOUT_FIGURES = {
    "pairing": GateWords(
        later("The two sensors do not move as neighbours."),
        later("Check which sensor is where, or record free motion."),
    ),
    "sign": GateWords(
        later("The motion does not tell flexion from extension, so only the range holds."), _LOOK_AT_SIGN
    ),
    "axis": GateWords(later("How sure the joint's axis is, is not known."), later("Record free motion.")),
    "lag": GateWords(later("The motion does not show how far the two sensors' clocks are apart."), _ONE_RECEIVER),
    "strap": GateWords(later("A strap slipped before this walk."), _FREE_MOTION),
    "step_share": WORDS["step_share"],
    "clocks": GateWords(
        later("Nothing ties the clocks of both legs together, so nothing that compares instants of both is given."),
        _ONE_RECEIVER,
    ),
}


def gate_words(reason: GateReason) -> GateWords:
    """Why this gate is not passed, and what to do, in the language of the application."""
    words = WITHOUT_FIGURES[reason.gate] if reason.value is None and reason.gate in WITHOUT_FIGURES else None
    words = words or WORDS[reason.gate]
    value, limit = (_figure(figure, reason.unit) for figure in (reason.value, reason.limit))
    return GateWords(tr(words.why).format(value=value, limit=limit), tr(words.to_do) if words.to_do else "")


def gate_sentence(reason: GateReason) -> str:
    """The same in one piece."""
    return " ".join(filter(None, gate_words(reason)))


def verdict_word(verdict: Verdict) -> str:
    """A verdict as it stands beside a quantity's name."""
    return tr(VERDICTS[verdict])


def _figure(value: float | None, unit: str) -> str:
    if value is None:
        return tr("unknown")
    if not unit:
        return f"{value:.0f}" if value == round(value) else figure_text(value, ".2f")
    number = figure_text(value, f".{DECIMALS[unit]}f")
    return f"{number}°" if unit == "deg" else f"{number}\N{NO-BREAK SPACE}{unit}"
