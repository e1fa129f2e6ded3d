"""Twenty sessions, strangers' among them.

Check that every report is whole and every number that a sentence states is in a file.

    GAITWRIGHT_TEST_DATA=... python -m tests.safety.twenty_reports [--pictures FOLDER]

Of each report: at most four pages and those that were asked for; no page with ink on less than half of its height; the
structure of PDF/UA and PDF/A; every number of page one, and of every sentence of the course, in one of the files beside
it, as rounding makes it; and no two figures for one measure on page one.
"""

import argparse
import csv
import io
import json
import math
import os
import re
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from datetime import UTC, date, datetime
from pathlib import Path
from statistics import fmean
from typing import Any
from uuid import UUID

import numpy as np
import pikepdf
from PIL import Image

from app.exports.result_folder import write_results
from app.reports.patient.document import ReportPreview, make_report, report_data
from app.reports.patient.report_file import write_visits
from app.summary.course import course_of
from app.summary.course_lanes import CourseVisit
from app.summary.request import AnalysedVisit, ReportRequest, default_walks
from core.analysis import analyse
from core.body import LEG_JOINTS, Joint, Side
from core.results import Analysis, ZeroKind
from core.session import RecordingKind, Session
from devices.simulation.walker import DEMONSTRATION, FreeMotion, Standing, Walk, simulate
from tests.app.changed_analysis import recalibrated, with_few_strides
from tests.benchmarks.null_differences import real_walks
from tests.driver import Found, drive

BANDS = Path(__file__).parents[2] / "resources" / "reference_bands"
MADE_AT = datetime(2026, 11, 23, 10, 30, tzinfo=UTC)
PAGES_OF_ONE_WALK = 4
PPI = 60.0
LEAST_INK = 0.5  # of a page's height, between the running head and the foot
HEAD_AND_FOOT = 0.08  # of a page's height, each
NUMBER = re.compile(r"(?<![\w.])\u2212?\d+(?:[.,]\d+)?")
MONTHS = "Jan|Feb|Mar|Mär|Apr|May|Mai|Jun|Jul|Aug|Sep|Oct|Okt|Nov|Dec|Dez"
DATES = re.compile(rf"\d{{1,2}}\.? (?:{MONTHS})\w* ?(?:\d{{4}})?")
ON_CURVES = re.compile(r"^(?:[LR] \u2212?\d|toe-off|.*: \d+\u00b0|.* (?:less|more) than )|\u00b0$")
STATED_OF_METHOD = {"1", "2", "3"}  # "2 SD", visit 1, band [1]


def sessions() -> Iterator[tuple[str, ReportRequest]]:
    """All twenty, those of strangers only where the recordings are at hand."""
    reported = simulate(DEMONSTRATION).session
    base = replace(reported, started="2026-11-23T09:10:00+01:00")
    analysis = analyse(base)

    def of(session: Session, found: Analysis, **more: Any) -> ReportRequest:
        visit = AnalysedVisit(session, found)
        return ReportRequest(visit, default_walks(visit), MADE_AT, "1.0", **more)

    yield "demonstration", of(base, analysis)
    yield "letter", of(base, analysis, paper="letter")
    yield "no standing reference", of(base, recalibrated(analysis, LEG_JOINTS, zero=ZeroKind.NONE))
    yield "axis with care", of(base, recalibrated(analysis, LEG_JOINTS, axis_sd_rad=math.radians(8.0)))
    yield "ankle not reported", of(base, recalibrated(analysis, [Joint.LEFT_ANKLE], axis_sd_rad=math.radians(11.0)))
    yield (
        "knee not reported",
        of(base, recalibrated(analysis, [Joint.RIGHT_KNEE], is_same_joint=False, sign_margin=1.05)),
    )
    yield "sign unclear", of(base, recalibrated(analysis, [Joint.LEFT_KNEE], is_sign_certain=False))
    yield "clocks unknown", of(base, recalibrated(analysis, LEG_JOINTS, lag_sd_s=None, is_clock_shared=False))
    yield "two strides", of(base, with_few_strides(analysis, left=2, right=2))
    yield "five strides", of(base, with_few_strides(analysis, left=5, right=5))
    one_leg = _only(base, lambda site: site.side is Side.LEFT)
    yield "one leg", of(one_leg, analyse(one_leg))
    no_knee = _only(base, lambda site: "thigh" not in site)
    yield "no knee", of(no_knee, analyse(no_knee))
    no_feet = _only(base, lambda site: "foot" not in site)
    yield "no feet", of(no_feet, analyse(no_feet))
    alignments = _alignments()
    yield "alignments A, B, C", of(alignments, analyse(alignments))
    yield "three visits", of(base, analysis, **_course(base, analysis))
    yield "a confirmed comment", of(base, analysis, comment="Walks further; the left foot drags.", comment_by="Kern")
    earlier = replace(base, started="2026-10-01T09:00:00+01:00")
    yield "an earlier visit", of(base, analysis, earlier=AnalysedVisit(earlier, analysis))
    data = os.environ.get("GAITWRIGHT_TEST_DATA", "")
    for name, session in real_walks(Path(data)) if data else ():
        yield name, of(session, analyse(session))


