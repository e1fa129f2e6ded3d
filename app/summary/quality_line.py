"""How far a walk can be trusted, in one line: good, with what was looked at, or the gravest cause and its action."""

from dataclasses import dataclass

from app.summary import quality
from app.summary.data_quality import DataQuality, QualityLine, data_quality, one_time_in_words
from app.summary.facts import Facts
from app.wording.translation import joined, tr, tr_n
from app.wording.verdicts import verdict_word
from core.body import Side
from core.gait.clocks import ClockTie
from core.verdicts.model import Verdict


@dataclass(frozen=True, slots=True)
class QualitySentence:
    """`first` is the verdict in a few words, `then` what it rests on; `to_do` one action, `more` how many causes else.

    `line` is the gravest cause; None where the data are good.
    """

    first: str
    then: str
    to_do: str = ""
    more: str = ""
    line: QualityLine | None = None
    others: int = 0

    @property
    def is_good(self) -> bool:
        return self.line is None

    @property
    def in_words(self) -> str:
        return " ".join(filter(None, [self.first, self.then, self.to_do, self.more]))


def quality_sentence(facts: Facts, found: DataQuality | None = None) -> QualitySentence:
    """The line of a walk; `found`: its data quality, where that is known already."""
    known = data_quality(facts) if found is None else found
    if not known.lines:
        if not facts.gait:
            return QualitySentence(known.first, known.then)
        return QualitySentence(tr("Data quality: good."), in_order(facts))
    line = known.lines[0]
    pattern = tr("{where}: {verdict}.") if line.where else tr("Data quality: {verdict}.")
    first = pattern.format(where=line.where, verdict=_in_sentence(line.verdict))
    more = len(known.lines) - 1
    words = tr_n("And {count} more.", "And {count} more.", more).format(count=more) if more else ""
    return QualitySentence(first, line.why, line.to_do, words, line, more)


def _in_sentence(verdict: Verdict) -> str:
    word = verdict_word(verdict)
    return word[:1].lower() + word[1:]


def strides_in_words(facts: Facts) -> str:
    """How many strides of each leg are used: "12 and 13 strides"."""
    counts = [str(facts.strides(side)) for side in Side if side in facts.gait]
    return tr("{counts} strides").format(counts=joined(counts))


def in_order(facts: Facts) -> str:
    """Strides of each leg, and what was looked at without finding anything."""
    counts = [str(facts.strides(side)) for side in Side if side in facts.gait]
    parts = [strides_in_words(facts)]
    if facts.verdicts.between.verdict is Verdict.READ and len(counts) > 1:
        is_by_hips = facts.walk.clocks is not None and facts.walk.clocks.tie is ClockTie.PELVIS
        parts.append(one_time_in_words(facts.walk) if is_by_hips else tr("sensors synchronised"))
    if not quality.slipped_straps(facts):
        parts.append(tr("no strap moved"))
    words = ", ".join(parts)
    return f"{words}."
