"""A draft of the clinical comment, from what the walk shows: it is printed once somebody has confirmed it."""

from app.summary.comparison import Comparison
from app.summary.facts import Facts
from app.summary.headline import headline_of
from app.summary.what_stands_out import BANDS_ON_SCREEN, ranked_findings

MOST_SENTENCES = 3


def comment_draft(facts: Facts, comparison: Comparison | None) -> str:
    """The headline, then findings of other measures."""
    headline = headline_of(facts)
    others = [one for one in ranked_findings(facts, comparison, BANDS_ON_SCREEN) if one.column != headline.column]
    return " ".join([headline.first, *(one.stated for one in others)][:MOST_SENTENCES])
