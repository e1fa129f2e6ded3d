"""The answer to a walk, as a screen shows it before anything else: one sentence, and one beside it.

They are the sentences of the report's first page, so that nobody reads on paper what the screen did not say.
"""

from dataclasses import dataclass
from enum import StrEnum

from app.charts.cycles import is_mean_enough
from app.summary import quality
from app.summary.facts import Facts
from app.summary.goals import goal_sentence
from app.summary.what_stands_out import (
    BANDS_ON_SCREEN,
    judged_differences,
    nothing_found,
    ranked_findings,
)
from app.wording.translation import joined, tr, within_sentence
from core.body import Side
from core.verdicts.model import Verdict


class Outcome(StrEnum):
    """What kind of answer there is.

    DIFFERS: something is so much larger than its error, or beyond a band, that it is reported. NOTHING: differences
    were judged, and none exceeds its error. OPEN: nothing is reported, and yet something exceeds its error or nothing
    could be judged. UNREADABLE: a mean cannot be reported for either leg.
    """

    DIFFERS = "differs"
    NOTHING = "nothing"
    OPEN = "open"
    UNREADABLE = "unreadable"


@dataclass(frozen=True, slots=True)
class Answer:
    """`first` is the sentence that is read from afar, `then` what belongs to it; `then` may be empty."""

    outcome: Outcome
    first: str
    then: str = ""


def answer_of(facts: Facts) -> Answer:
    """The weightiest finding of a walk and the one after it, or the caveat where there is no other."""
    strides = {side: facts.strides(side) for side in facts.gait}
    if not strides:
        first = tr("No results for this walk: no foot or shank sensor showed a stride.")
        return Answer(Outcome.UNREADABLE, first)
    if not any(map(is_mean_enough, strides.values())):
        counted = joined([f"{side[0].upper()}\u00a0{strides[side]}" for side in Side if side in strides])
        first = tr("Too few strides for a mean: {counted}.").format(counted=counted)
        return Answer(Outcome.UNREADABLE, first, tr("Repeat the walk over a longer distance or time."))
    last = _brief_caveat(facts)
    if found := ranked_findings(facts, None, BANDS_ON_SCREEN):
        beside = [found[1].stated] if len(found) > 1 else last
        stated = [found[0].evidence, *_goal(facts), *beside]
        return Answer(Outcome.DIFFERS, found[0].stated, " ".join(filter(None, stated)))
    first, *others = nothing_found(facts, None)
    judged = judged_differences(facts, None)
    is_none = bool(judged) and not any(one.exceeds for one in judged.values())
    return Answer(Outcome.NOTHING if is_none else Outcome.OPEN, first, " ".join([*others, *_goal(facts), *last]))


def _goal(facts: Facts) -> list[str]:
    """How the walk relates to a goal that was agreed before: to the first that is judged."""
    return [stated for one in facts.reported_goals if (stated := goal_sentence(one))][:1]


def _brief_caveat(facts: Facts) -> list[str]:
    """Which joint or leg cannot be read; why, and what to do, is shown one step behind the answer."""
    not_reported = [cause.where for cause in quality.causes(facts, (Verdict.NOT_REPORTED,)) if not cause.is_aside]
    return [tr("Not reported: {where}.").format(where=within_sentence(not_reported[0]))] if not_reported else []
