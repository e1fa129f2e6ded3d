"""Can this recording be read? A verdict, what it rests on, and what may still be read where it cannot all be."""

import math
from collections import Counter
from collections.abc import Callable, Iterator
from enum import IntEnum

import numpy as np

from app.reports.patient_report.facts import Facts, joint_of
from app.reports.patient_report.numbers_in_words import NOTHING, fixed
from app.reports.walk_figures import MAY_BE_MIRRORED, is_mean_enough, is_spread_enough
from app.wording import NAMES, capitalised, joined, name_of, side_name, tr, tr_n
from core.body import Joint, Side, Site
from core.calibration.certainty import AXIS_FLOOR_HINGE_RAD, AXIS_FLOOR_HUMAN_RAD, AXIS_FLOOR_WALKING_RAD
from core.findings import Finding
from core.gait.strides import Reason
from core.norms import MIN_STRIDES_FOR_MEAN, MIN_STRIDES_FOR_SD
from core.quality import MIN_LOSS_PERCENT
from core.results import AxisSource, JointCalibration, Method, ZeroKind

MAX_BEYOND_FLOOR_RAD = np.deg2rad(3.0)  # a proposal, as are the other limits
CARE_LOSS_PERCENT = 1.0
MAX_SENTENCES = 3  # more would push the first page over its foot


class Verdict(IntEnum):
    READABLE = 0
    WITH_CARE = 1
    NOT_READABLE = 2


def verdict_of(facts: Facts) -> tuple[Verdict, list[str]]:
    """Give the verdict and its reasons, the gravest first."""
    reasons = sorted(_reasons(facts), key=lambda reason: -reason[0])
    return (reasons[0][0] if reasons else Verdict.READABLE), [said for _, said in reasons]


def verdict_in_words(verdict: Verdict) -> str:
    return {
        Verdict.READABLE: tr("Quality of this recording: can be read"),
        Verdict.WITH_CARE: tr("Quality of this recording: read with care"),
        Verdict.NOT_READABLE: tr("Quality of this recording: do not read"),
    }[verdict]


def rows(facts: Facts) -> list[tuple[str, str]]:
    """What the verdict rests on, as label and value."""
    return [
        (tr("Strides used"), _each(facts, lambda side: str(facts.strides(side)))),
        (tr("Left out"), _left_out(facts)),
        (tr("Samples lost, worst sensor"), _loss_in_words(facts)),
        (tr("Lag between sensors, largest"), _lag(facts)),
        (tr("Certainty of joint axes (1 SD), knee"), _axes(facts, "knee")),
        (tr("Certainty of joint axes (1 SD), ankle"), _axes(facts, "ankle")),
        (tr("How zero was set"), _zero(facts)),
        (tr("Straps during the walk"), _straps(facts)),
    ]


def _reasons(facts: Facts) -> Iterator[tuple[Verdict, str]]:
    yield from _about_strides(facts)
    yield from _about_joints(facts)
    loss = _worst_loss(facts)
    if loss is not None and loss[1] >= CARE_LOSS_PERCENT:
        said = tr("{percent} % of the samples of the {site} sensor are lost: read single strides with care.")
        grave = any(f.key == "many_gaps" for f in _about_walk(facts))
        grade = Verdict.NOT_READABLE if grave else Verdict.WITH_CARE
        yield grade, said.format(percent=fixed(loss[1], 1), site=name_of(loss[0]))
    for finding in _about_walk(facts):
        if finding.key == "strap_slipped":
            site = _site_of(finding)
            said = tr("The strap of the {site} sensor slipped: this leg's later strides are left out.")
            yield Verdict.WITH_CARE, said.format(site=name_of(site) if site else NOTHING)


