"""What can be done on the Free motion step: while legs move, once they have, and where labels are contradicted."""

from collections.abc import Sequence
from dataclasses import dataclass

from app.theme.icons import Icon
from app.widgets.action_bar import BarAction, BarState
from app.wording.translation import tr
from core.body import Side


@dataclass(frozen=True, slots=True)
class BarFacts:
    """How the step stands. `has_played`: whether a patient who is replayed had a free motion to play."""

    is_recording: bool
    has_moved: bool
    is_in_doubt: bool
    is_unplaced: bool
    is_done: bool
    is_played: bool
    has_played: bool
    price: str


def motion_bar(facts: BarFacts, repeatable: Sequence[Side]) -> BarState:
    """`repeatable`: the legs that may be repeated."""
    words = {Side.LEFT: (tr("Repeat left"), "L"), Side.RIGHT: (tr("Repeat right"), "R")}
    repeat = tuple(BarAction(*words[side], Icon.REPEAT) for side in repeatable)
    go_on = BarAction(tr("Continue to walking"), tr("Enter"), Icon.NEXT)
    again = BarAction(tr("Record again"), tr("Space"), Icon.REPEAT, is_wished=False)
    stop = BarAction(tr("Stop early"), tr("Space"), Icon.STOP, is_wished=False)
    check = BarAction(tr("Check positions"), "P")
    if facts.is_in_doubt:
        use = BarAction(tr("Use detected positions"), tr("Enter"), Icon.CHECK)
        return BarState(primary=use, others=(stop if facts.is_recording else again,), quiet=(check,))
    if not facts.is_recording and not facts.has_moved:
        begin = BarAction(tr("Start free motion"), tr("Space"), Icon.PLAY)
        return BarState(primary=begin, quiet=(check,) if facts.is_unplaced else ())
    if not facts.is_recording:
        return BarState(primary=go_on, others=(again,), quiet=repeat)
    if facts.is_done:
        return BarState(primary=go_on, quiet=repeat, note=facts.price or tr("Continues automatically."))
    if facts.is_played and not facts.has_played:
        return BarState(primary=go_on)
    if facts.is_played:
        return BarState(
            primary=go_on, others=(BarAction(again.text, "", Icon.REPEAT, is_wished=False),), note=facts.price
        )
    return BarState(primary=stop, quiet=repeat, note=facts.price)