def _only(session: Session, is_worn: Any) -> Session:
    recordings = tuple(
        replace(one, imu={site: block for site, block in one.imu.items() if is_worn(site)})
        for one in session.recordings
    )
    return replace(session, recordings=recordings)


def _alignments() -> Session:
    walks = tuple(Walk(name=f"walk {k}", strides=13, speed_m_s=speed) for k, speed in ((1, 1.05), (2, 1.15), (3, 1.2)))
    settings = replace(DEMONSTRATION, seed=7, prosthetic_side=Side.RIGHT)
    reported = simulate(replace(settings, recordings=(Standing(), FreeMotion(), *walks))).session
    letters = iter("ABC")
    recordings = tuple(
        replace(one, condition=f"alignment {next(letters)}") if one.kind is RecordingKind.WALKING else one
        for one in reported.recordings
    )
    return replace(reported, recordings=recordings, started="2026-11-20T09:42:00+01:00")


def _course(session: Session, analysis: Analysis) -> dict[str, Any]:
    """Two earlier visits at which the left knee bent less and less, walked by the same simulated patient."""
    found = []
    for number, (day, share) in enumerate(((date(2026, 9, 2), 0.5), (date(2026, 10, 7), 0.75))):
        walks = []
        for one in analysis.recordings:
            gait = dict(one.gait)
            if Side.LEFT in gait:
                parameters = dict(gait[Side.LEFT].parameters)
                parameters["knee_stance_to_swing_rad"] = share * parameters["knee_stance_to_swing_rad"]
                gait[Side.LEFT] = replace(gait[Side.LEFT], parameters=parameters)
            walks.append(replace(one, gait=gait))
        before = course_of(replace(analysis, recordings=tuple(walks)), session.recordings)
        found.append(CourseVisit(UUID(int=number), day, before))
    found.append(CourseVisit(UUID(int=9), date(2026, 11, 23), course_of(analysis, session.recordings)))
    return {"course": tuple(found)}


def sentences_of(data: dict[str, Any]) -> list[str]:
    """All that a reader takes away: every text of page one, and the sentences of the course."""
    stated = texts_of_page_one(data["first_page"])
    for page in data["pages"]:
        for block in page:
            if block["kind"] == "bullets":
                stated += block["said"]
    return stated


def texts_of_page_one(first: dict[str, Any]) -> list[str]:
    """Sentences, values, rows, and what is written on the curves; not who was measured, nor what a clinician wrote."""
    stated = [first["summary"]["first"], first["summary"]["then"], *first["quality"], *first["source"]]
    stated += (first["caution"] or {}).values()
    for tile in first["tiles"]:
        stated += [*(value["text"] for value in tile["values"]), tile["change"], tile["then"]]
    for row in (first["table"] or {"rows": []})["rows"]:
        stated += [*row["values"], row["difference"], row["between"], row["reference"], row["since"]]
    for chart in first["charts"][0]:
        drawn = re.findall(r">([^<>]+)</text>", chart["picture"]["svg"]) if "picture" in chart else []
        stated += [words for words in drawn if ON_CURVES.search(words)]
    return [words for words in stated if words]