def _about_strides(facts: Facts) -> Iterator[tuple[Verdict, str]]:
    counts = {side: facts.strides(side) for side in facts.gait}
    if not counts:
        yield Verdict.NOT_READABLE, tr("No foot or shank sensor told a stride of this walk.")
        return
    few = {side: n for side, n in counts.items() if not is_mean_enough(n)}
    for side, n in few.items():
        said = tr_n("{side}: {count} stride; {wanted} are needed.", "{side}: {count} strides; {wanted} are needed.", n)
        yield (
            Verdict.NOT_READABLE,
            said.format(side=capitalised(side_name(side)), count=n, wanted=MIN_STRIDES_FOR_MEAN),
        )
    some = {side: n for side, n in counts.items() if side not in few and not is_spread_enough(n)}
    if some:
        said = tr("{counts} strides only: means stand in grey and without SD, for which {wanted} are needed.")
        each = joined([f"{side_name(side)} {n}" for side, n in some.items()])
        yield Verdict.WITH_CARE, capitalised(said.format(counts=each, wanted=MIN_STRIDES_FOR_SD))


def _about_joints(facts: Facts) -> Iterator[tuple[Verdict, str]]:
    worn = facts.visit.recording(facts.walk.name)
    missing = [joint for joint in Joint if worn.holds(joint.proximal, joint.distal) and joint not in facts.calibrated]
    if missing:
        said = tr("No axis was found for the {joints}: there is no angle.")
        yield Verdict.NOT_READABLE, said.format(joints=joined([name_of(joint) for joint in missing]))
    mirrored = [joint for joint in facts.calibrated if facts.doubt(joint) == MAY_BE_MIRRORED]
    if mirrored:
        said = tr("The motion does not tell flexion from extension of the {joints}: only range is shown.")
        yield Verdict.WITH_CARE, said.format(joints=joined([name_of(joint) for joint in mirrored]))
    for joint, found in facts.calibrated.items():
        if _is_weak(found):
            said = tr(
                "The axis of the {joint} is known to {axis_sd}° only{cause}: read it for timing and shape, "
                "not for its height."
            )
            walking = found.axis_source is AxisSource.WALKING
            cause = tr(" (from walking alone)") if walking else ""
            axis_sd = fixed(math.degrees(found.axis_sd_rad or math.nan), 1)
            yield Verdict.WITH_CARE, said.format(joint=name_of(joint), axis_sd=axis_sd, cause=cause)
    strangers = [joint for joint in facts.calibrated if _has_finding(facts, joint, "not_the_same_joint")]
    if strangers:
        said = tr("The two sensors of the {joints} do not move as neighbours: look whether they are worn as named.")
        yield Verdict.WITH_CARE, said.format(joints=joined([name_of(joint) for joint in strangers]))
    untold = [joint for joint in _without_lag(facts) if joint not in strangers]
    if untold:
        said = tr("The motion does not show how far the clocks at the {joints} are apart: peaks may come late.")
        yield Verdict.WITH_CARE, said.format(joints=joined([name_of(joint) for joint in untold]))
    without = [joint for joint, found in facts.calibrated.items() if found.zero is ZeroKind.NONE]
    if without:
        if len(without) == len(facts.calibrated):
            yield Verdict.WITH_CARE, tr("No zero was set: heights are not shown, only range, shape and timing.")
        else:
            said = tr("No zero was set for the {joints}: their heights are not shown.")
            yield Verdict.WITH_CARE, said.format(joints=joined([name_of(joint) for joint in without]))


def _has_finding(facts: Facts, joint: Joint, key: str) -> bool:
    return any(f.key == key and str(joint) in f.where.split(", ") for f in facts.visit.analysis.findings)


def _without_lag(facts: Facts) -> list[Joint]:
    """Joints whose motion does not tell a lag from none, so that "none found" would say too much."""
    calibrated = facts.calibrated.items()
    return [joint for joint, found in calibrated if found.method is Method.ROBUST and found.lag_sd_s is None]


def _is_weak(found: JointCalibration) -> bool:
    if found.axis_sd_rad is None:
        return True
    floor = AXIS_FLOOR_HUMAN_RAD
    if found.is_hinge:
        floor = AXIS_FLOOR_HINGE_RAD
    elif found.axis_source is AxisSource.WALKING:
        floor = AXIS_FLOOR_WALKING_RAD
    return bool(found.axis_sd_rad > floor + MAX_BEYOND_FLOOR_RAD)


