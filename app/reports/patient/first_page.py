"""The page usable alone: who, what changed or differs, the clinician's comment, four values, both curves, a table."""

import math
from dataclasses import replace

from app.charts.drawing import MM
from app.charts.joint_on_paper import CHIP, chip_picture, draw_joint
from app.reports.patient.difference_table import difference_table
from app.reports.patient.tile_pictures import arrow, bar
from app.summary import panels
from app.summary.comparison import Comparison, Contrast
from app.summary.facts import KINDS, Facts
from app.summary.headline import Headline, headline_of
from app.summary.joint_panels import joint_chart
from app.summary.marks_on_curves import bracket_of, labels_of
from app.summary.numbers_in_words import fixed
from app.summary.plain_text import CONDITION_LENGTH, plain_lines, typed
from app.summary.quality_line import quality_sentence, strides_in_words
from app.summary.report_dates import date_of
from app.summary.request import ReportRequest
from app.summary.tiles import Tile, TileValue, tiles_of
from app.wording.body import side_name
from app.wording.patients import aids_in_words
from app.wording.prostheses import worn_words
from app.wording.recordings import name_in_words
from app.wording.translation import capitalised, tr, tr_n
from core.body import Side
from core.parameters import KNEE, STANCE

NOT_STATED = ("", "none")
CHART_WIDTH, CHART_HEIGHTS = 85 * MM, (90 * MM, 78 * MM, 70 * MM, 60 * MM)  # the highest that has room is printed
SHORT_COMMENT, LONG_COMMENT, LETTERS_OF_LINE = 4, 9, 36  # lines in the usual box, and in the high one


def first_page(request: ReportRequest, facts: Facts, comparison: Comparison | None) -> dict[str, object]:
    """All that the template sets on page one, in the order it is read."""
    headline = headline_of(facts)
    return {
        "who": who(request),
        "summary": {"heading": tr("Summary"), "first": headline.first, "then": headline.then},
        "comment": comment(request),
        "caution": caution(facts),
        "tiles": [
            _tile(tile, has_earlier=request.earlier is not None)
            for tile in tiles_of(facts)
            if tile.column != STANCE or len(facts.gait) != 1
        ],
        "charts": charts(request, facts, headline, comparison),
        "table": difference_table(facts, headline),
        "quality": _quality(facts),
        "source": source(facts, headline),
    }


def who(request: ReportRequest) -> str:
    """Who was measured, as the clinic typed it, and how the walk was; what nobody stated is left out."""
    session, patient = request.visit.session, request.visit.session.patient
    is_prosthetic = patient.prosthetic_side not in NOT_STATED
    side = patient.prosthetic_side if is_prosthetic else patient.affected_side
    worn = [capitalised(one) for one in worn_words(patient)]
    known = [
        {"male": tr("Man"), "female": tr("Woman")}.get(patient.sex, patient.sex),
        tr("born {year}").format(year=patient.birth_year) if patient.birth_year is not None else "",
        f"{fixed(patient.height_m, 2)}\u00a0m" if patient.height_m is not None else "",
        f"{fixed(patient.mass_kg, 0)}\u00a0kg" if patient.mass_kg is not None else "",
        *(worn or [_side_in_words(side, is_prosthetic=is_prosthetic)]),
        patient.device,
        tr("no walking aids") if patient.aids == "none" else aids_in_words(patient.aids),
        session.surface,
        name_in_words(request.visit.condition_of(request.shown)),
    ]
    return " · ".join(one if one in worn else typed(one, CONDITION_LENGTH) for one in known if one)


def comment(request: ReportRequest) -> dict[str, object] | None:
    """The clinician's words, as many as the box holds; None without any. Longer ones are whole on another page."""
    lines = plain_lines(request.comment)
    if not lines:
        return None
    return {
        "heading": tr("Clinical comment"),
        "lines": lines,
        "by": typed(request.comment_by, CONDITION_LENGTH),
        "is_long": _lines_needed(request) > SHORT_COMMENT,
        "rest": tr("Whole comment: page {page}.") if is_comment_cut(request) else "",
    }


def is_comment_cut(request: ReportRequest) -> bool:
    """Whether page one has no room for all of the comment."""
    return _lines_needed(request) > LONG_COMMENT


