"""All curves as measured, both legs over one another, and the table of movements and angles below them."""

from app.charts.drawing import MM, Picture
from app.charts.on_paper import draw
from app.charts.stride_chart import StrideChart
from app.reports.patient_report import panels
from app.reports.patient_report.blocks import Block, figures, heading, if_room, note, paragraph
from app.reports.patient_report.definitions import definitions
from app.reports.patient_report.facts import KINDS, Facts, joint_of
from app.reports.patient_report.peaks_table import peaks_table
from app.wording import tr
from core.body import Side

PLOT_WIDTH = 72 * MM


def curves_page(facts: Facts) -> list[Block]:
    kinds = [kind for kind in KINDS if facts.has_joint(kind)]
    missing = [panels.why_no_joint(facts, kind) for kind in KINDS if kind not in kinds]
    said = " ".join(
        [
            tr("As measured, heights included; each leg on its own stride. Axes are the same in every report."),
            panels.band_in_words(facts, is_at_height=False),
            *(words for kind in kinds for words in panels.not_drawn(facts, kind)),
        ]
    )
    drawn = [_overlay(facts, kind) for kind in kinds]
    return [
        heading(tr("All curves and peaks")),
        note(said.strip()),
        *([figures(drawn, columns=2)] if drawn else []),
        *(paragraph(words) for words in missing),
        *peaks_table(facts),
        *(_where_measured(kinds) if kinds else []),
    ]


def _overlay(facts: Facts, kind: str) -> Picture:
    sides = [side for side in Side if facts.is_measured(joint_of(kind, side))]
    chart = StrideChart(
        title=panels.title_of(facts, kind),
        axis=panels.axis_of(facts, kind),
        curves=tuple(panels.curve_of(facts, side, kind) for side in sides),
        band=panels.band_of(facts, kind, sides),
        is_simulated=facts.is_simulated,
        alt=panels.curve_alt(facts, kind, sides),
        withheld=_withheld(facts, kind, sides),
    )
    return draw(chart, PLOT_WIDTH)


def _withheld(facts: Facts, kind: str, sides: list[Side]) -> str:
    """Why nothing is drawn, where no leg has a curve or a stride that may be."""
    whys = [panels.why_withheld(facts, joint_of(kind, side)) for side in sides]
    return " ".join(dict.fromkeys(whys)) if all(whys) else ""


def _where_measured(kinds: list[str]) -> list[Block]:
    """The table's movements are seen, not only read; where the page has room."""
    title = heading(tr("What is measured where"), level=2)
    return [if_room([title, figures([definitions(kind) for kind in kinds], columns=2)])]
