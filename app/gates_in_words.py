"""Why is a figure read with care, or withheld? A sentence for each gate of `core.verdicts.gates`, with what to do."""

from app.wording import later, tr
from core.verdicts.model import GateReason, Verdict

VERDICTS = {
    Verdict.READ: later("can be read"),
    Verdict.CARE: later("read with care"),
    Verdict.WITHHELD: later("withheld"),
    Verdict.NOT_MEASURED: later("not measured"),
}
DECIMALS = {"deg": 1, "ms": 1, "m/s": 2, "%": 1, "s": 1}

# {value} and {limit} carry their units; where a gate has no figure the first sentence is without one
SENTENCES = {
    "pairing": later(
        "The two sensors do not move as neighbours (margin {value}, {limit} wanted). Check which sensor is where, or "
        "record free motion."
    ),
    "sign": later(
        "The motion does not tell flexion from extension (margin {value}, {limit} wanted), so only the range holds. "
        "Look at the curve, then confirm or turn the sign."
    ),
    "axis": later(
        "The joint's axis is known to {value} only ({limit} wanted). Record free motion, or move longer and in more "
        "directions."
    ),
    "lag": later(
        "How far the two sensors' clocks are apart is known to {value} only ({limit} wanted). Use one receiver for all "
        "sensors."
    ),
    "plausible": later("The range over the stride is {value} (limit {limit}). Look at the curve and at the sensors."),
    "plausible_height": later("The curve reaches {value} (limit {limit}). Set the zero again."),
    "zero": later("No zero was set, so heights say nothing. Let the patient stand still for three seconds."),
    "clock_drift": later(
        "One sensor's clock runs {value} faster or slower than the others'. Use one receiver for all sensors, then "
        "record again."
    ),
    "strap": later(
        "A strap slipped from {value} on; later strides are left out. Tighten it and record free motion again."
    ),
    "strides": later("{value} strides were used ({limit} wanted). Let the patient walk longer."),
    "halves": later("The second half of the walk differs from the first by {value} ({limit} at most)."),
    "halves_time": later("The stride time of the second half differs from the first by {value} ({limit} at most)."),
    "drift": later("The last third of the walk differs from the first by {value} ({limit} at most)."),
    "odd_even": later("Every second stride differs from the others by {value} standard errors ({limit} at most)."),
    "loss": later("{value} of a sensor's samples are missing ({limit} at most). Move the receiver nearer."),
    "events": later("Stance takes {value} of the stride (limit {limit}): the events may be wrong."),
    "distance": later("The stride lengths of both feet differ by {value} ({limit} at most)."),
    "speed": later("The walking speed found is {value} (limit {limit}): the distance may be wrong."),
    "toe_off": later("A prosthetic foot rolls on, so toe-off is found late: stance is not compared or judged."),
    "step_share": later(
        "The left step takes {value} of both (limit {limit}), though both feet stand equally long: the legs' clocks "
        "differ. Use one receiver for all sensors."
    ),
    "clocks": later(
        "The clocks of both legs may be {value} apart ({limit} at most). Use one receiver for all sensors."
    ),
}
WITHOUT_FIGURES = {
    "pairing": later("The two sensors do not move as neighbours. Check which sensor is where, or record free motion."),
    "sign": later(
        "The motion does not tell flexion from extension, so only the range holds. Look at the curve, then confirm or "
        "turn the sign."
    ),
    "axis": later("How sure the joint's axis is, is not known. Record free motion."),
    "lag": later(
        "The motion does not show how far the two sensors' clocks are apart. Use one receiver for all sensors."
    ),
    "strap": later("A strap slipped before this walk. Tighten it and record free motion again."),
    "step_share": later(
        "The left step takes {value} of both (limit {limit}), though both feet stand equally long: the legs' clocks "
        "differ. Use one receiver for all sensors."
    ),
    "clocks": later(
        "Nothing ties the clocks of both legs together, so nothing that compares instants of both is given. Use one "
        "receiver for all sensors."
    ),
}


def gate_sentence(reason: GateReason) -> str:
    """Why this gate is not passed, and what to do."""
    if reason.value is None and reason.gate in WITHOUT_FIGURES:
        return tr(WITHOUT_FIGURES[reason.gate])
    value, limit = (_figure(figure, reason.unit) for figure in (reason.value, reason.limit))
    return tr(SENTENCES[reason.gate]).format(value=value, limit=limit)


def verdict_word(verdict: Verdict) -> str:
    """A verdict as it stands beside a quantity's name."""
    return tr(VERDICTS[verdict])


def _figure(value: float | None, unit: str) -> str:
    if value is None:
        return tr("unknown")
    if not unit:
        return f"{value:.0f}" if value == round(value) else f"{value:.2f}"
    number = f"{value:.{DECIMALS[unit]}f}"
    return f"{number}°" if unit == "deg" else f"{number}\N{NO-BREAK SPACE}{unit}"
