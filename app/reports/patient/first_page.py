"""The page usable alone: who, what differs, what may be read, every joint's curve, a few numbers, how sure."""

import math

from app.charts.cycles import is_mean_enough, is_spread_enough
from app.charts.drawing import MM, Picture
from app.charts.on_paper import draw
from app.reports.patient.key_numbers import key_numbers
from app.reports.patient.key_strips import height_scale
from app.summary import panels, quality
from app.summary.comparison import Comparison
from app.summary.conditions import by_hand_in_words
from app.summary.facts import Facts, joint_of
from app.summary.goals import goal_sentence
from app.summary.marks_on_curves import brackets_of
from app.summary.numbers_in_words import fixed, signed
from app.summary.panels import band_in_words, dot
from app.summary.plain_text import CONDITION_LENGTH, typed
from app.summary.report_dates import moment
from app.summary.request import ReportRequest
from app.summary.what_stands_out import MAX_AWAY_SD, caveat, nothing_found, printed_findings
from app.wording.body import name_of, side_name
from app.wording.patients import aids_in_words
from app.wording.recordings import name_in_words
from app.wording.translation import capitalised, figure_text, joined, tr, tr_n
from app.wording.verdicts import verdict_alone
from core.body import Joint, JointKind, Side
from core.parameters import KNEE
from core.verdicts.model import Assessment, Verdict, worst
from core.verdicts.quantities import EXCURSIONS_BY_COLUMN, WINDOWS

NOT_STATED = ("", "none")
HEADLINES = {JointKind.KNEE: KNEE}  # the figure that the course and the goals have as well
PLOT_WIDTH, ONE_LEG_WIDTH = 53 * MM, 68 * MM  # four panels, or two
WITH_HIP_WIDTH, ONE_LEG_WITH_HIP_WIDTH = 34 * MM, 50 * MM  # six, or three


def first_page(request: ReportRequest, facts: Facts, comparison: Comparison | None) -> dict[str, object]:
    """All that the template sets on page one, in the order it is read."""
    return {
        "who": who(request),
        "what": what(request, facts, comparison),
        "answer": answer(facts, comparison),
        "readable": readable(facts),
        "curves": curves(facts, comparison),
        "key_numbers": key_numbers(facts, comparison),
        "quality": {"title": tr("Data used"), "cells": [list(cell) for cell in quality.cells(facts)]},
    }


def who(request: ReportRequest) -> str:
    """Who was measured, as the clinic typed it; what nobody stated is left out."""
    session, patient = request.visit.session, request.visit.session.patient
    is_prosthetic = patient.prosthetic_side not in NOT_STATED
    side = patient.prosthetic_side if is_prosthetic else patient.affected_side
    known = [
        {"male": tr("Man"), "female": tr("Woman")}.get(patient.sex, patient.sex),
        tr("born {year}").format(year=patient.birth_year) if patient.birth_year is not None else "",
        f"{fixed(patient.height_m, 2)}\u00a0m" if patient.height_m is not None else "",
        f"{fixed(patient.mass_kg, 0)}\u00a0kg" if patient.mass_kg is not None else "",
        _side_in_words(side, is_prosthetic=is_prosthetic),
        patient.device,
        tr("no walking aids") if patient.aids == "none" else aids_in_words(patient.aids),
        session.surface,
    ]
    return " · ".join(typed(one) for one in known if one)


def what(request: ReportRequest, facts: Facts, comparison: Comparison | None) -> str:
    """What this report is of: joints and legs, the walk and when, by whom; and what is compared with what."""
    recording = request.visit.recording(facts.walk.name)
    shown = request.visit.shown_names
    walk = ", ".join(typed(str(shown.get(one.name, one.name)), CONDITION_LENGTH) for one in facts.part.walks)
    speed = facts.speed_m_s
    started = recording.started or request.visit.session.started
    operator, clinic = request.operator or request.visit.session.operator, request.clinic
    parts = [
        measured(facts),
        _sensors(request, facts),
        tr("walk: {walk}").format(walk=walk),
        f"{fixed(speed, 2)}\u00a0m/s" if math.isfinite(speed) else "",
        tr("recorded {moment}").format(moment=moment(started)) if started else "",
        tr("by {operator}").format(operator=typed(operator, CONDITION_LENGTH)) if operator else "",
        typed(clinic, CONDITION_LENGTH) if clinic else "",
    ]
    stated = [" · ".join(filter(None, parts))]
    if comparison is not None:
        called = [(part.letter, name_in_words(part.name)) for part in comparison.parts]
        names = " · ".join(f"{letter}\u00a0{typed(name, CONDITION_LENGTH)}" for letter, name in called)
        stated.append(
            tr("Compared: {parts} (this page shows {last})").format(parts=names, last=comparison.parts[-1].letter)
        )
    return ". ".join(stated)


