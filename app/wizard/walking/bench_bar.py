"""What can be done at the bench between two walks: walk on, keep, return to where it began."""

from app.theme.icons import Icon
from app.widgets.action_bar import BarAction, BarState
from app.wizard.walking.bench_control import Bench
from app.wording.translation import tr


def bench_bar(bench: Bench, asked: str | None, test: str, note: str, can_start: bool) -> BarState:
    """`asked`: the letter of the walk that waits to be kept; None where none does. `test`: what starts a timed one.

    The last of the others starts a walk; one before it returns to the first alignment.
    """
    chain = bench.chain
    is_new = bool(bench.entry.parts)
    letter = chain.next_letter if is_new else chain.letters.get(chain.base, "")
    walk = tr("Walk with {letter}") if is_new else tr("Repeat {letter}")
    words = test or walk.format(letter=letter)
    start = BarAction(words, tr("Space"), Icon.PLAY, is_wished=False, is_enabled=can_start)
    others: tuple[BarAction, ...] = (start,)
    if chain.way_back(chain.first):
        back = tr("Return to {letter}").format(letter=chain.letters.get(chain.first, ""))
        others = (BarAction(back, "", Icon.REPEAT, is_wished=False), start)
    if asked is None:
        results = BarAction(tr("Results"), "", Icon.NEXT)
        return BarState(primary=results, others=others, note=note)
    keep = BarAction(tr("Include {letter}").format(letter=asked), tr("Enter"), Icon.CHECK)
    return BarState(primary=keep, others=others, note=note)
