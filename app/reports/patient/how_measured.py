"""Method by which this walk was measured.

Sensors, calibration, filter, angles, events and accuracy, so that others can repeat it.

What the ISB recommends to report of joint angles by inertial sensors (Cereatti et al. 2024, doi
10.1016/j.jbiomech.2024.112225), as far as it could be read: `packaging/safety/reporting.md` states where each item is.
What no sensor and no file reports is stated to be unknown, never filled in.
"""

import math
from collections import Counter

from app.summary.error_figures import error_figures_in_words
from app.summary.facts import Facts
from app.summary.numbers_in_words import fixed, least_error_in_words
from app.summary.plain_text import breakable, isolated, plain, shortened
from app.wording.body import name_of
from app.wording.findings import WHOLE_SESSION
from app.wording.prostheses import prosthesis_words
from app.wording.translation import capitalised, joined, tr
from core.body import JointKind, Segment, Side, Site, ankle_of, knee_of
from core.calibration.certainty import AXIS_FLOOR_HUMAN_RAD, AXIS_FLOOR_WALKING_RAD
from core.findings import Finding
from core.parameters import KNEE_RANGE
from core.prosthesis import JointNature
from core.results import AxisSource, Method
from core.samples import ImuBlock, RateKind, SensorInfo
from core.signal.published_filter import TAU_ACC_S
from core.signal.tracks import MAX_REPORTED_GAP_S, nominal_step_s
from core.verdicts.norms import KNEE_OVERREAD
from core.verdicts.sigmas import ComparisonKind, in_use

MOST_MODELS = 2  # for more, their number is given
MODEL_LENGTH = 32

Titled = tuple[str, str]
"""A title and the words under it."""


def how_measured(facts: Facts, software_version: str) -> tuple[list[Titled], list[Titled]]:
    """Title and words of what was measured and how, and of how sure it is and what words mean: two columns."""
    done = [
        (tr("Sensors"), _sensors(facts)),
        (tr("Calibration"), _calibration(facts)),
        (tr("Angles"), _angles(facts)),
        (tr("Events and strides"), _strides(facts)),
    ]
    stated = [
        (tr("Accuracy"), _accuracy()),
        *([(tr("Prosthesis"), _prostheses(facts))] if facts.visit.analysis.prostheses else []),
        *([(tr("Hips and pelvis"), _hips())] if facts.has_joint(JointKind.HIP) else []),
        (tr("Terms"), _words()),
        *([(tr("Error figures"), error_figures_in_words())] if in_use().study is not None else []),
        (tr("Software"), _software(facts, software_version)),
    ]
    return done, stated


def _worn(facts: Facts) -> dict[Site, ImuBlock]:
    return {site: block for site, block in facts.visit.recording(facts.walk.name).imu.items() if len(block)}


def _findings(facts: Facts, key: str) -> list[Finding]:
    """What was noticed of this walk, or of the whole session."""
    return [
        one
        for one in facts.visit.analysis.findings
        if one.key == key and {facts.walk.name, WHOLE_SESSION} & set(one.where.split(", "))
    ]


def _sensors(facts: Facts) -> str:
    worn = _worn(facts)
    reported = [facts.visit.session.sensors.get(site, SensorInfo()) for site in worn]
    stated = tr(
        "{models}, {rates}, on {segments}, strapped in any orientation. The measuring range is not in "
        "the recording; {end}."
    )
    is_reached = bool(_findings(facts, "clipped"))
    return stated.format(
        models=_models(reported),
        rates=_rates(reported, list(worn.values())),
        segments=_segments(set(worn)),
        end=tr("some samples reach its limit (see findings)") if is_reached else tr("no samples reach its limit"),
    )


def _models(reported: list[SensorInfo]) -> str:
    """Which sensors, as given by them or their files: "6 × MTi, firmware 4.2"."""
    named = Counter((_foreign(tr(one.model)), _foreign(one.firmware)) for one in reported)
    if len(named) > MOST_MODELS:
        return tr("{count} sensors of {kinds} models").format(count=len(reported), kinds=len(named))
    each = []
    for (model, firmware), count in named.most_common():
        stated = model or tr("sensor of unknown model")
        stated = tr("{model}, firmware {firmware}").format(model=stated, firmware=firmware) if firmware else stated
        each.append(f"{count} × {stated}")
    return joined(each)


