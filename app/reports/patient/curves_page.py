"""All curves as measured, both legs over one another, and the table of movements and angles below them."""

from app.charts.drawing import MM, Picture
from app.charts.on_paper import draw
from app.charts.stride_chart import StrideChart
from app.reports.blocks import Block, figures, heading, if_room, note, paragraph
from app.reports.patient.definitions import definitions
from app.reports.patient.peaks_table import peaks_table
from app.summary import panels
from app.summary.facts import KINDS, Facts, joint_of
from app.wording.translation import tr
from core.body import JointKind, Side

PLOT_WIDTH, WITH_HIP_WIDTH = 72 * MM, 44 * MM  # two beside each other, or three


def curves_page(facts: Facts) -> list[Block]:
    kinds = [kind for kind in facts.kinds if facts.has_joint(kind)]
    missing = [panels.why_no_joint(facts, kind) for kind in facts.kinds if kind not in kinds]
    stated = " ".join(
        [
            tr(
                "As measured, with absolute angles; each leg over its own gait cycle. Axes are the same in "
                "every report."
            ),
            panels.band_in_words(facts, has_hips=JointKind.HIP in facts.kinds),
            *(words for kind in kinds for words in panels.not_drawn(facts, kind)),
        ]
    )
    width = WITH_HIP_WIDTH if JointKind.HIP in kinds else PLOT_WIDTH
    drawn = [_overlay(facts, kind, width) for kind in kinds]
    return [
        heading(tr("All curves and peaks")),
        note(stated.strip()),
        *([figures(drawn, columns=max(2, len(drawn)))] if drawn else []),
        *(paragraph(words) for words in missing),
        *peaks_table(facts),
        *(_where_measured(kinds) if set(KINDS) & set(kinds) else []),
    ]


def _overlay(facts: Facts, kind: JointKind, width: float) -> Picture:
    sides = [side for side in Side if facts.is_measured(joint_of(kind, side))]
    chart = StrideChart(
        title=panels.title_of(facts, kind) if width == PLOT_WIDTH else panels.narrow_title(facts, kind),
        axis=panels.axis_of(facts, kind),
        curves=tuple(panels.curve_of(facts, side, kind) for side in sides),
        band=panels.band_of(facts, kind, sides),
        is_simulated=facts.is_simulated,
        alt=panels.curve_alt(facts, kind, sides),
        not_reported=_not_reported(facts, kind, sides),
    )
    return draw(chart, width)


def _not_reported(facts: Facts, kind: JointKind, sides: list[Side]) -> str:
    """Why nothing is drawn, where no leg has a curve or a stride that may be."""
    whys = [panels.why_not_reported(facts, joint_of(kind, side)) for side in sides]
    return " ".join(dict.fromkeys(whys)) if all(whys) else ""


def _where_measured(kinds: list[JointKind]) -> list[Block]:
    """The table's movements are seen, not only read; where the page has room. A hip has none but its range."""
    title = heading(tr("Where values are measured"), level=2)
    return [if_room([title, figures([definitions(kind) for kind in kinds if kind in KINDS], columns=2)])]
