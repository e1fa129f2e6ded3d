"""The phases of the stride as bars, one a leg: filled greys for the left one, hatched for the right one."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from app.charts.cycles import is_mean_enough
from app.charts.drawing import COLOURS, MM, Drawing, Picture
from app.summary.facts import Facts
from app.summary.numbers_in_words import fixed
from app.theme.colours import PAPER
from app.wording.body import side_name
from app.wording.translation import capitalised, tr
from core.body import Side

WIDTH, LEFT_EDGE, BAR, ROW, TOP = 175 * MM, 16.0, 15.0, 23.0, 12.0
FILLS = (PAPER.band_1sd_edge, PAPER.band_2sd, PAPER.band_1sd, PAPER.paper)  # heel, ankle, forefoot, swing
HATCH_APART = (2.2, 9.0, 4.2, 0.0)  # points between the lines of the right leg's phases; none in swing


@dataclass(frozen=True, slots=True)
class Phases:
    """When a foot lies flat, its heel rises and its toe leaves, percent of the stride from initial contact."""

    foot_flat: float
    heel_rise: float
    toe_off: float

    @property
    def lasts(self) -> tuple[float, float, float, float]:
        """Heel, ankle and forefoot rocker, swing."""
        return self.foot_flat, self.heel_rise - self.foot_flat, self.toe_off - self.heel_rise, 100 - self.toe_off


def phases_of(facts: Facts, side: Side) -> Phases | None:
    """The means over the strides used; None where timing may not be reported or a foot sensor did not give them."""
    stance = facts.value(side, "stance_percent")
    if not is_mean_enough(stance.n):
        return None
    of_walks = [walk.gait[side].strides for walk in facts.part.walks if side in walk.gait]
    flat, rise = (
        np.concatenate([(100 * (getattr(one, at) - one.start_s) / one.time_s)[one.is_used] for one in of_walks])
        for at in ("full_contact_s", "heel_rise_s")
    )
    known = np.isfinite(flat) & np.isfinite(rise)
    if not is_mean_enough(int(known.sum())):
        return None
    found = Phases(float(flat[known].mean()), float(rise[known].mean()), stance.mean)
    return found if 0 <= found.foot_flat <= found.heel_rise <= found.toe_off and math.isfinite(found.toe_off) else None


def phase_bars(phases: Mapping[Side, Phases]) -> Picture:
    names = ("", tr("ankle rocker"), tr("forefoot rocker"), tr("swing"))
    events = (tr("contact"), tr("foot flat"), tr("heel rise"), tr("toe\u2011off"))
    across = WIDTH - LEFT_EDGE - 14

    def x(percent: float) -> float:
        return LEFT_EDGE + across * percent / 100

    first, draw = next(iter(phases.values())), Drawing()
    for name, percent in zip(events, (0.0, first.foot_flat, first.heel_rise, first.toe_off), strict=True):
        at, anchor = (x(percent) - 2, "end") if percent == 0 else (x(percent), "middle")
        draw.text(max(at, 24 if percent == 0 else at), TOP - 4, name, 6.6, anchor=anchor, fill=PAPER.note)
    stated = []
    for row, (side, found) in enumerate(phases.items()):
        y, at = TOP + ROW * row, 0.0
        draw.badge(6, y + BAR / 2, side.letter, side, COLOURS[side])
        for number, lasts in enumerate(found.lasts):
            _draw_bar(draw, x(at), y, x(at + lasts) - x(at), number, side)
            words = f"{names[number]} {fixed(lasts, 0)} %".strip()
            room = x(at + lasts) - x(at)
            words = words if len(words) * 3.6 < room else f"{fixed(lasts, 0)} %"
            if len(words) * 3.6 < room:
                middle = x(at + lasts / 2)
                if side is Side.RIGHT and HATCH_APART[number]:
                    draw.box(middle - len(words) * 1.9, y + 3, len(words) * 3.8, BAR - 6, PAPER.paper)
                draw.text(middle, y + BAR / 2 + 2.4, words, 6.8, anchor="middle", weight=600)
            at += lasts
        pattern = tr("{side}: foot flat at {flat} %, heel rise at {rise} %, toe\u2011off at {off} % of the gait cycle.")
        stated.append(
            pattern.format(
                side=capitalised(side_name(side)),
                flat=fixed(found.foot_flat, 1),
                rise=fixed(found.heel_rise, 1),
                off=fixed(found.toe_off, 1),
            )
        )
    bottom = TOP + ROW * len(phases) - (ROW - BAR)
    for percent in range(0, 101, 20):
        draw.line(x(percent), bottom, x(percent), bottom + 3, PAPER.ink, 0.5)
        draw.text(x(percent), bottom + 10, f"{percent}{' %' if percent == 100 else ''}", 6.6, anchor="middle")
    return draw.picture(WIDTH, bottom + 13, " ".join(stated))


def _draw_bar(draw: Drawing, left: float, top: float, width: float, number: int, side: Side) -> None:
    is_left, apart = side is Side.LEFT, HATCH_APART[number]
    for at in np.arange(left + apart, left + width, apart) if apart and not is_left else ():
        draw.line(at, top, at, top + BAR, PAPER.ink, 0.4)
    draw.box(left, top, width, BAR, FILLS[number] if is_left else "none", PAPER.ink, 0.6)