def _foreign(text: str) -> str:
    """What a sensor or a file states about itself may be anything, and of any length."""
    return isolated(breakable(shortened(plain(text).strip(), MODEL_LENGTH)))


def _rates(reported: list[SensorInfo], blocks: list[ImuBlock]) -> str:
    """At which rate, as the sensors or their files give it, and as the time stamps show it."""
    found = [1.0 / nominal_step_s(block.time_s) for block in blocks if len(block) > 1]
    shown = tr("{rate} Hz by time stamps").format(rate=_span(found, 1)) if found else tr("rate not known")
    set_to = [one.rate_hz for one in reported if one.rate_hz]
    return ", ".join([tr("set to {rate} Hz").format(rate=_span(set_to, 0)), shown]) if set_to else shown


def _span(values: list[float], decimals: int) -> str:
    low, high = fixed(min(values), decimals), fixed(max(values), decimals)
    return low if low == high else f"{low}–{high}"


def _segments(worn: set[Site]) -> str:
    words = {Segment.THIGH: tr("thigh"), Segment.SHANK: tr("shank"), Segment.FOOT: tr("foot")}
    here = [words[segment] for segment in words if any(site.segment is segment for site in worn)]
    here += [tr("pelvis")] if Site.PELVIS in worn else []
    sides = {site.side for site in worn if site is not Site.PELVIS}
    if sides == set(Side):
        return tr("{parts} of both legs").format(parts=joined(here))
    side = tr("{parts} of the left leg") if Side.LEFT in sides else tr("{parts} of the right leg")
    return side.format(parts=joined(here)) if sides else joined(here)


def _calibration(facts: Facts) -> str:
    from_walks = any(found.axis_source is AxisSource.WALKING for found in facts.calibrated.values())
    motion = (
        tr("the walks, as no free motion was recorded")
        if from_walks
        else tr("the patient's own free motion, for the ankle also from the walks")
    )
    calibrated = facts.calibrated.values()
    is_rest_unknown = any(
        bias is None for one in calibrated for bias in (one.gyro_bias_proximal_rad_s, one.gyro_bias_distal_rad_s)
    )
    rest = (
        tr("unknown, as a sensor was never still") if is_rest_unknown else tr("from standing or other moments at rest")
    )
    return tr(
        "Gyroscope offsets: {rest}. Joint axes, as both sensors of a joint measure them, come from "
        "{motion}. No set posture, magnetic field or tape measure is used. Standing reference: this "
        "patient's posture on this day, or the goniometer value entered. An error in it shifts the whole "
        "curve, not its range of motion or shape."
    ).format(rest=rest, motion=motion)


def _angles(facts: Facts) -> str:
    kinds = {
        RateKind.INSTANTANEOUS: tr("instantaneous angular rates"),
        RateKind.AVERAGED: tr("angular rates averaged by the sensors"),
        None: tr("angular rates of unknown kind"),
    }
    angle = (
        tr("A joint angle is the rotation of the lower segment relative to the upper one about the joint's own axis")
        if facts.visit.analysis.method is Method.ROBUST
        else tr("A joint angle is that of equation 15 of the published method, about the joint's own axis")
    )
    return tr(
        "Sensor orientation: VQF (Laidig, Seel 2023), forward and backward, without magnetometer, "
        "time constant {tau} s, from {kind}. {angle}. It is one of three rotations, not a Cardan "
        "angle from bony landmarks. Flexion and dorsiflexion are positive. Angles are not filtered; "
        "gaps up to {gap} s are bridged."
    ).format(
        tau=fixed(TAU_ACC_S, 0),
        kind=kinds[_kind(facts)],
        angle=angle,
        gap=fixed(MAX_REPORTED_GAP_S, 2),
    )


def _hips() -> str:
    return tr(
        "The sacrum and thigh sensors show how each thigh turns relative to the pelvis, starting from "
        "standing. In four people, hip angles were compared with optical markers. With the mean "
        "removed, the hip angles were off by 1 to 4° in walking and by 6° in deep squats. The "
        "constants of the method were set on the same four people. Absolute angles were about 5° too "
        "high. Abduction was off by 2.5° (1 SD)."
    )


