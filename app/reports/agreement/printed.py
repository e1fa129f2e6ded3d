"""Table 1 of an agreement, as lines and as words: who disagrees by how much, and what optical systems disagree by."""

import math
from collections.abc import Callable, Iterator

from app.reports.agreement.study import AgreementStudy, AngleKind, ComparedWalk
from app.reports.agreement.tables import events_together, lengths_together
from app.wording.body import name_of
from app.wording.translation import capitalised, joined, later, tr
from core.agreement.figures import Agreement, AgreementOverWalks
from core.body import Joint, JointKind, Side
from core.session import Patient
from core.verdicts.model import Verdict
from devices.files.references.reading import MARKERS
from devices.files.refusal import one_line

# their own measurements, ALGORITHMS section 4; the review's 5 degrees are of sessions, its abstract was read
OPTICAL_DEG = (2, 4)
IN_ORDER = (JointKind.KNEE, JointKind.ANKLE, JointKind.HIP)  # as Table 1 has them, and what it has not
KINDS = {JointKind.KNEE: later("knee"), JointKind.ANKLE: later("ankle"), JointKind.HIP: later("hip")}


def optical_words() -> str:
    """What two optical systems would differ by, and where that is from."""
    return tr(
        "Different optical models applied to one walk differ by {low} to {high}° at the knee, and by "
        "6 to 8° in standing (measured by the developers on recordings of people, not published). "
        "Between two sessions with one system, most reports give differences below 5° (McGinley et "
        "al. 2009, Gait & Posture 29:360, a review †). A smaller difference does not show which "
        "system is right."
    ).format(low=OPTICAL_DEG[0], high=OPTICAL_DEG[1])


def dagger_words() -> str:
    return tr("† From the abstract; the full text was not available.")


def side_role(side: Side, patient: Patient) -> str:
    """The side as in Table 1: prosthesis and contralateral where there is one, else left and right."""
    if patient.prosthetic_side in set(Side):
        is_prosthesis = patient.prosthetic_side == side
        role = tr("prosthesis") if is_prosthesis else tr("contralateral")
        return f"{role} ({tr('left') if side is Side.LEFT else tr('right')})"
    return tr("left") if side is Side.LEFT else tr("right")


def rows_of_table_1(study: AgreementStudy, patient: Patient) -> list[tuple[Joint, str]]:
    """Knee before ankle before hip, the prosthesis before the other side."""
    first = Side(patient.prosthetic_side) if patient.prosthetic_side in set(Side) else Side.LEFT
    joints = sorted(study.joints, key=lambda joint: (IN_ORDER.index(joint.kind), joint.side is not first))
    return [(joint, side_role(joint.side, patient)) for joint in joints]


Figure = tuple[str, str, Callable[[Agreement], float], Callable[[AgreementOverWalks], float]]


def figures_of_table_1() -> tuple[Figure, ...]:
    """The two tables: their titles, marks, and the figure of a walk and the spread over walks."""
    return (
        ("M", tr("RMSE, mean removed, degrees"), lambda found: found.m_rad, lambda over: over.m_sd_rad),
        ("Z", tr("RMSE as measured, degrees"), lambda found: found.z_rad, lambda over: over.z_sd_rad),
    )


