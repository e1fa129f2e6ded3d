"""What did the clinician say, how was it measured, and where does every band come from?"""

import math
from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime

from app.reports.patient_report.blocks import Block, bullets, heading, note
from app.reports.patient_report.facts import Facts
from app.reports.patient_report.first_page import why_no_band
from app.reports.patient_report.numbers_in_words import fixed, signed_error
from app.reports.patient_report.plain_text import plain, plain_lines
from app.reports.patient_report.request import ReportRequest
from app.wording import sentence, tr
from core.calibration.certainty import AXIS_FLOOR_HUMAN_RAD, AXIS_FLOOR_WALKING_RAD
from core.findings import Finding, Severity
from core.norms import KNEE_OVERREAD
from core.results import AxisSource
from core.verdicts.gates import LIMITS
from core.verdicts.measurement_error import ComparisonKind, sigma_of

# what was corrected by hand, and what changes how a number is read: told, however mild
TOLD = {
    "sign_turned",
    "sign_confirmed",
    "zero_from_goniometer",
    "prosthetic_toe_off",
    "events_from_shank",
    "rate_from_orientation",
}


def words_page(request: ReportRequest, facts: Facts) -> list[Block]:
    comment = plain_lines(request.comment)
    return [
        heading(tr("Clinician's words")),
        {"kind": "comment", "lines": comment or [tr("No words were entered.")], "is_empty": not comment},
        {"kind": "signature", "said": tr("Name, signature, date")},
        *_remarks(request, facts),
        heading(tr("Method and limits")),
        {"kind": "two_columns", "columns": [_texts(_method(facts)[:3]), _texts(_method(facts)[3:])]},
        heading(tr("Source of each band")),
        *(note(source) for source in _sources(facts)),
        note(_made(request.made_at)),
    ]


def _remarks(request: ReportRequest, facts: Facts) -> list[Block]:
    """Every finding that touches these walks and is more than information, and those of `TOLD`."""
    others = {r.name for r in request.visit.session.recordings if r.name not in request.walks}
    told = [
        finding
        for finding in request.visit.analysis.findings
        if (finding.severity is not Severity.INFO or finding.key in TOLD)
        and not others.intersection(finding.where.split(", "))
    ]
    said = [plain(sentence(finding)) for finding in _joined(told)]
    return [heading(tr("Remarks on this recording")), bullets(said)] if said else []


def _joined(findings: Sequence[Finding]) -> list[Finding]:
    """Tell what holds alike of several places once, of all of them."""
    places: dict[tuple[object, ...], dict[str, None]] = {}
    first: dict[tuple[object, ...], Finding] = {}
    for finding in findings:
        alike = finding.key, *finding.numbers.items()
        first.setdefault(alike, finding)
        places.setdefault(alike, {}).update(dict.fromkeys(finding.where.split(", ")))
    return [replace(finding, where=", ".join(places[alike])) for alike, finding in first.items()]


def _texts(parts: Sequence[tuple[str, str]]) -> list[list[str]]:
    figures = {
        "knee_error": signed_error(sigma_of("knee_range_deg", ComparisonKind.VISITS)),
        "degree": signed_error(sigma_of("knee_range_deg", ComparisonKind.ATTACHED)),
        "stance": signed_error(sigma_of("stance_percent", ComparisonKind.ATTACHED)),
        "floor": fixed(math.degrees(AXIS_FLOOR_HUMAN_RAD), 0),
        "walking": fixed(math.degrees(AXIS_FLOOR_WALKING_RAD), 0),
        "care": fixed(LIMITS.axis_sd_deg[0], 1),
        "most": fixed(LIMITS.axis_sd_deg[1], 0),
        "overread": fixed(KNEE_OVERREAD, 2),
    }
    return [[title, said.format(**figures)] for title, said in parts]


