"""Figures of a condition's walks that a clinician reads.

Peaks, ranges, time and distance are given beside those of a cited group.

The window and the report show the same rows, so that no number is in one that the other computes differently.
"""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from app.charts.cycles import SideCycle, is_mean_enough, is_spread_enough
from app.summary.conditions import Part
from app.wording.body import side_name
from app.wording.findings import NAMES
from app.wording.translation import capitalised, joined, later, tr, tr_n
from app.wording.verdicts import GateWords, gate_figures, gate_words
from core.body import Joint, JointKind, Side
from core.gait.cycles import find_peak, mean_cycle
from core.gait.spatiotemporal import MeanAndSd
from core.gait.strides import Reason
from core.parameters import ANKLE_WINDOWS, KNEE_WINDOWS
from core.verdicts.model import JointVerdicts, Verdict, worst
from core.verdicts.norms import MIN_STRIDES_FOR_MEAN, MIN_STRIDES_FOR_SD, ReferenceCurves, ReferenceValues


@dataclass(frozen=True, slots=True)
class Figure:
    """One row: a figure of each side, or one of both sides together, and the group's mean less and plus 1 SD.

    `column` is that of strides.csv, or the name in `BothFeet`. A side whose figure would say nothing is missing in
    `sides`, and `unknown` states why; `unknown_both` states it of a figure of both sides. `with_care` are the sides
    whose figure is to be read with care.
    """

    column: str
    name: str
    unit: str
    decimals: int
    sides: Mapping[Side, MeanAndSd]
    both: float | None = None
    band: tuple[float, float] | None = None
    unknown: Mapping[Side, str] = field(default_factory=dict)
    unknown_both: str = ""
    with_care: frozenset[Side] = frozenset()
    judged_band: tuple[float, float] | None = None


TwoBands = tuple[tuple[float, float] | None, tuple[float, float] | None]
"""Of a cited group as published, and as judged."""
NO_BANDS: TwoBands = (None, None)
PEAKS = (  # name of the column in strides.csv, name for the reader, window of the band's peak
    ("at_initial_contact_deg", later("At initial contact"), None),
    ("loading_peak_deg", later("Peak flexion, loading"), "knee_loading_peak"),
    ("stance_minimum_deg", later("Least flexion, stance"), "knee_stance_minimum"),
    ("swing_peak_deg", later("Peak flexion, swing"), "knee_swing_peak"),
    ("swing_peak_percent", later("Time of peak flexion in swing, %"), None),
    ("range_deg", later("Range of motion"), None),
    ("stance_dorsiflexion_deg", later("Peak dorsiflexion, stance"), "ankle_stance_dorsiflexion"),
    ("push_off_plantarflexion_deg", later("Peak plantarflexion, push-off"), "ankle_push_off_plantarflexion"),
    ("swing_dorsiflexion_deg", later("Peak dorsiflexion, swing"), "ankle_swing_dorsiflexion"),
)
KNEE_ROWS, ANKLE_ROWS = PEAKS[:6], (PEAKS[0], *PEAKS[6:], PEAKS[5])
HIP_ROWS = (
    ("range_deg", later("Range of motion"), None),
    ("flexion_peak_deg", later("Peak flexion"), None),
    ("extension_peak_deg", later("Peak extension"), None),
    ("abduction_range_deg", later("Abduction range of motion"), None),
    ("abduction_peak_deg", later("Peak abduction"), None),
    ("adduction_peak_deg", later("Peak adduction"), None),
)
ROWS = {JointKind.HIP: HIP_ROWS, JointKind.KNEE: KNEE_ROWS, JointKind.ANKLE: ANKLE_ROWS}
PELVIS_ROWS = (
    ("pelvis_obliquity_range_deg", later("Obliquity, range")),
    ("pelvis_drop_deg", later("Drop in swing")),
    ("pelvis_rotation_range_deg", later("Rotation, range")),
    ("pelvis_lean_deg", later("Mean tilt, forward +")),
    ("pelvis_tilt_range_deg", later("Tilt, range")),
)
NOT_REPORTED, MAY_BE_MIRRORED = later("not reported"), later("sign unclear")
NO_ZERO, NO_HEIGHT = later("no standing reference"), later("no absolute angle")


def strides_in_words(part: Part, side: Side) -> str:
    """How many strides stand behind the averages, and why the others do not."""
    used = part.strides(side)
    left_out: Counter[str] = Counter()
    for reason, count in part.reasons(side).items():
        if reason is not Reason.USED:
            left_out[tr(NAMES["reason"][reason])] += count
    letter = side.letter
    if not left_out:
        return tr_n("{side}: {used} stride used.", "{side}: {used} strides used.", used).format(side=letter, used=used)
    reasons = [f"{count} {words}" for words, count in left_out.most_common()] if len(left_out) > 1 else list(left_out)
    stated = tr_n(
        "{side}: {used} stride used, {out} excluded ({reasons}).",
        "{side}: {used} strides used, {out} excluded ({reasons}).",
        used,
    )
    return stated.format(side=letter, used=used, out=left_out.total(), reasons=", ".join(reasons))


