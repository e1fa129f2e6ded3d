"""The agreement as a PDF: Table 1, the further figures, Figures 8 and 9, and what they do not show."""

import math
from collections.abc import Mapping
from datetime import datetime
from functools import partial
from importlib.resources import files
from typing import Any

from app.charts.drawing import Picture
from app.reports.agreement.pictures import FIGURES, caption
from app.reports.agreement.printed import (
    KINDS,
    clock_words,
    dagger_words,
    events_words,
    figures_of_table_1,
    optical_words,
    other_angles_words,
    rows_of_table_1,
    source_words,
    used_words,
    verdict_words,
)
from app.reports.agreement.study import AgreementStudy, AngleKind
from app.reports.agreement.tables import events_together, lengths_together
from app.reports.blocks import (
    Block,
    Cell,
    Column,
    Row,
    bullets,
    figures,
    heading,
    note,
    paragraph,
    table,
)
from app.reports.patient.document import CODE_LENGTH, PAGES, draw_pages, foot, set_pages
from app.summary.numbers_in_words import fixed, signed
from app.summary.plain_text import isolated, plain, shortened, typed
from app.summary.report_dates import day
from app.wording.translation import later, spoken_language, tr
from core.agreement.figures import NAMED_PHASES, Agreement
from core.body import JointKind
from core.gait.phases import Phase
from core.session import Patient, Session

TEMPLATE = files("resources") / "report" / "agreement.typ"
NAME_LENGTH, SENTENCE_LENGTH = 40, 400
OVER_TIME = {
    JointKind.KNEE: later("Knee while walking"),
    JointKind.ANKLE: later("Ankle while walking"),
    JointKind.HIP: later("Hip while walking"),
}


def agreement_report(
    study: AgreementStudy, session: Session, pictures: Mapping[str, Picture], made_at: datetime, version: str
) -> bytes:
    """Make the agreement's PDF. The same study gives the same bytes."""
    return set_pages(PAGES.read_bytes() + TEMPLATE.read_bytes(), _data(study, session, pictures, version), made_at)


def agreement_pages(
    study: AgreementStudy,
    session: Session,
    pictures: Mapping[str, Picture],
    made_at: datetime,
    version: str,
    ppi: float,
) -> list[bytes]:
    """The same pages as PNG, of so many px an inch."""
    template = PAGES.read_bytes() + TEMPLATE.read_bytes()
    return draw_pages(template, _data(study, session, pictures, version), made_at, ppi)


def _data(study: AgreementStudy, session: Session, pictures: Mapping[str, Picture], version: str) -> dict[str, Any]:
    code = isolated(shortened(plain(session.patient.code), CODE_LENGTH)) or tr("no patient code")
    recorded = day(session.started) if session.started else ""
    return {
        "paper": "a4",
        "language": spoken_language(),
        "title": tr("Agreement with a reference"),
        "subject": tr(
            "Joint angles from inertial sensors, compared with an optical system. Research use. Not a medical device."
        ),
        "head": {
            "brand": "Gaitwright",
            "kind": tr("Agreement"),
            "simulated": tr("SIMULATED DATA, not a person") if study.is_simulated else "",
            "code": code,
            "date": recorded,
        },
        "foot": foot(version),
        "pages": _pages(study, session.patient, pictures),
    }


def _pages(study: AgreementStudy, patient: Patient, pictures: Mapping[str, Picture]) -> list[list[Block]]:
    first: list[Block] = [heading(tr("Agreement with a reference"))]
    first.append(paragraph(_what_was_compared(study)))
    if study.with_angles:
        for mark, title, of_walk, of_all in figures_of_table_1():
            first += [heading(f"{mark}: {title}", 2), _table_1(study, patient, of_walk, of_all)]
        first += [heading(tr("All walks together"), 2), _over_walks(study, patient)]
        stated = [*source_words(study), *other_angles_words(study), *used_words(study)]
        first += [note(" ".join(typed(one, SENTENCE_LENGTH) for one in stated))]
        if any(walk.recording.gait for walk in study.with_angles):
            first += [heading(tr("Error by gait phase: RMSE in degrees, mean of each walk removed"), 2)]
            first += [_phases(study, patient)]
    if events_together(study) or len(lengths_together(study)):
        decimals = partial(fixed, decimals=1), partial(signed, decimals=2), partial(fixed, decimals=2)
        events = events_words(study, *decimals)
        first += [heading(tr("Events and strides"), 2), bullets(list(events))]
    if not_reported := verdict_words(study):
        first += [bullets([typed(stated, SENTENCE_LENGTH) for stated in not_reported])]
    if study.with_angles:
        clocks = [typed(clock_words(walk), SENTENCE_LENGTH) for walk in study.with_angles]
        first += [heading(tr("Time offsets and signs"), 2), bullets(clocks)]
        first += [paragraph(optical_words()), note(f"{dagger_words()} {_what_is_not_shown()}")]
    drawn = [(name, kind) for kind, name in FIGURES.items() if name in pictures]
    more: list[list[Block]] = [
        [
            heading(tr(OVER_TIME[kind])),
            figures([pictures[name]]),
            note(caption(study, kind)),
        ]
        for name, kind in drawn
    ]
    return [first, *more]


