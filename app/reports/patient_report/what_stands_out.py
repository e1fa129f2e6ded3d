"""What does who reads page one only have to know? At most four sentences, all of them numbers."""

import math

from app.reports.comparison import MEASURES, Compared, Comparison, Kind
from app.reports.patient_report import quality
from app.reports.patient_report.blocks import Block, bullets, heading
from app.reports.patient_report.facts import Facts, joint_of, role
from app.reports.patient_report.first_page import symmetry_in_words
from app.reports.patient_report.numbers_in_words import against_band, fixed, in_a_sentence, signed
from app.reports.patient_report.plain_text import CONDITION_LENGTH, plain, typed
from app.reports.walk_figures import is_mean_enough
from app.wording import capitalised, name_of, sentence, tr
from core.body import Side
from core.norms import Verdict

MAX_SENTENCES = 4


def what_stands_out(facts: Facts, comparison: Comparison | None) -> list[Block]:
    """At most four sentences, all of them numbers; the last is the caveat that weighs most."""
    said: list[str] = []
    sides = [side for side in facts.first_and_second if side in facts.gait]
    if comparison is not None:
        said += _comparison_sentences(facts, comparison)
    shown = sides[:1] if facts.affected is not None else sides
    for side in shown:
        if len(said) < 2:
            said += _knee_sentence(facts, side)
    said += _difference_sentence(facts)
    for side in sides:
        for column, name in (
            ("ankle_push_off_plantarflexion_deg", tr("plantarflexion peak at push\u2011off")),
            ("knee_loading_peak_deg", tr("flexion peak while loading")),
        ):
            if facts.is_no_peak(side, column):
                sentence = tr("{joint}: no {peak} was found. This is printed as “no peak”, not as a number.")
                joint = capitalised(name_of(joint_of(column.split("_")[0], side)))
                said.append(sentence.format(joint=joint, peak=name))
    stance = _stance_sentence(facts)
    caveat = _caveat(facts)
    kept = said[: MAX_SENTENCES - len(stance) - len(caveat)]
    # what weighs on every number is said last
    return [heading(tr("What stands out")), bullets([*kept, *stance, *caveat] or [tr("Nothing can be told.")])]


def _comparison_sentences(facts: Facts, comparison: Comparison) -> list[str]:
    """The knee's swing peak of the first side, the last part against the first; then what differs most of all else.

    Without a difference beyond the measurement error, the knee's range is told as second.
    """
    side, shown = facts.first_and_second[0], comparison.parts[-1]
    measures = {measure.column: measure for measure in MEASURES}
    swing, span = (
        comparison.compare(measures[column], side, shown) for column in ("knee_swing_peak_deg", "knee_range_deg")
    )
    beyond = [row for row in comparison.rows if row.exceeds and not _is_of(row, swing)]
    most = max(beyond, key=lambda row: abs(row.difference.difference_deg) / row.difference.error_deg, default=span)
    return [_compared(facts, comparison, row) for row in (swing, most) if row.is_told]


def _is_of(row: Compared, other: Compared) -> bool:
    return (row.measure.column, row.side, row.part.letter) == (other.measure.column, other.side, other.part.letter)


def _compared(facts: Facts, comparison: Comparison, row: Compared) -> str:
    """One figure of one part, and how far it is from the first."""
    names = {
        "knee_loading_peak_deg": tr("{side}, knee while loading"),
        "knee_swing_peak_deg": tr("{side}, knee in swing"),
        "knee_range_deg": tr("{side}, knee range over the stride"),
        "ankle_stance_dorsiflexion_deg": tr("{side}, ankle dorsiflexion in stance"),
        "ankle_push_off_plantarflexion_deg": tr("{side}, ankle at push\u2011off"),
        "ankle_range_deg": tr("{side}, ankle range over the stride"),
        "stance_percent": tr("{side}, stance, share of the stride"),
    }
    is_angle = row.measure.unit == "°"
    unit = "°" if is_angle else "\u00a0%"
    is_visits = comparison.kind is Kind.VISITS
    since = tr("since the earlier visit {change}") if is_visits else tr("{this} against {first} {change}")
    named = {key: typed(part.name, CONDITION_LENGTH) for key, part in (("this", row.part), ("first", row.against))}
    error = f" ({fixed(row.difference.error_deg, 1)}{unit})" if math.isfinite(row.difference.error_deg) else ""
    return tr("{measure}: {value}; {change}: {verdict}{error}.").format(
        measure=names[row.measure.column].format(side=role(facts, row.side)),
        value=fixed(row.value.mean, 0 if is_angle else 1) + unit,
        change=since.format(change=signed(row.difference.difference_deg, 1) + unit, **named),
        verdict=in_a_sentence(row.difference.verdict),
        error=error,
    )