def printed(study: AgreementStudy, patient: Patient) -> Iterator[str]:
    """All lines for a terminal."""
    if study.is_simulated:
        yield "SIMULATED."
    walks = study.with_angles
    if walks:
        for mark, title, of_walk, of_all in figures_of_table_1():
            yield f"{mark}: {title}"
            yield f"  {'':7} {'':22}" + "".join(f"{k:>8}" for k in range(1, len(walks) + 1)) + f"{'sd':>8}{'mean':>8}"
            for joint, role in rows_of_table_1(study, patient):
                over = study.over_walks(joint)
                assert over is not None  # the joint is there because a walk has it
                cells = [_of(walk, joint, of_walk) for walk in walks]
                cells += [math.degrees(of_all(over)), math.degrees(of_walk(over.whole))]
                yield f"  {joint.kind:7} {role:22}" + "".join(f"{_short(cell):>8}" for cell in cells)
            yield ""
        yield f"  {'':30}{'bias':>8}{'limits of agreement':>22}{'r':>8}{'range':>14}{'in 1 sd':>9}{'in 2 sd':>9}"
        for joint, role in rows_of_table_1(study, patient):
            over = study.over_walks(joint)
            assert over is not None  # as above
            yield _more(joint, role, over.whole)
        yield ""
        yield from (f"  {stated}" for stated in source_words(study))
        yield from (f"  {stated}" for stated in other_angles_words(study))
        yield from (f"  {stated}" for stated in used_words(study))
        for number, walk in enumerate(walks, 1):
            yield f"  {number}: {clock_words(walk)}"
    yield from events_words(study, _short, "{:+.2f}".format, _short)
    for one in study.left_over:
        yield f"- {tr('{name}: no matching counterpart, so it was not compared.').format(name=one_line(one))}"
    yield from (f"- {stated}" for stated in verdict_words(study))
    if walks:
        yield ""
        yield optical_words()
        yield dagger_words()


def event_name(kind: str) -> str:
    """An event as it heads a sentence."""
    names = {"initial_contact": tr("initial contact"), "toe_off": tr("toe-off")}
    return capitalised(names.get(kind, kind.replace("_", " ")))


def clock_words(walk: ComparedWalk) -> str:
    """How the reference was brought to a walk."""
    found = walk.alignment
    assert found is not None  # only walks with angles are reported
    stated = [
        tr(
            "{walk}: the reference's clock differs by {offset_s:+.4f} s (SD {offset_sd_ms:.1f} ms) and "
            "its rate by {rate:+.0f} ppm (SD {rate_sd:.0f})"
        ).format(
            walk=one_line(walk.recording.name),
            offset_s=found.clock.offset_s,
            offset_sd_ms=1e3 * found.offset_sd_s,
            rate=1e6 * found.clock.rate,
            rate_sd=1e6 * found.rate_sd,
        )
    ]
    turned = [name_of(joint) for joint, sign in found.sign.items() if sign < 0]
    if turned:
        stated.append(tr("sign reversed: {joints}").format(joints=", ".join(turned)))
    if not found.is_offset_certain:
        stated.append(tr("another time offset fits nearly as well, so this one may be wrong by one stride"))
    for trial, other in walk.more:
        name = ", ".join(filter(None, [trial.file, trial.trial.name]))
        more = tr("time offset of {name}: {offset_s:+.4f} s (SD {offset_sd_ms:.1f} ms)")
        stated.append(
            more.format(name=one_line(name), offset_s=other.clock.offset_s, offset_sd_ms=1e3 * other.offset_sd_s)
        )
    return f"{'; '.join(stated)}."


def used_words(study: AgreementStudy) -> list[str]:
    """Of each joint, how many samples of the walks are compared, and where the others are."""
    stated = []
    for joint in study.joints:
        walks = [walk.used[joint] for walk in study.with_angles if (joint, AngleKind.RESULT) in walk.figures]
        where = {
            tr("{count} outside the reference's time span"): sum(one.outside for one in walks),
            tr("{count} in gaps"): sum(one.in_gaps for one in walks),
            tr("{count} after a strap moved"): sum(one.after_slip for one in walks),
        }
        others = joined([words.format(count=count) for words, count in where.items() if count])
        used, recorded = sum(one.used for one in walks), sum(one.recorded for one in walks)
        words = tr("{joint}: {used} of {recorded} samples are used").format(
            joint=capitalised(name_of(joint)), used=used, recorded=recorded
        )
        stated.append(f"{words}; {others}." if others else f"{words}.")
    return stated


