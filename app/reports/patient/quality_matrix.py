"""What may be read of a walk, joint by joint and leg by leg, and what the verdicts rest on."""

from app.reports.blocks import Block, Cell, Column, Row, heading, note, table
from app.summary import quality
from app.summary.facts import Facts, joint_of
from app.summary.panels import dot
from app.wording.body import name_of, side_name
from app.wording.translation import capitalised, tr
from app.wording.verdicts import verdict_alone, verdict_word
from core.body import Side
from core.verdicts.model import Verdict, worst


def quality_matrix(facts: Facts) -> list[Block]:
    """A row for each joint that was measured, else for each leg; then what holds of both legs, and the data used."""
    joints = [joint_of(kind, side) for kind in facts.kinds for side in Side if facts.is_measured(joint_of(kind, side))]
    columns = [Column("", "1fr", is_number=False), Column(tr("Timing"), "32mm", is_number=False)]
    rows: list[Row] = [
        [capitalised(tr("{side} leg").format(side=side_name(side))), _dotted(facts.verdicts.leg(side).timing.verdict)]
        for side in facts.gait
    ]
    if joints:
        titles = tr("ROM, shape"), tr("Absolute angle"), tr("Timing")
        columns = [columns[0], *(Column(title, "32mm", is_number=False) for title in titles)]
        rows = [
            [
                capitalised(name_of(joint)),
                *(
                    _dotted(one.verdict)
                    for one in (facts.verdicts.joint(joint).shape, facts.verdicts.joint(joint).height)
                ),
                _dotted(facts.verdicts.leg(joint.side).timing.verdict),
            ]
            for joint in joints
        ]
    wide: list[tuple[str, Verdict]] = []
    if len(facts.gait) == len(Side):
        wide.append((tr("Left vs right"), facts.verdicts.between.verdict))
    if facts.gait:
        wide.append((tr("Distance"), worst(facts.verdicts.leg(side).distance.verdict for side in facts.gait)))
    both = [f"{label}: {verdict_word(verdict)}." for label, verdict in wide]
    used = "; ".join(f"{label}: {value}" for label, value in quality.cells(facts))
    return [
        {**heading(tr("Data quality")), "label": "quality"},
        *([table(columns, rows, is_dense=True)] if rows else []),
        note(" ".join([*both, f"{tr('Data used')}: {used}."])),
    ]


def _dotted(verdict: Verdict) -> Cell:
    return Cell(verdict_alone(verdict), picture=dot(verdict))
