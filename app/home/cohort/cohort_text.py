"""What the page of questions shows: its groups, what is shown, what was left out, and what the intervals do not
hold."""

from app.cohort.study.groups import (
    AGE_EDGES,
    CHILDREN_UNDER,
    LEAST_SESSIONS,
    SPEED_EDGES,
    GroupAnswer,
    Grouping,
    GroupRow,
)
from app.cohort.study.measures import measure_words
from app.wording.numbers import MINUS
from app.wording.recordings import name_in_words
from app.wording.translation import figure_text, joined, tr, tr_n, within_sentence


def grouping_word(grouping: Grouping) -> str:
    """The choice in words."""
    return {
        Grouping.CONDITION: tr("Condition"),
        Grouping.DEVICE: tr("Device"),
        Grouping.AGE: tr("Age"),
        Grouping.SPEED: tr("Walking speed"),
        Grouping.SIDE: tr("Side"),
        Grouping.LEG: tr("Prosthetic or affected leg"),
        Grouping.ALL: tr("No grouping"),
    }[grouping]


def group_name(grouping: Grouping, group: str) -> str:
    """One group in words; what somebody typed stays as it is."""
    match grouping:
        case Grouping.ALL:
            return tr("All sessions")
        case Grouping.SPEED if not group:
            return tr("speed not reported")
    if not group:
        return tr("not recorded")
    match grouping:
        case Grouping.CONDITION:
            return name_in_words(group)
        case Grouping.AGE:
            return _age_band(int(group))
        case Grouping.SPEED:
            return _speed_band(float(group))
        case Grouping.SIDE:
            return {"left": tr("left leg"), "right": tr("right leg"), "both": tr("both legs")}.get(group, group)
        case Grouping.LEG:
            return {
                "prosthetic": tr("prosthetic leg"),
                "affected": tr("affected leg"),
                "other": tr("sound leg"),
                "neither": tr("no leg affected"),
            }.get(group, group)
    return group


def sentence(found: GroupAnswer) -> str:
    """What is shown, in one sentence; nothing of what it means."""
    measure = measure_words(found.question.measure).name
    if not found.reported:
        return tr("No session has an included value of this measure.")
    if found.question.grouping is Grouping.ALL:
        stated = tr_n("{measure}: {count} session.", "{measure}: mean of {count} sessions.", found.sessions)
        return stated.format(measure=measure, count=found.sessions)
    stated = tr_n(
        "{measure}: {count} session, by {grouping}.",
        "{measure}: means of {count} sessions, by {grouping}.",
        found.sessions,
    )
    return stated.format(measure=measure, count=found.sessions, grouping=_in_sentence(found.question.grouping))


def notes(found: GroupAnswer) -> list[str]:
    """What has to be known beside it, each a sentence that is there only where it is so."""
    stated = []
    if found.simulated:
        reported = tr_n(
            "SIMULATED: {count} session is simulated.", "SIMULATED: {count} sessions are simulated.", found.simulated
        )
        stated.append(reported.format(count=found.simulated))
    if 0 < found.patients < found.sessions:
        reported = tr_n(
            "All sessions are from {count} person. The intervals are therefore too narrow.",
            "The sessions are from {count} people, and each session counts. The intervals are therefore too narrow.",
            found.patients,
        )
        stated.append(reported.format(count=found.patients))
    if found.is_overlapping:
        stated.append(tr("Some sessions are in several groups."))
    few = sum(row.sessions < LEAST_SESSIONS for row in found.reported)
    if few:
        reported = tr_n(
            "{count} group has fewer than {least} sessions: no interval.",
            "{count} groups have fewer than {least} sessions: no interval.",
            few,
        )
        stated.append(reported.format(count=few, least=LEAST_SESSIONS))
    if left := left_out(found):
        stated.append(left)
    return stated


def left_out(found: GroupAnswer) -> str:
    """What does not count and why; empty where all does."""
    withheld, care, missing = (
        sum(getattr(row, name) for row in found.rows) for name in ("withheld", "with_care", "not_measured")
    )
    parts = [
        (withheld, tr("{count} not reported")),
        (care, tr("{count} rated caution")),
        (missing, tr("{count} not measured")),
    ]
    reported = [words.format(count=count) for count, words in parts if count]
    stated = [tr("Excluded (counted per leg and walk): {what}.").format(what=joined(reported))] if reported else []
    if count := found.simulated_left_out:
        simulated = tr_n("{count} simulated session is excluded.", "{count} simulated sessions are excluded.", count)
        stated.append(simulated.format(count=count))
    return " ".join(stated)


def interval_in_words(row: GroupRow, decimals: int) -> str:
    """From where to where the mean lies; empty without an interval."""
    if not row.has_interval:
        return ""
    low, high = (figure(value, decimals) for value in row.interval)
    return tr("{low} to {high}").format(low=low, high=high)


def figure(value: float, decimals: int) -> str:
    """A number as it is shown, empty where it is none."""
    if value != value:
        return ""
    return figure_text(round(value, decimals) or 0.0, f".{decimals}f").replace("-", MINUS)


def _in_sentence(grouping: Grouping) -> str:
    return within_sentence(grouping_word(grouping))


def _age_band(low: int) -> str:
    if low == 0:
        return tr("under {age} years").format(age=CHILDREN_UNDER)
    if low == AGE_EDGES[-1]:
        return tr("{age} years and over").format(age=low)
    return tr("{low} to {high} years").format(low=low, high=AGE_EDGES[AGE_EDGES.index(low) + 1] - 1)


def _speed_band(low: float) -> str:
    if low == 0:
        return tr("under {speed} m/s").format(speed=figure_text(SPEED_EDGES[0], ".1f"))
    if low == SPEED_EDGES[-1]:
        return tr("{speed} m/s and over").format(speed=figure_text(low, ".1f"))
    high = SPEED_EDGES[SPEED_EDGES.index(low) + 1]
    return tr("{low} to {high} m/s").format(low=figure_text(low, ".1f"), high=figure_text(high, ".1f"))
