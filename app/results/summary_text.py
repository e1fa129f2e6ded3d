"""What is shown under a walk's curves: in one line how far all of it can be trusted, and how many strides there are."""

from app.summary.data_quality import DataQuality
from app.summary.facts import Facts
from app.summary.quality_line import QualitySentence
from app.widgets.detail_button import DetailText
from app.wording.translation import tr
from app.wording.verdicts import verdict_word
from core.gait.strides import Reason
from core.verdicts.model import Verdict


def door_words(found: DataQuality, sentence: QualitySentence | None) -> DetailText:
    """The line of a walk; of another recording what was noticed about it."""
    if sentence is not None and found.lines:
        line = found.lines[0]
        then = " ".join(filter(None, [sentence.then, sentence.more]))
        return DetailText(line.verdict, sentence.first, then, is_caution=True)
    if sentence is not None:
        return DetailText(Verdict.READ, sentence.first, sentence.then)
    if not found.lines:
        return DetailText(Verdict.READ, found.first, found.in_order)
    line = found.lines[0]
    pattern = tr("{where}: {verdict}.") if line.where else tr("Data quality: {verdict}.")
    first = pattern.format(where=line.where, verdict=verdict_word(line.verdict))
    return DetailText(line.verdict, first, line.why, is_caution=line.is_grave)


def strides_in_short(facts: Facts) -> str:
    """How many strides of each leg were used and left out, and for which reasons."""
    sides = facts.part.sides
    used = ", ".join(f"{side.letter} {facts.strides(side)}" for side in sides)
    if not used:
        return tr("No strides found.")
    out = {side: facts.part.reasons(side) for side in sides}
    left_out = ", ".join(f"{side.letter} {out[side].total() - out[side][Reason.USED]}" for side in sides)
    return tr("Strides used: {used}. Excluded: {left_out}.").format(used=used, left_out=left_out)
