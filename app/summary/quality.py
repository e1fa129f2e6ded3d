"""Parts of this recording that can be read.

The walk's verdicts as a table, the gravest reasons, and what they rest on.
"""

import math
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

from app.summary.facts import Facts
from app.summary.numbers_in_words import NOTHING, fixed
from app.wording.body import name_of, side_name
from app.wording.findings import NAMES
from app.wording.translation import capitalised, joined, tr, within_sentence
from app.wording.verdicts import GateWords, gate_words
from core.body import Joint, Side, Site, hip_of
from core.findings import Finding
from core.gait.strides import Reason
from core.results import JointCalibration, Method, ZeroKind
from core.verdicts.model import GateReason, Verdict, Verdicts, worst
from core.verdicts.quality import MIN_LOSS_PERCENT

MAX_SENTENCES = 3  # more would push a page over its foot
HEIGHT_GATES = ("zero", "plausible_height")  # these leave the shape alone
ABDUCTION_GATES = ("hip_heading",)  # and these all but abduction
Place = Joint | Side | None
"""What a reason is about: a joint, a leg, or what lies between both legs."""


def caveats(
    facts: Facts, of: Iterable[Verdict] = (Verdict.NOT_REPORTED, Verdict.CARE), *, is_of_joints: bool = False
) -> list[str]:
    """Give why something is not reported or read with care, gravest first; `is_of_joints`: joint angles only."""
    if not facts.gait:
        return [tr("No foot or shank sensor showed a stride.")]
    return [f"{one.where}: {one.stated}" for one in causes(facts, of, is_of_joints=is_of_joints)]


@dataclass(frozen=True, slots=True)
class Cause:
    """Why something is not reported, or is read with care, stated once for every place of which it holds alike.

    `where` names the places, `gate` is that of `core.verdicts.gates`.
    """

    gate: str
    verdict: Verdict
    places: tuple[Place, ...]
    where: str
    words: GateWords

    @property
    def is_aside(self) -> bool:
        """Whether each leg can be read: it is about instants of both legs alone, or about a hip's abduction."""
        return set(self.places) == {None} or self.gate in ABDUCTION_GATES

    @property
    def stated(self) -> str:
        return " ".join(filter(None, self.words))


def causes(
    facts: Facts, of: Iterable[Verdict] = (Verdict.NOT_REPORTED, Verdict.CARE), *, is_of_joints: bool = False
) -> list[Cause]:
    """Give each reason of a walk with one of these verdicts, in order; `is_of_joints`: joint angles only."""
    places: dict[tuple[str, GateWords], dict[Place, Verdict]] = {}
    for place, reason in _reasons(facts.verdicts):
        if isinstance(place, Joint) or not is_of_joints:
            known = places.setdefault((reason.gate, gate_words(reason)), {})
            known[place] = worst((reason.verdict, known.get(place, Verdict.READ)))
    required, found = list(of), []
    for (gate, words), known in places.items():
        gravest = worst(known.values())
        # what one reason withholds names it; what it leaves to be read with care beside that is in the table
        where = tuple(place for place, verdict in known.items() if verdict is gravest)
        if gravest in required:
            found.append(Cause(gate, gravest, where, _named(gate, _where(facts, where)), words))
    return sorted(found, key=lambda one: required.index(one.verdict))


def _reasons(verdicts: Verdicts) -> Iterator[tuple[Place, GateReason]]:
    for joint, found in verdicts.joints.items():
        yield from ((joint, reason) for part in (found.shape, found.height, found.sign) for reason in part.reasons)
    for side, leg in verdicts.legs.items():
        yield from ((side, reason) for part in (leg.timing, leg.distance) for reason in part.reasons)
    for side, abduction in verdicts.abduction.items():
        if verdicts.joint(hip_of(side)).shape.verdict is Verdict.NOT_REPORTED:
            continue  # with the hip, whose own reason is reported
        yield from ((hip_of(side), reason) for reason in abduction.reasons)
    yield from ((None, reason) for reason in verdicts.between.reasons)


def _named(gate: str, where: str) -> str:
    """What of a place a gate is about, where that is not all of it."""
    inside = within_sentence(where)
    if gate in HEIGHT_GATES:
        return tr("Absolute angle of {joints}").format(joints=inside)
    if gate in ABDUCTION_GATES:
        return tr("Abduction of {joints}").format(joints=inside)
    return tr("All values of {joints} except range of motion").format(joints=inside) if gate == "sign" else where


def _where(facts: Facts, places: Sequence[Place]) -> str:
    """Name the places of a reason: a leg represents its joints, both legs for all."""
    sides = [side for side in Side if side in places]
    joints = [joint for joint in places if isinstance(joint, Joint) and joint.side not in sides]
    if not sides and not joints:
        return tr("Timing between the legs")
    if len(sides) == len(Side) and not joints:
        return tr("Both legs")
    if not sides and len(joints) > 1 and len(joints) == len(facts.verdicts.joints):
        return tr("All joints")
    legs = [tr("{side} leg").format(side=side_name(side)) for side in sides]
    return capitalised(joined([*legs, *(name_of(joint) for joint in joints)]))