def verdict_words(study: AgreementStudy) -> list[str]:
    """What keeps the figures from being taken at their word: sides exchanged, joints that the program withholds."""
    exchanged = [one_line(walk.recording.name) for walk in study.with_angles if walk.is_exchanged]
    stated = []
    if exchanged:
        stated.append(
            tr("Left and right look swapped in the reference of {walks}: swapping them gives a better fit.").format(
                walks=joined(exchanged)
            )
        )
    for joint in study.joints:
        names = [
            one_line(walk.recording.name)
            for walk in study.with_angles
            if (joint, AngleKind.RESULT) in walk.figures
            and walk.recording.verdicts.joint(joint).shape.verdict is Verdict.NOT_REPORTED
        ]
        if names:
            stated.append(
                tr("{joint}: not reported in {walks}. Its values are shown here for checking only.").format(
                    joint=capitalised(name_of(joint)), walks=joined(names)
                )
            )
    return stated


def source_words(study: AgreementStudy) -> list[str]:
    """References that give no joint angles of their own, and what was made of them."""
    files = dict.fromkeys(trial.file for walk in study.walks for trial, _ in walk.trials if trial.source == MARKERS)
    stated = tr(
        "{file} holds markers and no joint angles. Its angles were computed from the markers, in the plane of walking."
    )
    return [stated.format(file=one_line(file)) for file in files]


def other_angles_words(study: AgreementStudy) -> list[str]:
    """M of the angles that are not the result, on the same axes: the paper found its two to differ little."""
    names = {
        AngleKind.PUBLISHED: tr("Published fusion (eq 15), same axes, M: {figures}."),
        AngleKind.ORIENTATION: tr("Sensor orientations (eq 10), same axes, M: {figures}."),
    }
    stated = []
    for kind, sentence in names.items():
        found = [(joint, over) for joint in study.joints if (over := study.over_walks(joint, kind)) is not None]
        figures = ", ".join(f"{name_of(joint)} {math.degrees(over.whole.m_rad):.2f}°" for joint, over in found)
        if figures:
            stated.append(sentence.format(figures=figures))
    return stated


def _more(joint: Joint, role: str, found: Agreement) -> str:
    limits = f"{_short(math.degrees(found.low_rad))} .. {_short(math.degrees(found.high_rad))}"
    ranges = f"{_short(math.degrees(found.range_error_rad))} ({found.ranges})"
    shares = [
        f"{100 * share:.0f} %" if math.isfinite(share) else "-" for share in (found.within_1_sd, found.within_2_sd)
    ]
    return (
        f"  {joint.kind:7} {role:22}{_short(math.degrees(found.bias_rad)):>8}{limits:>22}{_short(found.correlation):>8}"
        f"{ranges:>14}{shares[0]:>9}{shares[1]:>9}"
    )


Write = Callable[[float], str]


def events_words(study: AgreementStudy, of_time: Write, of_bias: Write, of_spread: Write) -> Iterator[str]:
    """How events and lengths agree; milliseconds are written by `of_time`, bias and SD of a length by the others."""
    for kind, found in events_together(study).items():
        stated = tr("{event}: {found} of {count} found, {more} extra; {bias} ms late, SD {sd} ms.")
        bias, sd = of_time(1e3 * found.bias_s), of_time(1e3 * found.sd_s)
        yield stated.format(
            event=event_name(kind), found=found.found, count=found.count, more=found.more, bias=bias, sd=sd
        )
    lengths = lengths_together(study)
    if len(lengths) > 1:
        error = lengths[:, 0] - lengths[:, 1]
        percent = 100 * float(error.mean()) / float(lengths[:, 1].mean())
        stated = tr("Stride length: {count} strides, bias {bias} %, SD {sd} cm.")
        spread = of_spread(100 * float(error.std(ddof=1)))
        yield stated.format(count=len(lengths), bias=of_bias(percent), sd=spread)


def _of(walk: ComparedWalk, joint: Joint, of_walk: Callable[[Agreement], float]) -> float:
    found = walk.figures.get((joint, AngleKind.RESULT))
    return math.nan if found is None else math.degrees(of_walk(found))


def _short(value: float) -> str:
    return f"{round(value, 2) + 0.0:.2f}" if math.isfinite(value) else "-"