def _kind(facts: Facts) -> RateKind | None:
    """What one sample of an angular rate represents, as the sensors give it or the data showed; None: neither."""
    reported = {info.rate_kind for site, info in facts.visit.session.sensors.items() if site in _worn(facts)}
    found = {RateKind(str(one.numbers["kind"])) for one in _findings(facts, "rate_kind_found")}
    known = (reported - {None}) | found
    return known.pop() if len(known) == 1 else None


def _strides(facts: Facts) -> str:
    source = (
        tr("from the tilt of the foot, or of the shank where a foot has no sensor")
        if _findings(facts, "events_from_shank")
        else tr("from the tilt of the foot; for feet that hardly roll, from the path of the sole")
    )
    return tr(
        "Initial contact and toe\u2011off: {source}. Speed and stride length: integrated from stance "
        "to stance. Used: steady straight walking. Excluded: slow or short strides at the start and "
        "end of a walk, turns, pauses, missing samples, uncertain contacts, strides unlike the others "
        "and strides after a strap moved. Reasons are in the stride file. A peak at the edge of its "
        "search window is shown as “no peak”."
    ).format(source=source)


def _prostheses(facts: Facts) -> str:
    """What was stated of each, and what each joint of its side is taken for therefore."""
    takes = {
        JointNature.OWN: tr("{joint}: the patient's own, so its uncertainty is that of a living joint."),
        JointNature.PROSTHETIC: tr("{joint}: a joint of the prosthesis."),
        JointNature.RIGID: tr("{joint}: a foot without ankle joint; the angle is the foot relative to the shank."),
    }
    sentences: list[str] = []
    for side, one in facts.visit.analysis.prostheses.items():
        sentences.append(f"{capitalised(prosthesis_words(side, one))}.")
        if one.level is not None:
            found = [joint for joint in (knee_of(side), ankle_of(side)) if joint in facts.walk.joints]
            sentences += [takes[one.nature_of(joint)].format(joint=capitalised(name_of(joint))) for joint in found]
    return " ".join(sentences)


def _accuracy() -> str:
    # the figures of resources/help/accuracy.md; a test compares them
    return tr(
        "Difference from optical systems (root mean square, mean removed): two mechanical hinges "
        "0.31° and 0.26°; walking of one person 4.3° and 3.1° at the knees, 2.1° at the ankles. "
        "Absolute angles differed by about 5° at the knees and 7 to 9° at the ankles (unpublished "
        "recordings). 57 initial contacts and toe\u2011offs of a healthy person: SD 7.7 and 7.2 ms, "
        "contacts 25 ms later than optical; stride length 0.25 % too short, SD 1.5 cm. Not tested on "
        "patients, after knee replacement or on real prostheses."
    )


def _words() -> str:
    return tr(
        "Reference: mean ± 1 and 2 SD of other, healthy people, measured with optical markers; not a "
        "target. Likely between: 95 of 100 such measurements hold the true difference. At two visits the error of a "
        "60° knee range of motion is at least {knee_error}°. That is a size, not a judgement. Certainty of a joint "
        "axis is never given below {floor}°, from walking alone never below {walking}°. Knees are measured 9 ± 4 % "
        "too flexed; they are judged as measured and divided by {overread}. Not reported: measured, "
        "but not reliable; the cause is named."
    ).format(
        knee_error=least_error_in_words(KNEE_RANGE, ComparisonKind.VISITS),
        floor=fixed(math.degrees(AXIS_FLOOR_HUMAN_RAD), 0),
        walking=fixed(math.degrees(AXIS_FLOOR_WALKING_RAD), 0),
        overread=fixed(KNEE_OVERREAD, 2),
    )


def _software(facts: Facts, version: str) -> str:
    methods = {Method.ROBUST: tr("the robust method"), Method.PUBLISHED: tr("the published method")}
    return tr("Gaitwright {version}, {method} (after Seel, Raisch, Schauer 2014, Sensors 14:6891).").format(
        version=_foreign(version), method=methods[facts.visit.analysis.method]
    )