def contradictions(first: dict[str, Any]) -> Iterator[str]:
    """Where page one has two figures for one measure: in sentence, tile, row and bracket of the knee."""
    name, shown = "Knee flexion, stance to swing", {side: set[str]() for side in "LR"}
    for row in (first["table"] or {"rows": []})["rows"]:
        if row["name"].startswith(name) and len(row["values"]) == len(shown):
            for side, value in zip(shown, row["values"], strict=True):
                shown[side] |= {
                    f"{round(number)}" for number in [_number(value.rstrip("\u00b0 *"))] if number is not None
                }
    for value in next(tile["values"] for tile in first["tiles"] if tile["name"].startswith("Knee")):
        side = {"left": "L", "right": "R"}.get((value["chip"] or {}).get("alt", ""), "")
        if side and value["text"].endswith("\u00b0"):
            shown[side].add(value["text"].rstrip("\u00b0"))
    if found := re.match(r"(Left|Right) knee flexes (\d+)\u00b0 from stance to swing", first["summary"]["first"]):
        shown[found[1][0]].add(found[2])
    for side, values in shown.items():
        if len(values) > 1:
            yield f"{name}, {side}: {' and '.join(sorted(values))}"


def numbers_in_files(folder: Path) -> set[float]:
    """Every number of every table and summary, with the means of the columns over the strides used."""
    values: list[float] = []
    for path in folder.rglob("*.csv"):
        if path.name in ("angles.csv", "columns.csv"):
            continue
        with path.open(encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        values += [number for row in rows for cell in row.values() if (number := _number(cell)) is not None]
        used = [row for row in rows if row.get("used") == "true"]
        for name in used[0] if used else ():
            for side in Side:
                numbers = [n for row in used if row.get("side") == side and (n := _number(row[name])) is not None]
                values += [fmean(numbers)] if numbers else []
    values += _all_numbers(json.loads((folder / "summary.json").read_text(encoding="utf-8")))
    return {abs(value) for value in values if math.isfinite(value)}


def numbers_of_bands() -> set[float]:
    """What the cited groups' files hold; a stride is two steps."""
    values: set[float] = set()
    for path in BANDS.glob("*.csv"):
        lines = [line for line in path.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
        values |= {n for row in csv.reader(lines) for cell in row if (n := _number(cell)) is not None}
    return values | {2 * value for value in values}


def _number(cell: str | None) -> float | None:
    try:
        return float(cell or "")
    except ValueError:
        return None


def _all_numbers(part: Any) -> list[float]:
    if isinstance(part, dict):
        return [number for inner in part.values() for number in _all_numbers(inner)]
    if isinstance(part, list):
        return [number for inner in part for number in _all_numbers(inner)]
    return [float(part)] if isinstance(part, int | float) and not isinstance(part, bool) else []


def unknown_numbers(sentence: str, known: set[float]) -> list[str]:
    """Numbers of a sentence that no file holds, as they would be rounded to it."""
    found = []
    for word in NUMBER.findall(DATES.sub(" ", sentence)):
        plain = word.replace("\u2212", "").replace(",", ".")
        decimals = len(plain.partition(".")[2])
        half = 0.5 * 10.0**-decimals * 1.001
        if plain not in STATED_OF_METHOD and not any(abs(value - float(plain)) <= half for value in known):
            found.append(word)
    return found


def ink_heights(pages: list[bytes]) -> list[float]:
    """How far down each page its ink reaches, as a share of the room between head and foot."""
    found = []
    for page in pages:
        grey = np.asarray(Image.open(io.BytesIO(page)).convert("L"))
        first, last = (round(grey.shape[0] * share) for share in (HEAD_AND_FOOT, 1 - HEAD_AND_FOOT))
        rows = np.flatnonzero((grey[first:last] < 200).any(axis=1))
        found.append(float((rows[-1] + 1) / (last - first)) if len(rows) else 0.0)
    return found


def structure_faults(pdf: bytes) -> Iterator[str]:
    """What of PDF/UA-1 and PDF/A-2a is missing."""
    with pikepdf.open(io.BytesIO(pdf)) as document:
        if (
            "/MarkInfo" not in document.Root
            or not document.Root.MarkInfo.Marked
            or "/StructTreeRoot" not in document.Root
        ):
            yield "not tagged"
        if "/Lang" not in document.Root:
            yield "without a language"
        with document.open_metadata() as metadata:
            if metadata.get("pdfuaid:part") != "1":
                yield "not marked as PDF/UA-1"
            if (metadata.get("pdfaid:part"), metadata.get("pdfaid:conformance")) != ("2", "A"):
                yield "not marked as PDF/A-2a"
        figures, headings = 0, []
        for node in _nodes(document.Root.StructTreeRoot.K):
            kind = str(node.get("/S", ""))
            figures += kind == "/Figure" and not str(node.get("/Alt", ""))
            if re.fullmatch(r"/H\d", kind):
                headings.append(int(kind[2:]))
        if figures:
            yield f"{figures} figures without words"
        if any(after > before + 1 for before, after in zip([0, *headings], headings, strict=False)):
            yield "a level of headings is left out"


def _nodes(node: Any) -> Iterator[Any]:
    if isinstance(node, pikepdf.Array):
        for part in node:
            yield from _nodes(part)
    elif isinstance(node, pikepdf.Dictionary):
        yield node
        if "/K" in node:
            yield from _nodes(node.K)


def tried(name: str, request: ReportRequest, pictures: Path | None = None) -> Found:
    """One report, against its files."""
    trial, added = Found(), len(request.walks) > 1 or request.earlier is not None
    pdf, data = make_report(request), report_data(request)
    pages = ReportPreview().pages(request, PPI)
    trial.count["pages"] = len(pages)
    most = PAGES_OF_ONE_WALK + added + bool(request.course)
    if len(pages) > most:
        trial.faults.append(f"{len(pages)} pages, {most} wanted")
    trial.faults += structure_faults(pdf)
    for number, share in enumerate(ink_heights(pages), start=1):
        if share < LEAST_INK:
            trial.faults.append(f"page {number} has ink down to {share:.0%} only")
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        write_results(request.visit.session, request.visit.analysis, folder)
        write_visits(request, folder)
        known = numbers_in_files(folder) | numbers_of_bands()
    known |= _of_earlier_visits(request)
    stated = sentences_of(data)
    trial.count["sentences"] = len(stated)
    trial.faults += contradictions(data["first_page"])
    for sentence in stated:
        if unknown := unknown_numbers(sentence, known):
            trial.faults.append(f"{', '.join(unknown)} is in no file: {sentence}")
    if pictures is not None:
        for number, page in enumerate(ReportPreview().pages(request, 2 * PPI), start=1):
            (pictures / f"{name.replace(' ', '_').replace(',', '')}_{number}.png").write_bytes(page)
    return trial


def _of_earlier_visits(request: ReportRequest) -> set[float]:
    """What is kept of earlier visits is in files of their own: their values, and what they differ by."""
    last = request.course[-1] if request.course else None
    found: set[float] = set()
    for visit in request.course:
        for walked in visit.course.conditions if visit.course is not None else ():
            for figure in walked.figures:
                now = last.course.conditions[0].figure(figure.column, figure.side) if last and last.course else None
                values = [figure.found.mean, 2 * figure.whisker_at(math.nan)]
                if now is not None:
                    error = math.hypot(2 * figure.whisker_at(math.nan), 2 * now.whisker_at(math.nan)) / math.sqrt(2)
                    rounded = abs(round(now.found.mean) - round(figure.found.mean))
                    values += [now.found.mean - figure.found.mean, error, math.ceil(error), rounded]
                found |= {abs(value) for value in values if math.isfinite(value)}
    return found


def run(asked: argparse.Namespace, _: Path) -> Iterator[tuple[str, Found]]:
    if asked.pictures is not None:
        asked.pictures.mkdir(parents=True, exist_ok=True)
    for name, request in sessions():
        yield name, tried(name, request, asked.pictures)


if __name__ == "__main__":
    drive(__doc__, run, pictures={"type": Path, "help": "put every page there as PNG"})
