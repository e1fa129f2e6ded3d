"""The pelvis over the strides of each leg: how it tilts, drops and turns; nothing without a sensor on it."""

from app.reports.blocks import Block, Column, Row, heading, note, table
from app.reports.patient.peaks_table import value_cell
from app.summary.facts import Facts
from app.summary.numbers_in_words import CARE
from app.summary.walk_figures import PELVIS_ROWS, pelvis_in_words
from app.wording.translation import tr
from core.body import Side
from core.verdicts.model import Verdict


def pelvis_table(facts: Facts) -> list[Block]:
    """A row per figure of the pelvis, reported once for the strides of each leg."""
    if not facts.part.has_pelvis:
        return []
    columns = [
        Column(tr("Pelvis, ° from standing"), "1fr", is_number=False),
        *(Column(_over_strides(side)) for side in Side),
    ]
    rows: list[Row] = [[tr(name), *(value_cell(facts, side, column) for side in Side)] for column, name in PELVIS_ROWS]
    stated = [
        tr(
            "Drop: how far the side of the swinging leg drops below the other side. Each column covers "
            "the strides of one leg."
        ),
        *pelvis_in_words(facts.part),
    ]
    if any(facts.assessment(side, column).verdict is Verdict.CARE for side in facts.gait for column, _ in PELVIS_ROWS):
        stated.append(tr("{mark}: caution.").format(mark=CARE))
    return [heading(tr("Pelvis"), level=2), table(columns, rows, is_dense=True), note(" ".join(stated))]


def _over_strides(side: Side) -> str:
    return tr("Left strides") if side is Side.LEFT else tr("Right strides")