def _what_was_compared(study: AgreementStudy) -> str:
    names = dict.fromkeys(walk.reference.file for walk in study.walks if walk.reference is not None)
    stated = tr(
        "Difference: measured value minus reference value. Reference: {files}. Walks, numbered as below: {walks}."
    ).format(
        files=", ".join(typed(name, NAME_LENGTH) for name in names),
        walks=", ".join(f"{k} {typed(w.recording.name, NAME_LENGTH)}" for k, w in enumerate(study.walks, 1)),
    )
    if study.left_over:
        left = ", ".join(typed(name, NAME_LENGTH) for name in study.left_over)
        stated += " " + tr("Not compared, no matching recording: {names}.").format(names=left)
    return stated


def _table_1(study: AgreementStudy, patient: Patient, of_walk: Any, of_all: Any) -> Block:
    walks = study.with_angles
    columns = [Column("", is_number=False), Column("", "1fr", is_number=False)]
    columns += [*(Column(str(k)) for k in range(1, len(walks) + 1)), Column(tr("SD")), Column(tr("Mean"))]
    rows: list[Row] = []
    for joint, role in rows_of_table_1(study, patient):
        over = study.over_walks(joint)
        assert over is not None  # the joint is there because a walk has it
        found = [walk.figures.get((joint, AngleKind.RESULT)) for walk in walks]
        cells = [fixed(None if one is None else math.degrees(of_walk(one)), 2) for one in found]
        rows.append(
            [
                tr(KINDS[joint.kind]),
                role,
                *cells,
                fixed(math.degrees(of_all(over)), 2),
                Cell(fixed(math.degrees(of_walk(over.whole)), 2), is_bold=True),
            ]
        )
    return table(columns, rows, is_dense=True)


def _over_walks(study: AgreementStudy, patient: Patient) -> Block:
    heads = (tr("Bias, °"), tr("SD, °"), tr("Limits of agreement, °"), tr("r"), tr("ROM error, °"), tr("Within 1 SD"))
    columns = [Column("", is_number=False), Column("", "1fr", is_number=False)]
    columns += [*map(Column, heads), Column(tr("Within 2 SD"))]
    rows: list[Row] = []
    for joint, role in rows_of_table_1(study, patient):
        over = study.over_walks(joint)
        assert over is not None  # as above
        found = over.whole
        shares = [
            f"{100 * s:.0f} %" if math.isfinite(s) else fixed(None, 0) for s in (found.within_1_sd, found.within_2_sd)
        ]
        rows.append(
            [
                tr(KINDS[joint.kind]),
                role,
                signed(math.degrees(found.bias_rad), 2),
                fixed(math.degrees(found.sd_rad), 2),
                f"{signed(math.degrees(found.low_rad), 1)}, {signed(math.degrees(found.high_rad), 1)}",
                fixed(found.correlation, 3),
                _range(found),
                *shares,
            ]
        )
    return table(columns, rows, is_dense=True)


def _range(found: Agreement) -> str:
    mean = signed(math.degrees(found.range_error_rad), 1)
    return f"{mean} ± {fixed(math.degrees(found.range_error_sd_rad), 1)}" if found.ranges > 1 else mean


def _phases(study: AgreementStudy, patient: Patient) -> Block:
    names = {
        Phase.LOADING: tr("Loading"),
        Phase.FOOT_FLAT: tr("Foot flat"),
        Phase.PRE_SWING: tr("Pre-swing"),
        Phase.SWING: tr("Swing"),
    }
    columns = [
        Column("", is_number=False),
        Column("", "1fr", is_number=False),
        *(Column(names[p]) for p in NAMED_PHASES),
    ]
    rows: list[Row] = []
    for joint, role in rows_of_table_1(study, patient):
        over = study.over_walks(joint)
        assert over is not None  # as above
        errors = [over.whole.in_phases((phase,)) for phase in NAMED_PHASES]
        cells = [fixed(math.degrees(error.rms_rad), 2) for error in errors]
        rows.append([tr(KINDS[joint.kind]), role, *cells])
    return table(columns, rows, is_dense=True)


def _what_is_not_shown() -> str:
    return tr(
        "Z is the RMSE as measured. It includes the difference between the zero angles of both "
        "systems. M is the RMSE with the mean removed. SD in both tables is the SD between walks (n − "
        "1), as in Table 1 of Seel, Raisch and Schauer 2014, doi 10.3390/s140406891. Limits of "
        "agreement: bias ± 1.96 SD within and between walks. The stated SD applies to the curve "
        "shape, not to the zero angle. Time offset and sign were found from the angular rates of the "
        "same angles. A delay common to all joints is therefore not included in these errors."
    )
