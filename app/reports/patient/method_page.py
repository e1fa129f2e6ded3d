"""The data quality in detail, how it was measured, and where every band comes from."""

from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime

from app.reports.blocks import Block, bullets, heading, note
from app.reports.patient.evidence import evidence
from app.reports.patient.first_page import is_comment_cut
from app.reports.patient.how_measured import how_measured
from app.reports.patient.quality_matrix import quality_matrix
from app.reports.patient.time_page import is_evidence_beside_time, speed_class_in_words
from app.reports.patient.what_measured import what
from app.summary import quality
from app.summary.comparison import Comparison
from app.summary.facts import Facts
from app.summary.numbers_in_words import fixed
from app.summary.panels import why_no_band
from app.summary.plain_text import plain, plain_lines
from app.summary.request import ReportRequest
from app.summary.what_stands_out import caveat, printed_findings
from app.wording.findings import sentence
from app.wording.recordings import with_shown_names
from app.wording.translation import tr
from core.findings import Finding, Severity
from core.verdicts.norms import PUBLISHED

# what was corrected by hand, and what changes how a number is read: reported, however mild
REPORTED = {
    "sign_turned",
    "sign_confirmed",
    "zero_from_goniometer",
    "prosthetic_toe_off",
    "events_from_shank",
    "rate_from_orientation",
    "gravity_from_orientation",
}


def words_page(request: ReportRequest, facts: Facts, comparison: Comparison | None) -> list[Block]:
    """What may be read and why, how it was measured; a comment that page one has no room for; the signature."""
    comment = plain_lines(request.comment) if is_comment_cut(request) else []
    words: list[Block] = (
        [{**heading(tr("Clinical comment")), "label": "comment"}, {"kind": "comment", "lines": comment}]
        if comment
        else []
    )
    return [
        *_findings(facts, comparison),
        *quality_matrix(facts),
        heading(tr("Method and accuracy")),
        note(what(request, facts, comparison)),
        *([] if is_evidence_beside_time(facts) else evidence(facts)),
        *_remarks(request, facts),
        {"kind": "two_columns", "columns": list(how_measured(facts, request.software_version))},
        note(" ".join([*_sources(facts), _made(request.made_at)])),
        *words,
        {"kind": "signature", "said": [tr("Name"), tr("Signature"), tr("Date")]},
    ]


def _findings(facts: Facts, comparison: Comparison | None) -> list[Block]:
    """What exceeds its error or a band by enough for a sentence, at most three, and one caution."""
    found = [" ".join(filter(None, [one.stated, one.evidence])) for one in printed_findings(facts, comparison)]
    stated = [*found, *caveat(facts, comparison)]
    return [heading(tr("Findings")), bullets(stated)] if stated else []


def _remarks(request: ReportRequest, facts: Facts) -> list[Block]:
    """Every finding that touches these walks and is more than information, and those of `REPORTED`."""
    others = {r.name for r in request.visit.session.recordings if r.name not in request.walks}
    reported = [
        finding
        for finding in request.visit.analysis.findings
        if (finding.severity is not Severity.INFO or finding.key in REPORTED)
        and not others.intersection(finding.where.split(", "))
    ]
    causes = quality.caveats(facts)
    names = request.visit.shown_names
    noticed = [plain(sentence(with_shown_names(finding, names))) for finding in _joined(reported)]
    stated = [*causes, *noticed]
    return [heading(tr("Data quality findings")), bullets(stated)] if stated else []


def _joined(findings: Sequence[Finding]) -> list[Finding]:
    """Report once, for all of them, what holds alike for several places."""
    places: dict[tuple[object, ...], dict[str, None]] = {}
    first: dict[tuple[object, ...], Finding] = {}
    for finding in findings:
        alike = finding.key, *finding.numbers.items()
        first.setdefault(alike, finding)
        places.setdefault(alike, {}).update(dict.fromkeys(finding.where.split(", ")))
    return [replace(finding, where=", ".join(places[alike])) for alike, finding in first.items()]


def _sources(facts: Facts) -> list[str]:
    curves, values = facts.curves_group, facts.values_group
    stated = []
    if curves is not None:
        pattern = tr(
            "[1] Curves, peaks, GVS: {n} {group}, {speed} m/s, optical markers. {source}. Values and SD "
            "are taken from the mean curve, which has no SD of the range of motion."
        )
        speed = fixed(curves.speed_m_s, 2)
        stated.append(
            pattern.format(n=curves.n, group=tr(curves.group), speed=speed, source=_derived(curves.derivation))
        )
    if values is not None:
        pattern = tr(
            "[2] Time and distance: {group}, optical markers and force plates; speed class "
            "“{speed_class}” by Froude number ({speed} m/s, n = {n}). {source}."
        )
        stated.append(
            pattern.format(
                group=tr(values.group),
                speed_class=speed_class_in_words(values.speed_class),
                speed=fixed(values.speed_m_s, 2),
                n=values.n,
                source=_derived(values.derivation),
            )
        )
    return stated or [why_no_band(facts, facts.bands.why_no_values)]


def _derived(derivation: str) -> str:
    """Name the source and who derived its figures: the citation stays as it was published."""
    return tr("{published}, as derived by {derivation}").format(published=PUBLISHED, derivation=derivation)


def _made(made_at: datetime) -> str:
    return tr("Report created {moment}.").format(moment=f"{made_at:%Y-%m-%d %H:%M %z}".strip())