def _sources(facts: Facts) -> list[str]:
    curves, values = facts.curves_group, facts.values_group
    said = []
    if curves is not None:
        pattern = tr(
            "[1] Curves, peaks, GVS: {n} {group}, {speed} m/s, optical markers. {source}. "
            "Values and SD are read from the mean curve, which has no SD of range."
        )
        speed = fixed(curves.speed_m_s, 2)
        said.append(pattern.format(n=curves.n, group=curves.group, speed=speed, source=curves.source))
    if values is not None:
        pattern = tr(
            "[2] Time and distance: {group}, optical markers and force plates; class “{speed_class}” of the Froude "
            "number ({speed} m/s, n = {n}). {source}."
        )
        said.append(
            pattern.format(
                group=values.group,
                speed_class=values.speed_class,
                speed=fixed(values.speed_m_s, 2),
                n=values.n,
                source=values.source,
            )
        )
    return said or [why_no_band(facts, facts.bands.why_no_values)]


def _made(made_at: datetime) -> str:
    return tr("This report was made on {moment}.").format(moment=f"{made_at:%Y-%m-%d %H:%M %z}".strip())


def _method(facts: Facts) -> list[tuple[str, str]]:
    from_walks = [found for found in facts.calibrated.values() if found.axis_source is AxisSource.WALKING]
    motion = (
        tr("the walks themselves, as no free movement was recorded")
        if from_walks
        else tr("the patient's own free movement, the ankle's axis from the walks too")
    )
    return [
        (
            tr("What was measured"),
            tr(
                "Small motion sensors on thigh, shank and foot measured angular rate and acceleration. The software "
                "found the axis of each joint from {motion}: no posture had to be held, no magnetic field was used, "
                "nothing was measured with a tape. Knee and ankle angles are the turn of the lower segment against "
                "the upper one about that axis. Initial contact and toe\u2011off come from the foot sensors; each leg "
                "is drawn on its own stride. Walking speed and stride length come from the foot sensors too."
            ).format(motion=motion),
        ),
        (
            tr("Which strides"),
            tr(
                "Strides of steady straight walking were used. Slow or short strides at either end, turns, pauses, "
                "strides with missing samples or a doubtful landing, strides unlike the others and those after a "
                "strap slipped were left out; each is listed in the strides file with its reason. Curves are means "
                "over strides resampled to 101 points. Peaks are found stride by stride and then averaged, so a "
                "marker may lie beyond the peak of the mean curve. A peak at the edge of its search window is not a "
                "peak and is printed as “no peak”."
            ),
        ),
        (
            tr("Zero"),
            tr(
                "Zero is the standing posture of this patient on this day, or the goniometer value typed in for it. "
                "An error in zero moves a whole curve up or down and does not change its range or shape. Where no "
                "zero was set, only range and timing are printed."
            ),
        ),
        (
            tr("Accuracy, and on whom it was shown"),
            tr(
                "The method was published with one user of a transfemoral prosthesis: against optical markers the "
                "knee differed by less than 1° on the prosthesis and about 3° on the sound leg, the ankle by about "
                "1° (root mean square; Seel, Raisch, Schauer 2014, Sensors 14:6891). This software has been checked "
                "against simulated walks. It has not been tested on patients."
            ),
        ),
        (
            tr("Certainty of joint axes"),
            tr(
                "How far the axis that was found may lie from the true one (1 SD): for a human joint never told below "
                "{floor}°, from walking alone below {walking}°. Up to {care}° the joint can be read, up to {most}° "
                "with care; beyond, it is withheld."
            ),
        ),
        (
            tr("Measurement error used for the words"),
            tr(
                "The error of a difference is 1.96 times its standard deviation: chance between strides, drift, the "
                "sensors' clocks, another speed, and what lies between the two: with the sensors left on at least "
                "{degree}° of range and {stance} points of stance; between visits and legs, where they are put on "
                "separately, {knee_error}° of the knee (upper end of the minimal detectable change published, "
                "3.4–9.2°, 15 volunteers; for the ankle borrowed, †). The words say how large a difference is, not "
                "whether it is good."
            ),
        ),
        (
            tr("Reading the band"),
            tr(
                "The band shows other people, measured with optical markers, and is not a target. Laboratories "
                "differ by 5–7° in the height of such curves, so a peak is judged after laying the band at the height "
                "of its curve; a knee, which is read 9 ± 4 % too flexed, both as measured and divided by {overread}. "
                "The band is chosen by speed and height (Froude number). A prosthetic leg has none."
            ),
        ),
    ]
