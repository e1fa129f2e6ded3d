"""What a report is of: joints and legs, sensors, the walk and when, by whom; and what is compared with what."""

import math

from app.summary.comparison import Comparison
from app.summary.facts import Facts, joint_of
from app.summary.numbers_in_words import fixed
from app.summary.plain_text import CONDITION_LENGTH, typed
from app.summary.report_dates import moment
from app.summary.request import ReportRequest
from app.wording.body import name_of, side_name
from app.wording.recordings import name_in_words
from app.wording.translation import capitalised, figure_text, joined, tr, tr_n
from core.body import JointKind


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
        stated.append(tr("Compared: {parts} (shown: {last})").format(parts=names, last=comparison.parts[-1].letter))
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


def _sensors(request: ReportRequest, facts: Facts) -> str:
    worn = request.visit.recording(facts.walk.name).imu
    rates = {info.rate_hz for site, info in request.visit.session.sensors.items() if site in worn and info.rate_hz}
    models = {info.model for site, info in request.visit.session.sensors.items() if site in worn and info.model}
    count = tr_n("{count} motion sensor", "{count} motion sensors", len(worn)).format(count=len(worn))
    rate = [figure_text(rates.pop(), "g") + "\u00a0Hz"] if len(rates) == 1 else []
    return ", ".join([count, *rate, *sorted(typed(tr(model), 40) for model in models)])
