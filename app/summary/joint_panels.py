"""Charts of page one: both legs of a joint as on the screen, from a walk's facts and its headline."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from app.charts.axes import sign_in_words, title_in_words
from app.charts.marks import Deviation, HiddenCurve
from app.charts.stride_chart import Axis, StrideChart, StrideCurve, usual_range_deg
from app.summary import panels
from app.summary.conditions import Part
from app.summary.facts import Facts, joint_of
from app.summary.headline import Headline, headline_of
from app.summary.marks_on_curves import bracket_of, labels_of
from app.summary.report_dates import date_of
from app.summary.request import AnalysedVisit
from app.summary.visits import by_condition
from app.summary.walk_figures import why_in_figures
from app.wording.body import name_of
from app.wording.translation import capitalised
from core.body import JointKind, Side


def joint_chart(facts: Facts, kind: JointKind, headline: Headline, thin: Part | None) -> StrideChart:
    """Both legs of a joint as on the screen: values at peaks, the headline's bracket, an earlier visit thin."""
    sides = [side for side in Side if facts.is_measured(joint_of(kind, side))]
    curves = tuple(panels.curve_of(facts, side, kind) for side in sides)
    bracket = bracket_of(facts, headline)
    brackets = (_lowered(facts, bracket),) if bracket is not None and bracket.kind is kind else ()
    hidden = [side for side in sides if panels.why_not_reported(facts, joint_of(kind, side))]
    alt = [panels.curve_alt(facts, kind, [side for side in sides if side not in hidden])]
    alt += [
        f"{capitalised(name_of(joint_of(kind, side)))}: {panels.why_not_reported(facts, joint_of(kind, side))}"
        for side in hidden
    ]
    return StrideChart(
        title=title_in_words(kind) if not facts.has_no_zero(kind) else panels.narrow_title(facts, kind),
        sign=sign_in_words(kind),
        axis=Axis(*usual_range_deg(kind, is_about_mean=facts.has_no_zero(kind)), 20, 10),
        curves=tuple(curve for curve in curves if curve.side not in hidden),
        band=panels.band_of(facts, kind, sides),
        is_simulated=facts.is_simulated,
        beside=_thin_curves(facts, kind, thin),
        alt=" ".join(alt),
        deviations=brackets,
        labels=() if facts.has_no_zero(kind) else tuple(labels_of(facts, kind)),
        hidden=tuple(HiddenCurve(side, why_in_figures(facts.verdicts.joint(joint_of(kind, side)))) for side in hidden),
    )


def thin_part(facts: Facts, visits: Sequence[AnalysedVisit]) -> Part | None:
    """Give the condition at the earlier visit of the headline, whose curves are drawn thin; None without one."""
    since = headline_of(facts).since
    for visit in reversed(visits) if since is not None else ():
        if since is not None and date_of(visit.session.started) == since.day:
            walked = by_condition(visit.analysis, visit.session.recordings).get(facts.condition)
            return replace(walked, day=since.day) if walked is not None else None
    return None


def _lowered(facts: Facts, bracket: Deviation) -> Deviation:
    """At the height of a curve that is drawn about its mean."""
    side, kind = bracket.first.joint.side, bracket.kind
    height_deg = float(facts.measured_curve_deg(side, kind)[0] - facts.mean_curve_deg(side, kind)[0])
    return replace(bracket, first=bracket.first.lowered(height_deg), second=bracket.second.lowered(height_deg))


def _thin_curves(facts: Facts, kind: JointKind, thin: Part | None) -> tuple[StrideCurve, ...]:
    """The affected leg's, else both, where today's is drawn beside it from the same kind of zero; named by the day."""
    sides = (facts.affected,) if facts.affected is not None else tuple(Side)
    is_about_mean, found = facts.has_no_zero(kind), []
    for side in sides:
        joint = joint_of(kind, side)
        if thin is None or joint not in thin.joints or not thin.is_drawn(joint):
            continue
        is_alike = is_about_mean or (
            thin.zero(joint) is facts.part.zero(joint) and thin.verdicts.joint(joint).height.is_reported
        )
        if is_alike and np.isfinite(facts.mean_curve_deg(side, kind)).any():
            found.append(replace(thin.curve(joint, is_about_mean=is_about_mean), letter=thin.short_name, side=side))
    return tuple(found)