def is_weak_axis(facts: Facts, joint: Joint) -> bool:
    """Whether a joint's values carry a mark in the tables."""
    return joint in facts.calibrated and _is_weak(facts.calibrated[joint])


def _each(facts: Facts, said: Callable[[Side], str]) -> str:
    parts = [f"{side[0].upper()}\u00a0{said(side)}" for side in Side if side in facts.gait]
    return ", ".join(parts) or tr("not measured")


def _left_out(facts: Facts) -> str:
    parts = []
    for side, gait in facts.gait.items():
        out = Counter(reason for reason in gait.strides.reason if reason is not Reason.USED)
        if out:
            commonest = tr(NAMES["reason"][out.most_common(1)[0][0]])
            words = commonest if len(out) == 1 else tr("mostly {reason}").format(reason=commonest)
            if len(out) > 1 and out[Reason.BY_HAND]:  # a choice is told also where other reasons are more
                words = tr("{count} of them by hand").format(count=out[Reason.BY_HAND])
            parts.append(f"{side[0].upper()}\u00a0{out.total()} ({words})")
    return ", ".join(parts) or tr("none")


def _about_walk(facts: Facts) -> list[Finding]:
    return [f for f in facts.visit.analysis.findings if facts.walk.name in f.where.split(", ")]


def _site_of(finding: Finding) -> Site | None:
    sites = [part for part in finding.where.split(", ") if part in set(Site)]
    return Site(sites[0]) if sites else None


def _worst_loss(facts: Facts) -> tuple[Site, float] | None:
    losses = []
    for finding in _about_walk(facts):
        site = _site_of(finding)
        if "missing_percent" in finding.numbers and site is not None:
            losses.append((float(finding.numbers["missing_percent"]), site))
    return max(((site, percent) for percent, site in losses), key=lambda loss: loss[1], default=None)


def _loss_in_words(facts: Facts) -> str:
    loss = _worst_loss(facts)
    if loss is None:
        return tr("under {percent} %").format(percent=fixed(MIN_LOSS_PERCENT, 1))
    return f"{fixed(loss[1], 1)} % ({name_of(loss[0])})"


def _lag(facts: Facts) -> str:
    if not facts.calibrated:
        return NOTHING
    untold = _without_lag(facts)
    if len(untold) == len(facts.calibrated):
        return tr("not resolvable")
    if untold:
        return tr("not resolvable at the {joints}").format(joints=joined([name_of(joint) for joint in untold]))
    worst_ms = max(abs(found.lag_s) for found in facts.calibrated.values()) * 1000
    return tr("{lag} ms, corrected").format(lag=fixed(worst_ms, 1)) if round(worst_ms, 1) else tr("none found")


def _axes(facts: Facts, kind: str) -> str:
    parts = []
    for side in Side:
        found = facts.calibrated.get(joint_of(kind, side))
        if found is not None and found.axis_sd_rad is not None:
            parts.append(f"{side[0].upper()}\u00a0{fixed(math.degrees(found.axis_sd_rad), 1)}°")
    return ", ".join(parts) or tr("not measured")


def _zero(facts: Facts) -> str:
    kinds = {found.zero for found in facts.calibrated.values()}
    said = {
        ZeroKind.STANDING: tr("standing"),
        ZeroKind.GONIOMETER: tr("standing, with goniometer"),
        ZeroKind.NONE: tr("none: heights are not shown"),
    }
    if not kinds:
        return NOTHING
    if len(kinds) == 1:
        return said[kinds.pop()]
    if ZeroKind.NONE in kinds:
        joints = [name_of(joint) for joint, found in facts.calibrated.items() if found.zero is ZeroKind.NONE]
        return tr("none for the {joints}").format(joints=joined(joints))
    joints = [name_of(joint) for joint, found in facts.calibrated.items() if found.zero is ZeroKind.GONIOMETER]
    return tr("standing; goniometer for the {joints}").format(joints=joined(joints))


def _straps(facts: Facts) -> str:
    sites = [_site_of(finding) for finding in _about_walk(facts) if finding.key == "strap_slipped"]
    names = [name_of(site) for site in sites if site is not None]
    return tr("slipped: {sites}").format(sites=joined(names)) if names else tr("no slip found")