def few_strides_in_words(part: Part) -> str:
    """What is missing for want of strides; empty where there are enough."""
    counts = {side.letter: part.strides(side) for side in part.sides}
    without_mean = [side for side, n in counts.items() if n and not is_mean_enough(n)]
    without_spread = [side for side, n in counts.items() if is_mean_enough(n) and not is_spread_enough(n)]
    stated = []
    if without_mean:
        none = tr("{sides}: fewer than {count} strides, no mean.")
        stated.append(none.format(sides=joined(without_mean), count=MIN_STRIDES_FOR_MEAN))
    if without_spread:
        bare = tr("{sides}: fewer than {count} strides, no SD.")
        stated.append(bare.format(sides=joined(without_spread), count=MIN_STRIDES_FOR_SD))
    return " ".join(stated)


def side_cycle(part: Part, joint: Joint) -> SideCycle:
    """The joint's strides that are used and known over all of the stride."""
    strides_deg = part.strides_deg(joint)
    strides_deg = strides_deg[np.isfinite(strides_deg).all(axis=1)]
    return SideCycle(mean_cycle(strides_deg), strides_deg, part.stance_percent(joint.side))


def peak_figures(part: Part, reference: ReferenceCurves | None) -> dict[str, tuple[Figure, ...]]:
    """Give rows of peaks per kind of joint, degrees or percent of stride; `reference` None: no band is shown."""
    found: dict[str, tuple[Figure, ...]] = {}
    for kind, rows in ROWS.items():
        joints = {side: joint for side in part.sides if (joint := kind.of(side)) in part.joints}
        if not joints:
            continue
        doubts = {side: why for side, joint in joints.items() if (why := doubt_in(part.verdicts.joint(joint)))}
        figures = []
        for column, name, window in rows:
            of_joint = f"{kind}_{column}"
            reported = {side: part.assessment(side, of_joint) for side in joints}
            unknown = {side: doubts.get(side, NOT_REPORTED) for side, one in reported.items() if not one.is_reported}
            sides = {side: part.value(side, of_joint) for side in joints if side not in unknown}
            unit, decimals = ("%", 0) if column.endswith("_percent") else ("°", 1)
            band = band_of_peak(reference, kind, column, window) if reference is not None and sides else None
            care = frozenset(side for side, one in reported.items() if one.verdict is Verdict.CARE)
            figures.append(
                Figure(of_joint, tr(name), unit, decimals, sides, band=band, unknown=unknown, with_care=care)
            )
        found[kind] = tuple(figures)
    return found


def pelvis_figures(part: Part) -> dict[str, tuple[Figure, ...]]:
    """Rows of the pelvis over each leg's strides, degrees; none without a sensor on it."""
    if not part.has_pelvis:
        return {}
    figures = []
    for column, name in PELVIS_ROWS:
        found = {side: part.assessment(side, column) for side in part.sides}
        reported = {side: part.value(side, column) for side, one in found.items() if one.is_reported}
        unknown = {side: NOT_REPORTED for side, one in found.items() if not one.is_reported}
        care = frozenset(side for side, one in found.items() if one.verdict is Verdict.CARE)
        figures.append(Figure(column, tr(name), "°", 1, reported, unknown=unknown, with_care=care))
    return {"pelvis": tuple(figures)}


def pelvis_in_words(part: Part) -> list[str]:
    """Why figures of pelvis and abduction are not reported, shared reasons once; how often the body turned."""
    if not part.has_pelvis:
        return []
    stated = part.verdicts
    not_reported: dict[str, list[str]] = {}
    for name, found in (
        (tr("pelvis"), stated.pelvis),
        *((tr("{side} hip abduction").format(side=side_name(side)), one) for side, one in stated.abduction.items()),
        (tr("pelvic tilt"), stated.pelvis_tilt if stated.pelvis.is_reported else stated.pelvis),
    ):
        for reason in found.reasons[:1]:
            if reason.verdict is Verdict.NOT_REPORTED:
                not_reported.setdefault(gate_words(reason).why, []).append(name)
    reported = [f"{capitalised(joined(list(dict.fromkeys(names))))}: {why}" for why, names in not_reported.items()]
    turns = sum(len(walk.turns) for walk in part.walks)
    return [*reported, tr_n("{count} turn.", "{count} turns.", turns).format(count=turns)] if turns else reported


