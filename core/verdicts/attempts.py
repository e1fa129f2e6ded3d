"""By how much a timed test has to differ between visits before more than another day is behind it.

A test is its own measurement: what attempts of one day differ by is part of what days differ by, and nothing is added.
Only walking speed has a figure between visits; distances in a set time and times from a chair are reported and not
judged.
"""

import math

from core.parameters import SPEED
from core.timed.measures import COLUMNS, MeanOfAttempts
from core.timed.protocols import TimedProtocol
from core.verdicts.measurement_error import SENTENCE_FACTORS, Z95, Difference, ErrorSource, Judgement, Mark
from core.verdicts.model import Assessment
from core.verdicts.sigmas import ComparisonKind, Sigma, sigma_of


def _sigma(column: str) -> Sigma | None:
    return sigma_of(SPEED, ComparisonKind.VISITS) if column == COLUMNS[TimedProtocol.TEN_METRES] else None


def error_between_visits(column: str) -> float:
    """Give what a change of a test's figure has to exceed, in the column's unit; NaN where it is not known."""
    sigma = _sigma(column)
    return Z95 * math.sqrt(2) * sigma.of(0.0) if sigma is not None else math.nan  # of a speed it is a constant


def compare_attempts(
    column: str,
    one: MeanOfAttempts,
    other: MeanOfAttempts,
    assessments: tuple[Assessment, ...],
    *,
    is_chosen_before: bool = False,
) -> Difference:
    """Subtract a test's figure at one visit from another's; no difference where either is not reported."""
    difference = one.mean - other.mean
    if any(not found.is_reported for found in assessments) or not math.isfinite(difference):
        return Difference(math.nan, math.nan, Judgement.NOT_REPORTED)
    sigma, error = _sigma(column), error_between_visits(column)
    if sigma is None:
        return Difference(difference, math.nan, Judgement.NO_PUBLISHED_FIGURE)
    factor, exceeds = 1.0 if is_chosen_before else SENTENCE_FACTORS[ComparisonKind.VISITS], abs(difference) > error
    return Difference(
        difference,
        error,
        Judgement.EXCEEDS_ERROR if exceeds else Judgement.INSIDE_ERROR,
        (ErrorSource.CHANCE, ErrorSource.DAYS),
        mark=Mark.ERROR if exceeds else Mark.NONE,
        is_worth_a_sentence=abs(difference) > factor * error,
        is_unverified=not sigma.is_verified,
    )