def _lines_needed(request: ReportRequest) -> int:
    return sum(max(1, math.ceil(len(line) / LETTERS_OF_LINE)) for line in plain_lines(request.comment))


def caution(facts: Facts) -> dict[str, str] | None:
    """What is not good about the measurement, the gravest; None where all of it is good."""
    found = quality_sentence(facts)
    if found.is_good:
        return None
    more = tr_n("{count} more on page {page}.", "{count} more on page {page}.", found.others)
    others = more.format(count=found.others, page="{page}") if found.others else ""  # whoever sets pages knows it
    return {"first": found.first, "then": " ".join(filter(None, [found.then, others]))}


def charts(
    request: ReportRequest, facts: Facts, headline: Headline, comparison: Comparison | None
) -> list[list[dict[str, object]]]:
    """Knee and ankle beside each other, in every height; for one that no leg has, why. Hips are on page two."""
    if not any(map(facts.has_joint, KINDS)):
        return [[{"said": tr("No joint angle was measured.")}]]
    thin = request.thin
    if thin is None and comparison is not None and comparison.kind is Contrast.VISITS:
        day = date_of(request.earlier.session.started) if request.earlier is not None else None
        thin = replace(comparison.against, day=day)  # a chart's key has room for a day
    found = [
        joint_chart(facts, kind, headline, thin) if facts.has_joint(kind) else panels.why_no_joint(facts, kind)
        for kind in KINDS
    ]
    return [
        [
            {"said": one} if isinstance(one, str) else {"picture": draw_joint(one, CHART_WIDTH, height).as_data()}
            for one in found
        ]
        for height in CHART_HEIGHTS
    ]


def source(facts: Facts, headline: Headline) -> list[str]:
    """Whose the grey curve is, or why there is none; what values on the curves are; where data quality is in detail."""
    values = [tr("Values at dots are peak angles.")] if any(labels_of(facts, kind) for kind in KINDS) else []
    if bracket_of(facts, headline) is not None:
        values.append(tr("The bracket is the value of the first sentence."))
    return [panels.band_in_words(facts), *values, tr("Data quality in detail: page {page}.")]


def _quality(facts: Facts) -> list[str]:
    found = quality_sentence(facts)
    if found.is_good:
        return [found.first, found.then]
    return [tr("Data quality: caution."), f"{strides_in_words(facts)}."] if facts.gait else [found.first, found.then]


def _tile(tile: Tile, *, has_earlier: bool) -> dict[str, object]:
    is_known = any(math.isfinite(value.value) for value in tile.values)
    change, only = tile.change, tile.values[0]
    pattern = tr("{change}, beyond error") if change.is_beyond_error else tr("{change}, within error")
    stated = pattern.format(change=change.size) if change.rises is not None else change.size or change.words
    return {
        "name": tr("Knee, stance to swing") if tile.column == KNEE else tile.name,
        "values": [_value(value) for value in tile.values] if is_known else [_nothing(tile, only)],
        "unit": tile.unit if is_known else "",
        "bar": bar(tile).as_data() if is_known else None,
        "arrow": arrow(change).as_data() if change.rises is not None and change.size.strip("0.,°") else None,
        "change": (stated if change.day or not has_earlier else "") or (tile.why if is_known else ""),
        "then": " · ".join(filter(None, [tile.last, tile.goal])),
        "alt": tile.in_words,
    }


def _value(value: TileValue) -> dict[str, object]:
    return {"text": value.text, "chip": _chip(value.side), "is_word": False}


def _nothing(tile: Tile, value: TileValue) -> dict[str, object]:
    side = value.side if len(tile.values) == 1 else None
    return {"text": capitalised(tile.why or value.text), "chip": _chip(side), "is_word": True}


def _chip(side: Side | None) -> dict[str, object] | None:
    return chip_picture(side, CHIP, side_name(side)).as_data() if side is not None else None


def _side_in_words(side: str, *, is_prosthetic: bool) -> str:
    if side not in (*Side, "both"):
        return "" if side == "none" else tr("affected side not recorded")
    name = tr("both") if side == "both" else side_name(Side(side))
    pattern = tr("prosthetic side: {side}") if is_prosthetic else tr("affected side: {side}")
    return pattern.format(side=name)