def _knee_sentence(facts: Facts, side: Side) -> list[str]:
    for column, name in (
        ("knee_swing_peak_deg", tr("{side} knee in swing: {value}°")),
        ("knee_range_deg", tr("{side} knee range over the stride: {value}°")),
    ):
        value = facts.value(side, column)
        if not is_mean_enough(value.n):
            continue
        said = name.format(side=role(facts, side), value=fixed(value.mean, 0))
        band = facts.band(column)
        if band is None:
            return [said + "."]
        number = "[2]" if facts.is_band_two(column) else "[1]"
        return [f"{said}, {against_band(value.mean, band)} ({tr('band')} {number})."]
    return []


def _difference_sentence(facts: Facts) -> list[str]:
    """The largest difference between the knees that exceeds the measurement error."""
    differences = facts.summary["both"].get("side_difference") or {}
    names = {
        "knee_loading_peak_deg": tr("Knee flexion while loading"),
        "knee_stance_minimum_deg": tr("Least knee flexion in stance"),
        "knee_swing_peak_deg": tr("Knee flexion in swing"),
        "knee_range_deg": tr("Knee range"),
    }
    real = {
        column: found
        for column in names
        if (found := differences.get(column)) is not None and found["verdict"] == Verdict.EXCEEDS_ERROR
    }
    if not real:
        return []
    column = max(real, key=lambda name: abs(real[name]["difference_deg"]))
    values = {side: facts.value(side, column).mean for side in Side}
    said = tr("{measure}: left {left}°, right {right}°; the difference of {difference}° is {verdict}.")
    return [
        said.format(
            measure=names[column],
            left=fixed(values[Side.LEFT], 0),
            right=fixed(values[Side.RIGHT], 0),
            difference=fixed(abs(real[column]["difference_deg"]), 1),
            verdict=in_a_sentence(Verdict.EXCEEDS_ERROR),
        )
    ]


def _stance_sentence(facts: Facts) -> list[str]:
    left, right = (facts.value(side, "stance_percent") for side in Side)
    if not (is_mean_enough(left.n) and is_mean_enough(right.n)):
        return []
    symmetry = symmetry_in_words(facts, "stance_percent")
    said = tr("Stance: left {left} %, right {right} % of the stride (symmetry {symmetry}).")
    sentence = said.format(left=fixed(left.mean, 1), right=fixed(right.mean, 1), symmetry=symmetry)
    double = facts.time_distance[tr("Double support")]
    if double.both is not None and math.isfinite(double.both) and double.band and facts.values_group is not None:
        more = tr("Double support: {value} %, {against}.")
        sentence += " " + more.format(value=fixed(double.both, 1), against=against_band(double.both, double.band))
    return [sentence]


def _caveat(facts: Facts) -> list[str]:
    _, reasons = quality.verdict_of(facts)
    if reasons:
        return reasons[:1]
    late = [finding for finding in facts.visit.analysis.findings if finding.key == "prosthetic_toe_off"]
    if late:
        return [plain(sentence(late[0]))]
    group = facts.curves_group
    if group is not None and math.isfinite(facts.feet.speed_m_s) and not group.fits(facts.feet.speed_m_s):
        said = tr("This walk: {speed} m/s, band [1]: {group} m/s. Part of a distance from the band comes from speed.")
        return [said.format(speed=fixed(facts.feet.speed_m_s, 2), group=fixed(group.speed_m_s, 2))]
    return []