def measured(facts: Facts) -> str:
    """The joints and legs that were measured."""
    joints = {side: [kind for kind in facts.kinds if facts.is_measured(joint_of(kind, side))] for side in facts.gait}
    names = {JointKind.HIP: tr("hip"), JointKind.KNEE: tr("knee"), JointKind.ANKLE: tr("ankle")}
    legs = (
        tr("both legs") if len(joints) > 1 else "".join(tr("the {side} leg").format(side=side_name(s)) for s in joints)
    )
    known = [name_of(joint_of(kind, side)) for side, kinds in joints.items() for kind in kinds]
    if not known:
        return capitalised(tr("steps"))
    if len({tuple(kinds) for kinds in joints.values()}) == 1:
        kinds = next(iter(joints.values()))
        return capitalised(tr("{joints} of {legs}").format(joints=joined([names[kind] for kind in kinds]), legs=legs))
    return capitalised(joined(known))


def answer(facts: Facts, comparison: Comparison | None) -> dict[str, object]:
    """At most three numbered findings and one caveat; without any, that there is none."""
    found = printed_findings(facts, comparison)
    sentences = [[str(number), one.stated, one.evidence] for number, one in enumerate(found, start=1)]
    if not found:
        first, *others = nothing_found(facts, comparison)
        sentences = [["", first, " ".join(others)]]
    goals = [stated for one in facts.reported_goals if (stated := goal_sentence(one))][:1]  # as on the screen
    grey = " ".join([*caveat(facts, comparison), *goals])
    return {"heading": tr("Summary"), "sentences": sentences, "caveats": [grey] if grey else []}


def readable(facts: Facts) -> dict[str, object]:
    """What may be read, joint by joint, and the gravest reason why something may not."""
    joints = [joint_of(kind, side) for kind in facts.kinds for side in Side if facts.is_measured(joint_of(kind, side))]
    head = ["", tr("ROM, shape"), tr("Absolute angle"), tr("Timing")]
    rows = [
        [
            {"said": capitalised(name_of(joint))},
            *map(_dotted, (facts.verdicts.joint(joint).shape, facts.verdicts.joint(joint).height)),
            _dotted(facts.verdicts.leg(joint.side).timing),
        ]
        for joint in joints
    ]
    if not joints:
        head = ["", tr("Timing")]
        rows = [
            [
                {"said": capitalised(tr("{side} leg").format(side=side_name(side)))},
                _dotted(facts.verdicts.leg(side).timing),
            ]
            for side in facts.gait
        ]
    wide: list[tuple[str, Verdict]] = (
        [(tr("Left vs right"), facts.verdicts.between.verdict)] if len(facts.gait) == len(Side) else []
    )
    if facts.gait:
        wide.append((tr("Distance"), worst(facts.verdicts.leg(side).distance.verdict for side in facts.gait)))
    return {
        "heading": tr("Data quality"),
        "head": head,
        "rows": rows,
        "wide": [[label, *_dot_and_word(verdict)] for label, verdict in wide],
        "notes": quality.gravest(facts),
    }


def _dotted(found: Assessment) -> dict[str, object]:
    picture, stated = _dot_and_word(found.verdict)
    return {"said": stated, "dot": picture}


def _dot_and_word(verdict: Verdict) -> tuple[dict[str, object], str]:
    return dot(verdict).as_data(), verdict_alone(verdict)


def curves(facts: Facts, comparison: Comparison | None) -> dict[str, object]:
    """A panel for each joint that was measured, the band laid at the height of its curve, with its figures beside."""
    counts = {side.letter: facts.strides(side) for side in facts.gait}
    stated = [
        tr(
            "Mean of strides, {counts}. Each leg is drawn over its own gait cycle; 0 and 100 % are initial contact."
        ).format(counts=", ".join(f"{letter} n = {n}" for letter, n in counts.items()))
        if counts
        else "",
        band_in_words(facts, is_at_height=True),
        by_hand_in_words(*facts.part.walks),
    ]
    shown = [joint_of(kind, side) for kind in facts.kinds for side in Side if facts.is_measured(joint_of(kind, side))]
    legs, has_hips = {joint.side for joint in shown}, JointKind.HIP in facts.kinds
    width = PLOT_WIDTH if len(legs) > 1 else ONE_LEG_WIDTH
    if has_hips:
        width = WITH_HIP_WIDTH if len(legs) > 1 else ONE_LEG_WITH_HIP_WIDTH
    brackets = brackets_of(facts, comparison)
    drawn = []
    for kind in facts.kinds if shown else ():
        for side in Side:
            joint = joint_of(kind, side)
            if joint in shown:
                chart = panels.leg_chart(facts, joint, brackets.get(joint))
                drawn.append({"picture": draw(chart, width).as_data(), "lines": _beside(facts, joint)})
            elif len(legs) > 1 or not any(one.kind is kind for one in shown):
                drawn += [{"said": panels.why_missing(facts, joint)}] if side in facts.gait or len(legs) > 1 else []
    return {
        "heading": tr("Hip, knee and ankle over the gait cycle")
        if has_hips
        else tr("Knee and ankle over the gait cycle"),
        "note": " ".join(filter(None, stated)),
        "columns": 2 if len(legs) > 1 else 1,
        "panels": drawn,
        "missing": [] if shown else [tr("No joint angle was measured.")],
    }