def cells(facts: Facts) -> list[tuple[str, str]]:
    """What the verdicts rest on, as label and value."""
    return [
        (tr("Strides used"), _each(facts, lambda side: str(facts.strides(side)))),
        (tr("Excluded"), _left_out(facts)),
        (tr("Samples lost"), _loss_in_words(facts)),
        (tr("Joint axes, ±1 SD"), _axes(facts)),
        (tr("Sensor clock lag"), _lag(facts)),
        (tr("Standing reference"), _zero(facts)),
        (tr("Straps"), _straps(facts)),
    ]


def _without_lag(facts: Facts) -> list[Joint]:
    """Joints whose motion does not distinguish a lag from none, so that "none found" would say too much."""

    def is_unknown(found: JointCalibration) -> bool:
        return found.method is Method.ROBUST and found.lag_sd_s is None and not found.is_clock_shared

    return [joint for joint, found in facts.calibrated.items() if is_unknown(found)]


def _each(facts: Facts, stated: Callable[[Side], str]) -> str:
    parts = [f"{side.letter}\u00a0{stated(side)}" for side in Side if side in facts.gait]
    return ", ".join(parts) or tr("not measured")


def _left_out(facts: Facts) -> str:
    """How many strides of each leg were left out for each reason."""
    parts = []
    for side in facts.part.sides:
        out = Counter({one: count for one, count in facts.part.reasons(side).items() if one is not Reason.USED})
        if out:
            each = [f"{count}\u00a0{tr(NAMES['reason'][reason])}" for reason, count in out.most_common()]
            parts.append(f"{side.letter}\u00a0{', '.join(each)}")
    return "; ".join(parts) or tr("none")


def _about_walk(facts: Facts) -> list[Finding]:
    names = {walk.name for walk in facts.part.walks}
    return [f for f in facts.visit.analysis.findings if not names.isdisjoint(f.where.split(", "))]


def _site_of(finding: Finding) -> Site | None:
    sites = [part for part in finding.where.split(", ") if part in set(Site)]
    return Site(sites[0]) if sites else None


def _loss_in_words(facts: Facts) -> str:
    lost = [one for walk in facts.part.walks for one in walk.lost_percent.items()]
    worst_site = max(lost, key=lambda loss: loss[1], default=None)
    if worst_site is None or worst_site[1] < MIN_LOSS_PERCENT:
        return tr("under {percent} %").format(percent=fixed(MIN_LOSS_PERCENT, 1))
    return f"{fixed(worst_site[1], 1)} % ({name_of(worst_site[0])})"


def _lag(facts: Facts) -> str:
    if not facts.calibrated:
        return NOTHING
    if all(found.is_clock_shared for found in facts.calibrated.values()):
        return tr("none: same clock")
    not_reported = _without_lag(facts)
    if len(not_reported) == len(facts.calibrated):
        return tr("not determinable")
    if not_reported:
        return tr("not determinable at the {joints}").format(joints=joined([name_of(joint) for joint in not_reported]))
    worst_ms = max(abs(found.lag_s) for found in facts.calibrated.values()) * 1000
    return tr("{lag} ms, corrected").format(lag=fixed(worst_ms, 1)) if round(worst_ms, 1) else tr("none found")


def _axes(facts: Facts) -> str:
    found = [one.axis_sd_rad for one in facts.calibrated.values() if one.axis_sd_rad is not None]
    if not found:
        return tr("not measured")
    low, high = (fixed(math.degrees(one), 1) for one in (min(found), max(found)))
    return f"{low}°" if low == high else f"{low}–{high}°"


def _zero(facts: Facts) -> str:
    kinds = {found.zero for found in facts.calibrated.values()}
    stated = {
        ZeroKind.STANDING: tr("posture"),
        ZeroKind.GONIOMETER: tr("posture, with goniometer value"),
        ZeroKind.NONE: tr("none: no absolute angles"),
    }
    if not kinds:
        return NOTHING
    if len(kinds) == 1:
        return stated[kinds.pop()]
    if ZeroKind.NONE in kinds:
        joints = [name_of(joint) for joint, found in facts.calibrated.items() if found.zero is ZeroKind.NONE]
        return tr("none for the {joints}").format(joints=joined(joints))
    joints = [name_of(joint) for joint, found in facts.calibrated.items() if found.zero is ZeroKind.GONIOMETER]
    return tr("posture; goniometer value for the {joints}").format(joints=joined(joints))


def slipped_straps(facts: Facts) -> list[Site]:
    """Sensors whose strap slipped in this walk."""
    sites = [_site_of(finding) for finding in _about_walk(facts) if finding.key == "strap_slipped"]
    return list(dict.fromkeys(site for site in sites if site is not None))


def _straps(facts: Facts) -> str:
    names = [name_of(site) for site in slipped_straps(facts)]
    return tr("moved: {sites}").format(sites=joined(names)) if names else tr("none moved")
