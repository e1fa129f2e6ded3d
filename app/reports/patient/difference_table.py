"""Page one's table: in what the legs differ most, with intervals, healthy people's difference and the last visit."""

import math
from collections.abc import Sequence

from app.charts.cycles import is_mean_enough
from app.charts.drawing import MM, Drawing, Picture
from app.charts.joint_on_paper import CHIP, chip_picture
from app.summary.facts import Facts
from app.summary.goals import goal_mark
from app.summary.headline import Headline
from app.summary.interval_words import interval_in_figures
from app.summary.numbers_in_words import CARE, DAGGER, NOTHING, dagger_note, fixed, marked, signed
from app.summary.trend_lines import walked_visits
from app.summary.what_differs import LegsRow, half_of_strip, since_last, what_differs, without_family
from app.summary.what_stands_out import FAMILIES
from app.theme.colours import LIGHT, PAPER
from app.wording.body import side_name
from app.wording.dates import day_in_words
from app.wording.measures import with_unit
from app.wording.numbers import MINUS
from app.wording.translation import tr
from core.body import Side
from core.parameters import KNEE, Unit, unit_of
from core.verdicts.measurement_error import Mark
from core.verdicts.model import Verdict

MOST_ROWS = 5
HIP = "hip_range_deg"
MARK, STRIP, STRIP_HEIGHT = 7.0, 20 * MM, 12.0
MARGIN = 2.4  # so that what reaches an edge is seen whole


def difference_table(facts: Facts, headline: Headline) -> dict[str, object] | None:
    """Up to five rows, a hip's among them where one was measured; None where nothing was. One leg: its values alone."""
    rows = _rows(facts)
    if not any(row.values for row in rows):
        return None
    sides = [side for side in Side if side in facts.gait]
    walked = walked_visits(facts.course, facts.condition)
    days = [visit.day for visit in walked]
    has_last, first = len(walked) > 1, facts.first_and_second[0]
    less = f"{first.letter} {MINUS} {first.other.letter}"
    since = tr("Since {day}").format(day=day_in_words(days[-2], days)) if has_last else ""
    return {
        "title": tr("Largest differences") if len(sides) > 1 else tr("Values"),
        "sides": [chip_picture(side, CHIP, side_name(side)).as_data() for side in sides],
        "heads": [less, tr("likely between"), tr("95 of 100")] if len(sides) > 1 else [],
        "since": since,
        "rows": [_row(facts, row, sides, has_last=has_last) for row in rows],
        "marks": _marks(rows, sides, headline),
    }


def _rows(facts: Facts) -> list[LegsRow]:
    """As on the screen; the last gives way to a hip's, else to one of a leg that is not reported, the knee's first."""
    rows = [row for row in without_family(what_differs(facts)) if row.values]
    if len(facts.gait) < len(Side):
        columns = {row.column for row in rows}
        rows = [row for row in rows if FAMILIES.get(row.column) not in columns]
    shown, rest = rows[:MOST_ROWS], rows[MOST_ROWS:]
    if not any(map(_is_missing, shown)):
        rest.sort(key=lambda row: (row.column != HIP, not _is_missing(row), row.column != KNEE))
        shown += [row for row in rest[:1] if row.column == HIP or _is_missing(row)]
    else:
        shown += [row for row in rest if row.column == HIP]
    return [*shown[: MOST_ROWS - 1], shown[-1]] if len(shown) > MOST_ROWS else shown


def _is_missing(row: LegsRow) -> bool:
    return Verdict.NOT_REPORTED in row.verdicts.values()


