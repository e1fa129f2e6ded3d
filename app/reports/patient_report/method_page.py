"""What did the clinician say, how was it measured, and where does every band come from?"""

import math
from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime

from app.recording_names import with_shown_names
from app.reports.patient_report import quality
from app.reports.patient_report.blocks import Block, bullets, heading, note
from app.reports.patient_report.evidence import evidence
from app.reports.patient_report.facts import Facts
from app.reports.patient_report.numbers_in_words import fixed, signed_error
from app.reports.patient_report.panels import why_no_band
from app.reports.patient_report.plain_text import plain, plain_lines
from app.reports.patient_report.request import ReportRequest
from app.reports.patient_report.time_page import is_evidence_beside_time
from app.wording import sentence, tr
from core.body import JointKind
from core.calibration.certainty import AXIS_FLOOR_HUMAN_RAD, AXIS_FLOOR_WALKING_RAD
from core.findings import Finding, Severity
from core.norms import KNEE_OVERREAD
from core.results import AxisSource
from core.verdicts.measurement_error import ComparisonKind, sigma_of

LONG = 14  # lines of words that may not fit into what is left of the page
# what was corrected by hand, and what changes how a number is read: told, however mild
TOLD = {
    "sign_turned",
    "sign_confirmed",
    "zero_from_goniometer",
    "prosthetic_toe_off",
    "events_from_shank",
    "rate_from_orientation",
    "gravity_from_orientation",
}


def words_page(request: ReportRequest, facts: Facts) -> list[Block]:
    """How sure, how measured, and what the clinician says, whose box takes what is left of the page."""
    comment = plain_lines(request.comment)
    method = _method(facts)
    return [
        heading(tr("How sure, how measured")),
        *([] if is_evidence_beside_time(facts) else evidence(facts)),
        *_remarks(request, facts),
        {"kind": "two_columns", "columns": [_texts(method[:-2]), _texts(method[-2:])]},
        note(" ".join([*_sources(facts), _made(request.made_at)])),
        heading(tr("Clinician's words")),
        {
            "kind": "comment",
            "lines": comment or [tr("No words were entered.")],
            "is_empty": not comment,
            "is_long": len(comment) > LONG,
        },
        {"kind": "signature", "said": [tr("Name"), tr("Signature"), tr("Date")]},
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
    causes = quality.caveats(facts)
    names = request.visit.shown_names
    noticed = [plain(sentence(with_shown_names(finding, names))) for finding in _joined(told)]
    said = [*(causes if len(causes) > 1 else []), *noticed]
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
        "floor": fixed(math.degrees(AXIS_FLOOR_HUMAN_RAD), 0),
        "walking": fixed(math.degrees(AXIS_FLOOR_WALKING_RAD), 0),
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
        said.append(pattern.format(n=curves.n, group=tr(curves.group), speed=speed, source=curves.source))
    if values is not None:
        pattern = tr(
            "[2] Time and distance: {group}, optical markers and force plates; class “{speed_class}” of the Froude "
            "number ({speed} m/s, n = {n}). {source}."
        )
        said.append(
            pattern.format(
                group=tr(values.group),
                speed_class=values.speed_class,
                speed=fixed(values.speed_m_s, 2),
                n=values.n,
                source=values.source,
            )
        )
    return said or [why_no_band(facts, facts.bands.why_no_values)]


def _made(made_at: datetime) -> str:
    return tr("This report was made on {moment}.").format(moment=f"{made_at:%Y-%m-%d %H:%M %z}".strip())


def _hips_method() -> tuple[str, str]:
    return (
        tr("Hips and pelvis"),
        tr(
            "A sensor on the sacrum and those of the thighs tell how each thigh turns in the pelvis, from standing. "
            "Beside optical markers walking hips were 1 to 4° off after removing the mean, deep squats 6° (four "
            "people, on whom the constants were set); heights read some 5° high. Abduction: 2.5° (1 SD)."
        ),
    )


def _method(facts: Facts) -> list[tuple[str, str]]:
    from_walks = [found for found in facts.calibrated.values() if found.axis_source is AxisSource.WALKING]
    motion = (
        tr("the walks themselves, as no free movement was recorded")
        if from_walks
        else tr("the patient's own free movement, the ankle's axis from the walks too")
    )
    return [
        (
            tr("Method"),
            tr(
                "Sensors on thigh, shank and foot measured angular rate and acceleration. The axis of each joint "
                "comes from {motion}: no posture, no magnetic field, no tape. An angle is the turn of the lower "
                "segment against the upper one about that axis. Initial contact and toe\u2011off come from the foot "
                "sensors, speed and stride length too."
            ).format(motion=motion),
        ),
        *([_hips_method()] if facts.has_joint(JointKind.HIP) else []),
        (
            tr("Which strides"),
            tr(
                "Strides of steady straight walking. Slow or short ones at either end, turns, pauses, missing samples, "
                "doubtful landings, strides unlike the others and those after a strap slipped are left out; each is in "
                "the file of strides with its reason. A peak at the edge of its window is printed as “no peak”."
            ),
        ),
        (
            tr("Zero"),
            tr(
                "The standing posture of this patient on this day, or the goniometer value typed in for it. An error "
                "in it moves a whole curve up or down and leaves its range and shape."
            ),
        ),
        (
            tr("How accurate, and on whom"),
            tr(
                "The method was published with one user of a transfemoral prosthesis: against optical markers the "
                "knee differed by less than 1° on the prosthesis and about 3° on the sound leg, the ankle by about "
                "1° (root mean square; Seel, Raisch, Schauer 2014, Sensors 14:6891). This software has been checked "
                "against simulated walks and against recordings of others. It has not been tested on patients."
            ),
        ),
        (
            tr("Words"),
            tr(
                "Band: mean ± 1 and 2 SD of other, healthy people, measured with optical markers; not a target. "
                "Error: a smaller difference happens by measuring alone in 95 of 100 repeats; of knee range between "
                "legs and visits at least {knee_error}° (upper end of 3.4–9.2° published, 15 volunteers; for the ankle "
                "borrowed). Exceeds: larger than that; it says how large a difference is, not whether it is good. "
                "Certainty of a joint axis is never told below {floor}°, from walking alone below {walking}°. "
                "Knees are read 9 ± 4 % too flexed, so they are judged as measured and divided by {overread}. "
                "Withheld: measured, but not fit to be read; the cause is named."
            ),
        ),
    ]
