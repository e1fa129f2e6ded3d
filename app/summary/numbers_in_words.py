"""Format of a number on paper. Fixed decimals, a true minus, and words for where it lies against a band."""

import math
from collections.abc import Mapping

from app.wording.numbers import MINUS
from app.wording.translation import figure_text, tr
from core.body import Side
from core.gait.spatiotemporal import MeanAndSd
from core.parameters import ANKLE_RANGE, KNEE_RANGE, STANCE
from core.verdicts.measurement_error import Difference, Judgement, Mark, least_error
from core.verdicts.model import Verdict
from core.verdicts.norms import MIN_STRIDES_FOR_MEAN, MIN_STRIDES_FOR_SD
from core.verdicts.sigmas import ComparisonKind

NOTHING = "–"
DAGGER = "\u2020"
CARE = "*"  # beside what is to be read with care
Band = tuple[float, float]
"""Mean less and plus 1 SD of the group."""


def fixed(value: float | None, decimals: int) -> str:
    """Write a number with its decimals; what is not known is a dash, and nothing is minus zero."""
    if value is None or not math.isfinite(value):
        return NOTHING
    text = figure_text(value, f".{decimals}f")
    if text.startswith("-"):
        text = text[1:] if not text.strip("-0.,") else MINUS + text[1:]
    return text


def signed(value: float | None, decimals: int) -> str:
    """Write a difference, always with its sign but for a zero."""
    text = fixed(value, decimals)
    return text if text == NOTHING or text.startswith(MINUS) or not text.strip("0.,") else f"+{text}"


def spread(found: MeanAndSd, decimals: int) -> str:
    """Write mean ± SD; from fewer strides than a spread or a mean needs, without it."""
    if found.n < MIN_STRIDES_FOR_MEAN:
        return NOTHING
    mean = fixed(found.mean, decimals)
    return mean if found.n < MIN_STRIDES_FOR_SD or mean == NOTHING else f"{mean} ± {fixed(found.sd, decimals)}"


def band_in_figures(band: Band, decimals: int) -> str:
    return f"{fixed((band[0] + band[1]) / 2, decimals)} ± {fixed((band[1] - band[0]) / 2, decimals)}"


def against_band(value: float, band: Band) -> str:
    """Say how far a value lies from the group's mean, in its SD; never whether that is good."""
    return away_in_words((value - (band[0] + band[1]) / 2) / ((band[1] - band[0]) / 2))


def away_in_words(away_sd: float) -> str:
    """Say how many SD something lies from the group's mean."""
    if abs(away_sd) <= 1:
        return tr("within\N{NO-BREAK SPACE}1\N{NO-BREAK SPACE}SD")
    if abs(away_sd) <= 2:
        return tr("1–2\u00a0SD\u00a0below") if away_sd < 0 else tr("1–2\u00a0SD\u00a0above")
    return tr("more than 2\u00a0SD\u00a0below") if away_sd < 0 else tr("more than 2\u00a0SD\u00a0above")


def each_side(stated: Mapping[Side, str]) -> str:
    """Words for both legs, in one line where they agree."""
    if len(stated) == len(Side) and len(set(stated.values())) == 1:
        return f"L, R {stated[Side.LEFT]}"
    return "\n".join(f"{side.letter} {words}" for side, words in stated.items()) or NOTHING


def sides_against_band(values: Mapping[Side, MeanAndSd], band: Band | None) -> str:
    """Say where both legs lie."""
    if band is None:
        return NOTHING
    return each_side({s: against_band(v.mean, band) for s, v in values.items() if math.isfinite(v.mean)})


def marked(stated: str, verdict: Verdict) -> str:
    """A figure with the mark of what is to be read with care."""
    return f"{stated}\u00a0{CARE}" if verdict is Verdict.CARE and stated != NOTHING else stated


def care_note() -> str:
    return tr("{mark}: caution; reason under data quality.").format(mark=CARE)


MARKS = {Mark.HEALTHY: "\N{BLACK CIRCLE}", Mark.ERROR: "\N{WHITE CIRCLE}", Mark.NONE: ""}


def in_words(found: Difference) -> str:
    """What a difference is beyond, as a table states it, with its mark."""
    stated = {
        Judgement.EXCEEDS_ERROR: tr("beyond error"),
        Judgement.INSIDE_ERROR: tr("may be error"),
        Judgement.NOT_REPORTED: tr("not reported"),
        Judgement.TOO_FEW_STRIDES: tr("too few strides"),
        Judgement.NO_PUBLISHED_FIGURE: tr("not judged"),
    }[found.judgement]
    if found.mark is Mark.HEALTHY:
        stated = tr("beyond healthy range")
    return f"{MARKS[found.mark]}\u00a0{stated}".strip()


def in_brief(found: Difference) -> str:
    """The mark alone, or why there is none."""
    return MARKS[found.mark] or in_words(found)


def judged_in_words(found: Difference) -> str:
    """The same as `in_words`, with a dagger where the error rests on a figure whose source could not be read."""
    return in_words(found) + (f"\u00a0{DAGGER}" if found.is_unverified and found.is_judged else "")


def marks_note() -> str:
    """What the marks mean, below a table."""
    return tr(
        "\N{BLACK CIRCLE} beyond 95 of 100 healthy people, \N{WHITE CIRCLE} beyond measurement error, "
        "none: may be error."
    )


def dagger_note() -> str:
    return tr("{dagger}: measurement error based on a value whose source could not be verified.").format(dagger=DAGGER)


USUAL = {KNEE_RANGE: 60.0, ANKLE_RANGE: 28.0, STANCE: 61.0}  # means for which tables give an error


def least_error_in_words(column: str, kind: ComparisonKind) -> str:
    """What a difference of a usual size has to exceed at least, with its dagger; a dash where no error is known."""
    error, is_verified = least_error(column, kind, USUAL[column])
    return fixed(error, 1) + ("" if is_verified or not math.isfinite(error) else DAGGER)
