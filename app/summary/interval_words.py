"""A difference's interval in words: where it is likely to be, what healthy people differ by, what goes with speed."""

import math

from app.summary.measure_sentences import unit_and_decimals, unit_in_sentence
from app.summary.numbers_in_words import DAGGER, NOTHING, fixed, signed
from app.wording.translation import capitalised, tr
from core.parameters import Unit, unit_of
from core.verdicts.measurement_error import Difference, Mark


def interval_in_figures(column: str, found: Difference, unit: str = "") -> str:
    """Both ends with their signs and `unit`, as a table has them: "−13 to +4"; a dash where there is none."""
    if not found.is_judged:
        return NOTHING
    low, high = (signed(edge, edge_decimals(column, found)) + unit for edge in found.interval)
    return tr("{low} to {high}").format(low=low, high=high) + (DAGGER if found.is_unverified else "")


def interval_words(column: str, found: Difference) -> str:
    """Where a difference beyond its error is likely to be, by size: "likely between 3° and 15°"; else nothing."""
    if not found.exceeds:
        return ""
    decimals, unit = edge_decimals(column, found), unit_in_sentence(column)
    low, high = (fixed(abs(edge), decimals) for edge in sorted(found.interval, key=abs))
    low, high = low + (unit if unit_of(column) is Unit.DEGREES else ""), high + unit
    return tr("likely between {low} and {high}").format(low=low, high=high)


def evidence(column: str, found: Difference) -> str:
    """What is known of a difference beside its size: the interval, healthy people's legs, and walking speed."""
    if not found.is_judged:
        return ""
    dagger = f" {DAGGER}" if found.is_unverified else ""
    if not found.exceeds:
        return may_be_error_sentence(column, found) + dagger
    likely = f"{capitalised(interval_words(column, found))}.{dagger}"
    return " ".join(filter(None, [likely, further_evidence(column, found)]))


def further_evidence(column: str, found: Difference) -> str:
    """What is known of a difference beside its interval: healthy people's legs, and walking speed."""
    return " ".join(filter(None, [healthy_sentence(found), speed_sentence(column, found)]))


def may_be_error_sentence(column: str, found: Difference) -> str:
    """What a difference within its error may be: all that its interval holds."""
    decimals = unit_and_decimals(column)[1]
    size = fixed(abs(found.difference), decimals) + unit_in_sentence(column)
    low, high = (signed(edge, edge_decimals(column, found)) + unit_and_decimals(column)[0] for edge in found.interval)
    stated = tr("Difference {size}, which may be measurement error: anything from {low} to {high} fits.")
    return stated.format(size=size, low=low, high=high)


def healthy_sentence(found: Difference) -> str:
    """How a difference between the legs compares with healthy people's; nothing where that is not known."""
    if found.mark is Mark.HEALTHY:
        return tr("95 of 100 healthy people differ by less.")
    return tr("Many healthy people differ as much.") if found.exceeds and math.isfinite(found.healthy) else ""


def speed_sentence(column: str, found: Difference) -> str:
    """What of a change goes with another walking speed; nothing where that is nothing, or the other way."""
    part, (_, decimals) = found.by_speed, unit_and_decimals(column)
    if part is None or part.of_speed * found.difference <= 0 or round(abs(part.of_speed), decimals) == 0:
        return ""
    share = fixed(abs(part.of_speed), decimals) + unit_in_sentence(column)
    change = fixed(abs(part.speed_change_m_s), 2)
    if abs(part.of_speed) >= abs(found.difference):
        stated = (
            tr("All of it may go with walking {change} m/s slower.")
            if part.speed_change_m_s < 0
            else tr("All of it may go with walking {change} m/s faster.")
        )
    else:
        stated = (
            tr("Of this, about {share} goes with walking {change} m/s slower.")
            if part.speed_change_m_s < 0
            else tr("Of this, about {share} goes with walking {change} m/s faster.")
        )
    return stated.format(share=share, change=change) + (f" {DAGGER}" if part.is_unverified else "")


def edge_decimals(column: str, found: Difference) -> int:
    """Of the ends of an interval: whole degrees, unless both ends would read the same or one of them as nothing."""
    low, high = map(round, found.interval)
    is_whole = unit_of(column) is Unit.DEGREES and low != high and low and high
    return 0 if is_whole else unit_and_decimals(column)[1]