def _line(stated: str, style: str = "small", picture: Picture | None = None) -> dict[str, object]:
    return {"said": stated, "style": style, "picture": picture.as_data() if picture is not None else None}


def _beside(facts: Facts, joint: Joint) -> list[dict[str, object]]:
    """A joint's figures in the column beside its panel, or what to do where nothing of it may be read."""
    side, kind = joint.side, joint.kind
    column, verdicts = _headline(facts, joint), facts.verdicts.joint(joint)
    found = facts.value(side, column)
    if not verdicts.shape.is_reported or not is_mean_enough(found.n):
        return [_line(stated) for stated in quality.to_do(facts, joint)]
    name = capitalised(panels.excursion_name(column)) if column in EXCURSIONS_BY_COLUMN else tr("Range of motion")
    lines = [_line(name, "label"), _line(f"{fixed(found.mean, 1)}°", "value")]
    if is_spread_enough(found.n):
        lines.append(_line(tr("SD {sd}°").format(sd=fixed(found.sd, 1)), "grey"))
    lines.append(_line(verdict_alone(verdicts.shape.verdict), "small", dot(verdicts.shape.verdict)))
    lines += [_line(stated) for stated in _against_band(facts, joint)]
    lines.append(_line(tr("Absolute angle"), "label"))
    offset_deg = facts.offset_deg(side, kind)
    if math.isfinite(offset_deg):
        lines += [
            _line("", "picture", height_scale(offset_deg, side)),
            _line(tr("{offset}° vs reference").format(offset=signed(offset_deg, 1))),
            _line(tr("between labs ±7°"), "grey"),
        ]
    lines.append(_line(verdict_alone(verdicts.height.verdict), "small", dot(verdicts.height.verdict)))
    return lines


def _headline(facts: Facts, joint: Joint) -> str:
    """The column of a joint's first figure: a range where the joint has no excursion, or its sign is not known."""
    own = HEADLINES.get(joint.kind, "")
    return own if own and facts.value(joint.side, own).n else f"{joint.kind}_range_deg"


def _against_band(facts: Facts, joint: Joint) -> list[str]:
    """Which peaks lie beyond 2 SD of the band at the curve's height; where all could be judged and none does, that."""
    away = {column: facts.away_sd(joint.side, column) for column in WINDOWS if column.startswith(joint.kind)}
    judged = {column: sd for column, sd in away.items() if math.isfinite(sd)}
    beyond = [
        (
            tr("{peak}: over 2\N{NO-BREAK SPACE}SD below reference")
            if sd < 0
            else tr("{peak}: over 2\N{NO-BREAK SPACE}SD above reference")
        ).format(peak=capitalised(panels.peak_name(column)))
        for column, sd in judged.items()
        if abs(sd) > MAX_AWAY_SD
    ]
    return beyond or ([tr("peaks within 2\N{NO-BREAK SPACE}SD")] if judged else [])


def _sensors(request: ReportRequest, facts: Facts) -> str:
    worn = request.visit.recording(facts.walk.name).imu
    rates = {info.rate_hz for site, info in request.visit.session.sensors.items() if site in worn and info.rate_hz}
    models = {info.model for site, info in request.visit.session.sensors.items() if site in worn and info.model}
    count = tr_n("{count} motion sensor", "{count} motion sensors", len(worn)).format(count=len(worn))
    rate = [figure_text(rates.pop(), "g") + "\u00a0Hz"] if len(rates) == 1 else []
    return ", ".join([count, *rate, *sorted(typed(tr(model), 40) for model in models)])


def _side_in_words(side: str, *, is_prosthetic: bool) -> str:
    if side not in (*Side, "both"):
        return ""
    name = tr("both") if side == "both" else side_name(Side(side))
    pattern = tr("prosthetic side: {side}") if is_prosthetic else tr("affected side: {side}")
    return pattern.format(side=name)
