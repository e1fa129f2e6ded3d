"""What does who reads page one only have to know? At most four sentences, all of them numbers."""

import math
from collections.abc import Sequence

from app.reports.comparison import MEASURES, Compared, Comparison, Kind
from app.reports.patient_report import quality
from app.reports.patient_report.blocks import Block, bullets, heading
from app.reports.patient_report.facts import Facts, joint_of, role
from app.reports.patient_report.first_page import symmetry_in_words
from app.reports.patient_report.numbers_in_words import (
    Band,
    against_band,
    band_in_figures,
    fixed,
    in_a_sentence,
    signed,
)
from app.reports.patient_report.panels import peak_name
from app.reports.patient_report.peaks_page import COLUMNS
from app.reports.patient_report.plain_text import CONDITION_LENGTH, plain, typed
from app.reports.walk_figures import is_mean_enough
from app.wording import capitalised, name_of, sentence, tr, tr_n
from core.body import Side
from core.verdicts.measurement_error import Judgement

MAX_SENTENCES = 4
MAX_BEYOND = 2  # peaks told with their numbers; the table has all


def what_stands_out(facts: Facts, comparison: Comparison | None) -> list[Block]:
    """At most four sentences, all of them numbers; the last is the caveat that weighs most."""
    said: list[str] = []
    sides = [side for side in facts.first_and_second if side in facts.gait]
    if comparison is not None:
        said += _comparison_sentences(facts, comparison)
    if len(said) < 2:
        said += _knee_sentence(facts, sides)
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
    said += _beyond_band_sentence(facts)
    stance = _stance_sentence(facts)
    caveat = _caveat(facts)
    kept = said[: MAX_SENTENCES - len(stance) - len(caveat)]
    # what weighs on every number is said last
    return [heading(tr("What stands out")), bullets([*kept, *stance, *caveat] or [tr("Nothing can be told.")])]


def _comparison_sentences(facts: Facts, comparison: Comparison) -> list[str]:
    """The knee's swing peak of the first side that both have, the last part against the first; then what differs most.

    Without a difference beyond the measurement error, the knee's range is told as second.
    """
    shown = comparison.parts[-1]
    measures = {measure.column: measure for measure in MEASURES}
    pairs = [
        [comparison.compare(measures[column], side, shown) for column in ("knee_swing_peak_deg", "knee_range_deg")]
        for side in facts.first_and_second
    ]
    swing, span = next((pair for pair in pairs if any(row.is_told for row in pair)), pairs[0])
    beyond = [row for row in comparison.rows if row.exceeds and not _is_of(row, swing)]
    most = max(beyond, key=lambda row: abs(row.difference.difference) / row.difference.error, default=span)
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
    pattern = (
        tr("{measure}: {value}; since the earlier visit {change}: {verdict}{error}.")
        if is_visits
        else tr("{measure} at {this} {value}; against {first} {change}: {verdict}{error}.")
    )
    named = {key: typed(part.name, CONDITION_LENGTH) for key, part in (("this", row.part), ("first", row.against))}
    error = f" ({fixed(row.difference.error, 1)}{unit})" if math.isfinite(row.difference.error) else ""
    return pattern.format(
        measure=names[row.measure.column].format(side=capitalised(role(facts, row.side))),
        value=fixed(row.value.mean, 0 if is_angle else 1) + unit,
        change=signed(row.difference.difference, 1) + unit,
        verdict=in_a_sentence(row.difference.judgement),
        error=error,
        **named,
    )


def _knee_sentence(facts: Facts, sides: Sequence[Side]) -> list[str]:
    """Where the knees of these legs lie against the band, swing before range."""
    for column, pattern in (
        ("knee_swing_peak_deg", tr("Knee in swing: {values}.")),
        ("knee_range_deg", tr("Knee range over the stride: {values}.")),
    ):
        band, told = facts.band(column), []
        for side in sides:
            value = facts.value(side, column)
            if is_mean_enough(value.n):
                words = [f"{role(facts, side)} {fixed(value.mean, 0)}°"]
                told.append(", ".join([*words, against_band(value.mean, band)] if band is not None else words))
        if told:
            number = "[2]" if facts.is_band_two(column) else "[1]"
            source = f" ({tr('band')} {number})" if band is not None else ""
            return [pattern.format(values="; ".join(told) + source)]
    return []


def _beyond_band_sentence(facts: Facts) -> list[str]:
    """The peaks that lie farthest from band [1], of those more than 2 SD away; not where the height is uncertain."""
    found: dict[str, float] = {}
    for column in (*COLUMNS["knee"], *COLUMNS["ankle"]):
        band = facts.band(column)
        if band is None or facts.is_band_two(column) or facts.has_no_zero(column.split("_")[0]):
            continue
        beyond = [away for side in facts.gait if (away := _away_sd(facts, side, column, band)) > 2]
        if beyond:
            found[column] = max(beyond)
    if not found:
        return []
    farthest = sorted(found, key=lambda column: -found[column])
    told = "; ".join(_beside_band(facts, column) for column in farthest[:MAX_BEYOND])
    more = len(farthest) - MAX_BEYOND
    if more > 0:
        told += "; " + tr_n("{count} more on page 3", "{count} more on page 3", more).format(count=more)
    return [tr("More than 2\u00a0SD from band [1]: {peaks}.").format(peaks=told)]


def _away_sd(facts: Facts, side: Side, column: str, band: Band) -> float:
    value, joint = facts.value(side, column), joint_of(column.split("_")[0], side)
    is_told = is_mean_enough(value.n) and math.isfinite(value.mean) and not quality.is_weak_axis(facts, joint)
    return abs(value.mean - (band[0] + band[1]) / 2) / ((band[1] - band[0]) / 2) if is_told else 0.0


def _beside_band(facts: Facts, column: str) -> str:
    """One peak of the legs that lie more than 2 SD away, and the band."""
    band = facts.band(column)
    if band is None:
        return ""
    values = [
        f"{side[0].upper()}\u00a0{fixed(facts.value(side, column).mean, 0)}°"
        for side in facts.gait
        if _away_sd(facts, side, column, band) > 2
    ]
    peak = tr("at initial contact") if "initial_contact" in column else peak_name(column)
    said = tr("{joint} {peak}, {values} ({band})")
    joint = tr("knee") if column.startswith("knee") else tr("ankle")
    in_band = tr("band {band}°").format(band=band_in_figures(band, 0))
    return said.format(joint=joint, peak=peak, values=", ".join(values), band=in_band)


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
        if (found := differences.get(column)) is not None and found["verdict"] == Judgement.EXCEEDS_ERROR
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
            verdict=in_a_sentence(Judgement.EXCEEDS_ERROR),
        )
    ]


def _stance_sentence(facts: Facts) -> list[str]:
    left, right = (facts.value(side, "stance_percent") for side in Side)
    if not (is_mean_enough(left.n) and is_mean_enough(right.n)):
        return []
    symmetry = symmetry_in_words(facts, "stance_percent")
    band = facts.time_distance[tr("Stance")].band if facts.values_group is not None else None
    against = [f", {against_band(value.mean, band)}" if band is not None else "" for value in (left, right)]
    each = [f"{fixed(value.mean, 1)}{words}" for value, words in zip((left, right), against, strict=True)]
    said = tr("Stance, % of the stride: left {left}; right {right} (symmetry {symmetry}).")
    sentence = said.format(left=each[0], right=each[1], symmetry=symmetry)
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