def _row(facts: Facts, row: LegsRow, sides: Sequence[Side], *, has_last: bool) -> dict[str, object]:
    found, unit = row.difference, "°" if unit_of(row.column) is Unit.DEGREES else ""
    is_marked, decimals = found.mark is not Mark.NONE, row.decimals
    missing = [side for side in sides if side not in row.values and row.verdicts[side] is not Verdict.NOT_MEASURED]
    why = ""
    if missing and not found.is_reported:
        why = ", ".join(f"{side.letter} {row.unknown[side]}" for side in missing)
    return {
        "name": "; ".join([row.name if unit else with_unit(row.name, row.unit.strip()), *map(goal_mark, row.goals)]),
        "values": [_value(row, side, unit) for side in sides],
        "mark": mark_picture(found.mark).as_data() if is_marked else None,
        "difference": signed(found.difference, decimals) + unit if found.is_reported else NOTHING,
        "between": interval_in_figures(row.column, found, unit),
        "why": why,
        "reference": tr("up to {limit}").format(limit=fixed(found.healthy, decimals) + unit)
        if math.isfinite(found.healthy)
        else NOTHING,
        "is_marked": is_marked,
        "since": _since(facts, row, unit) if has_last else "",
        "strip": strip(row).as_data() if not has_last and found.is_judged and len(sides) > 1 else None,
    }


def _value(row: LegsRow, side: Side, unit: str) -> str:
    if side not in row.values or not is_mean_enough(row.values[side].n):
        return NOTHING
    return marked(fixed(row.values[side].mean, row.decimals) + unit, row.verdicts.get(side, Verdict.READ))


def _since(facts: Facts, row: LegsRow, unit: str) -> str:
    changed = since_last(facts, row.column)
    if changed is None:
        return NOTHING
    side, found = changed
    dagger = DAGGER if found.is_unverified and found.exceeds else ""
    return f"{side.letter}\u00a0{signed(found.difference, row.decimals)}{unit}{dagger}"


def _marks(rows: Sequence[LegsRow], sides: Sequence[Side], headline: Headline) -> list[dict[str, object]]:
    """What is beside the numbers, in words: each mark's picture, or none."""
    stated: list[dict[str, object]] = []
    if len(sides) > 1:
        stated.append({"picture": None, "said": tr("95 of 100: healthy people who differ by less.")})
        words = {Mark.HEALTHY: tr("beyond that"), Mark.ERROR: tr("beyond measurement error")}
        used = {row.difference.mark for row in rows}
        stated += [{"picture": mark_picture(mark).as_data(), "said": words[mark]} for mark in words if mark in used]
        is_in_table = any(row.difference.is_judged and row.difference.is_unverified for row in rows)
        if is_in_table or DAGGER in headline.then:
            stated.append({"picture": None, "said": dagger_note()})
    if any(Verdict.CARE in row.verdicts.values() for row in rows):
        stated.append({"picture": None, "said": tr("{mark}: caution.").format(mark=CARE)})
    return stated


def mark_picture(mark: Mark) -> Picture:
    fill = PAPER.ink if mark is Mark.HEALTHY else PAPER.paper
    words = tr("beyond 95 of 100") if mark is Mark.HEALTHY else tr("beyond error")
    draw = Drawing()
    draw.circle(MARK / 2, MARK / 2, 2.6, fill, PAPER.ink, 1.1)
    return draw.picture(MARK, MARK, words)


def strip(row: LegsRow) -> Picture:
    """A difference with its likely interval over what 95 of 100 healthy people differ by."""
    found, reach = row.difference, half_of_strip(row.difference)
    y, half = STRIP_HEIGHT / 2, STRIP / 2

    def x(value: float) -> float:
        return half + (half - MARGIN) * min(max(value / reach, -1.0), 1.0)

    draw = Drawing()
    if math.isfinite(found.healthy):
        left, right = x(-found.healthy), x(found.healthy)
        draw.box(left, 1, right - left, STRIP_HEIGHT - 2, LIGHT.band_2sd)
    draw.line(half, 0.5, half, STRIP_HEIGHT - 0.5, PAPER.note, 0.5)
    low, high = (x(edge) for edge in found.interval)
    draw.line(low, y, high, y, PAPER.ink, 0.9)
    for end in (low, high):
        draw.line(end, y - 2.2, end, y + 2.2, PAPER.ink, 0.9)
    draw.line(x(found.difference), y - 4, x(found.difference), y + 4, PAPER.ink, 2.0)  # dots are the marks
    return draw.picture(STRIP, STRIP_HEIGHT)