def time_distance_figures(
    part: Part, group: ReferenceValues | None, sides_with_band: frozenset[Side]
) -> tuple[Figure, ...]:
    """Give rows of time and distance with the group of this speed; the common rows need both legs comparable."""
    is_any, is_all = bool(sides_with_band), sides_with_band.issuperset(part.sides)

    def row(label: str, name: str, unit: str, decimals: int, bands: TwoBands = NO_BANDS) -> Figure:
        found = {side: part.assessment(side, name) for side in part.sides}
        reported = {side: part.value(side, name) for side, one in found.items() if one.is_reported}
        not_reported = [side for side, one in found.items() if one.verdict is Verdict.NOT_REPORTED]
        care = frozenset(side for side, one in found.items() if one.verdict is Verdict.CARE)
        unknown = dict.fromkeys(not_reported, NOT_REPORTED)
        return Figure(
            name,
            label,
            unit,
            decimals,
            reported,
            band=bands[0] if is_any and reported else None,
            unknown=unknown,
            with_care=care,
            judged_band=bands[1] if is_any and reported else None,
        )

    def both(label: str, name: str, unit: str, decimals: int, bands: TwoBands = NO_BANDS) -> Figure:
        verdict = part.assessment_of_walk(name).verdict
        care = frozenset(part.sides) if verdict is Verdict.CARE else frozenset()
        why = NOT_REPORTED if verdict is Verdict.NOT_REPORTED else ""
        shown, judged = bands if is_all else NO_BANDS
        value = part.of_both(name)
        return Figure(
            name, label, unit, decimals, {}, value, shown, unknown_both=why, with_care=care, judged_band=judged
        )

    def band(name: str, factor: float = 1.0) -> TwoBands:
        if group is None:
            return NO_BANDS
        own, judged = group.values[name], group.judged(name)
        one, other = ((factor * (value.mean - value.sd), factor * (value.mean + value.sd)) for value in (own, judged))
        return one, other

    return (
        # the class is chosen by speed, so its speed would be no comparison
        both(tr("Walking speed"), "speed_m_s", "m/s", 2),
        both(tr("Cadence"), "cadence_steps_min", tr("steps/min"), 0, band("cadence")),
        row(tr("Stride time"), "stride_time_s", "s", 2),
        # a subject's stride is the two steps of which the group's step length is the mean
        row(tr("Stride length"), "stride_length_m", "m", 2, band("step_length", 2.0)),
        row(tr("Stance"), "stance_percent", "%", 1, band("stance")),
        # it holds the biases of all four events, and nobody has yet looked how large these are
        both(tr("Double support"), "double_support_percent", "%", 1),
    )


def doubt_in(found: JointVerdicts) -> str | None:
    """Why a joint's curve does not say all that it could: the gravest of what is not reported; None where all is."""
    if found.shape.verdict is Verdict.NOT_REPORTED:
        return NOT_REPORTED
    if found.sign.verdict is Verdict.NOT_REPORTED:
        return MAY_BE_MIRRORED
    if found.height.verdict is not Verdict.NOT_REPORTED:
        return None
    return NO_ZERO if any(reason.gate == "zero" for reason in found.height.reasons) else NO_HEIGHT


def verdict_of(found: JointVerdicts) -> Verdict:
    """What may be read of a joint's curve as it is drawn; that its height is not reported is stated beside it."""
    parts = (part.verdict for part in (found.shape, found.sign, found.height))
    gravest = worst(part for part in parts if part is not Verdict.NOT_MEASURED)
    return Verdict.CARE if gravest is Verdict.NOT_REPORTED and doubt_in(found) != NOT_REPORTED else gravest


def reason_in_words(found: JointVerdicts) -> str:
    """The gravest reason against a joint's curve, what to do: of a shape not reported, else height, else care."""
    return " ".join(filter(None, _words_of(found)))


def why_in_figures(found: JointVerdicts) -> str:
    """The same in a value and its limit; empty where it has none."""
    reasons = (reason for part in (found.shape, found.height) for reason in part.reasons)
    return next((gate_figures(one) for one in reasons if one.verdict is Verdict.NOT_REPORTED), "")


def why_in_words(found: JointVerdicts) -> str:
    """The same without what to do."""
    return _words_of(found).why


def _words_of(found: JointVerdicts) -> GateWords:
    for required in (Verdict.NOT_REPORTED, Verdict.CARE):
        for part in (found.shape, found.height):
            for reason in part.reasons:
                if reason.verdict is required:
                    return gate_words(reason)
    return GateWords("")


def band_of_peak(
    reference: ReferenceCurves, kind: str, column: str, window_name: str | None
) -> tuple[float, float] | None:
    """1 SD about the group's mean curve where its peak lies; None for what its mean curve cannot show."""
    at = peak_place(reference, kind, column, window_name)
    if at is None:
        return None
    mean, sd = reference.mean_and_sd_deg(kind)
    return float(mean[at] - sd[at]), float(mean[at] + sd[at])


def peak_place(reference: ReferenceCurves, kind: str, column: str, window_name: str | None) -> int | None:
    """Percent of the stride at which the group's mean curve has a peak; None where it has none, as of a range."""
    if column == "at_initial_contact_deg":
        return 0
    windows = [window for window in (*KNEE_WINDOWS, *ANKLE_WINDOWS) if window.name == window_name]
    if not windows:
        return None
    percent = find_peak(reference.mean_and_sd_deg(kind)[0][None, :], windows[0]).percent[0]
    return int(percent) if np.isfinite(percent) else None
