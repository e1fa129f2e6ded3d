"""T14: 500 hostile names, typed wherever somebody may type one. Check whether any changes anything but its own text.

    python -m tests.safety.hostile_names --count 500

Each name makes a report and a folder of results. In the report's PDF nothing may be alive (no link, no action, no
script, no file), and every number and every word that nobody typed is as in a report with plain names; in the
tables of the results no cell of a name may begin as a formula does.
"""

import csv
import io
import json
import random
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pikepdf

from app.exports.result_folder import write_results
from app.reports.patient.document import make_report, report_data
from app.summary.plain_text import plain
from app.summary.request import AnalysedVisit, ReportRequest
from core.analysis import analyse
from core.session import RecordingKind
from devices.simulation.walker import DEMONSTRATION, FreeMotion, Standing, Walk, simulate
from tests.driver import Found, drive

MADE_AT = datetime(2026, 11, 21, 22, 15, 30, tzinfo=UTC)
ALIVE = {"/Link", "/URI", "/Action", "/JavaScript", "/JS", "/Launch", "/AA", "/OpenAction", "/EmbeddedFile", "/Widget"}
FORMULA = ("=", "+", "-", "@", "\t", "\r")
PLAIN = "Plain"
SEEDS = (
    '#image("/etc/passwd") $x^2$ *bold* _it_ @ref <label> // comment \\ #eval("1")',
    '=HYPERLINK("http://example.org","click")',
    "+cmd|' /C calc'!A0",
    "-2+3+cmd",
    "@SUM(1+1)*cmd",
    "\t=1+1",
    "https://example.org/?q=1 mailto:a@example.org",
    "<script>alert(1)</script>&amp;<svg onload=alert(1)/>",
    "\u202eevil\u202c \u2066x\u2069 \u200f\u061c",
    "מטופל 123, דוד",
    "مريض ١٢٣ محمد",
    "W" * 200,
    "a\x00b\x1bc\x07\ud800\ue000\ufffe",
    "😀漢字 e" + "\u0301\u0323" * 20,
    " \t\u00a0\u3000 ",
    "= Heading\n== Another\n- list\n+ enum",
    "]]}}))\"\"''``{{[[((",
    "{page} {pages} {count} %s %(x)d ${HOME}",
    "\\u{202e} \\n \\0",
    "'; DROP TABLE patients; --",
)
LETTERS = [*range(0x20, 0x7F), *range(0xA0, 0x250), *range(0x300, 0x370), *range(0x590, 0x700)]
LETTERS += [*range(0x2000, 0x2070), *range(0x1F600, 0x1F650), *range(0xE000, 0xE010), 0, 0x1B, 0xD800, 0xFFFF]


def names(count: int) -> Iterator[str]:
    """The seeds, then mixtures of them and of any characters."""
    chance = random.Random(14)
    yield from SEEDS[:count]
    for _ in range(count - len(SEEDS)):
        parts = [chance.choice(SEEDS)[: chance.randrange(60)] if chance.random() < 0.5 else "" for _ in range(2)]
        anything = "".join(map(chr, chance.choices(LETTERS, k=chance.randrange(1, 60))))
        yield f"{parts[0]}{anything}{parts[1]}"


def visit() -> AnalysedVisit:
    """Two short walks of two conditions."""
    walks = (Walk(strides=12), Walk("walk 2", strides=12))
    session = simulate(replace(DEMONSTRATION, recordings=(Standing(), FreeMotion(), *walks))).session
    return AnalysedVisit(session, analyse(session))


def named(plain_visit: AnalysedVisit, name: str) -> ReportRequest:
    """Put the name into every place that somebody can type into; recordings keep theirs, which files give."""
    session = plain_visit.session
    patient = replace(session.patient, code=name, sex=name, device=name, aids=name)
    sensors = {site: replace(sensor, model=name) for site, sensor in session.sensors.items()}
    walking = [recording.name for recording in session.recordings if recording.kind is RecordingKind.WALKING]
    recordings = tuple(
        replace(recording, condition=f"{name}{'' if recording.name == walking[0] else ' '}{recording.name[-1]}")
        if recording.name in walking
        else recording
        for recording in session.recordings
    )
    typed = replace(session, patient=patient, sensors=sensors, recordings=recordings, surface=name, notes=name)
    return ReportRequest(
        AnalysedVisit(typed, plain_visit.analysis),
        tuple(walking),
        MADE_AT,
        "1.2.3",
        comment=name,
        operator=name,
        clinic=name,
    )


def numbers_and_figures(data: dict[str, Any]) -> list[Any]:
    """Give what nobody typed: every table's cells, every picture, what page one reports but of whom."""
    first = data["first_page"]
    found: list[Any] = [first[name] for name in ("summary", "caution", "tiles", "charts", "table", "quality", "source")]
    for block in (block for page in data["pages"] for block in page):
        if block["kind"] == "table" and block["columns"][0]["title"] == "":  # of what is compared, by its names
            found.append([[cell for k, cell in enumerate(row["cells"]) if k != 1] for row in block["rows"]])
        elif block["kind"] == "table":
            found.append(block)
        elif block["kind"] == "figures":
            found.append(block["pictures"])
        elif block["kind"] == "two_columns":  # all but the sensors, which say themselves what they are called
            found.append([text for column in block["columns"] for text in column if text[0] != "Sensors"])
    return found


def texts(pdf: bytes) -> tuple[int, str]:
    """Give the pages' count, and the text of the page of peaks below its head, on which nobody's words stand."""
    import pypdf

    pages = pypdf.PdfReader(io.BytesIO(pdf)).pages
    text = pages[1].extract_text()
    return len(pages), text[text.index("All curves and peaks") : text.index("Research use.")]


def alive_in(pdf: bytes) -> set[str]:
    """Give names of parts of a PDF that do something when it is opened or pressed."""
    with pikepdf.open(io.BytesIO(pdf)) as document:
        found = set()
        for part in document.objects:
            if isinstance(part, pikepdf.Dictionary | pikepdf.Stream):
                dictionary = part.stream_dict if isinstance(part, pikepdf.Stream) else part
                for key, value in dictionary.items():
                    names_of = {str(key)} | ({str(value)} if isinstance(value, pikepdf.Name) else set())
                    found |= names_of & ALIVE
        return found


def formulas_in(folder: Path) -> list[str]:
    """Give cells of any table that a spreadsheet would work out."""
    found = []
    for path in sorted(folder.rglob("*.csv")):
        with path.open(encoding="utf-8", newline="", errors="surrogateescape") as file:
            for row in csv.reader(file):
                found += [cell for cell in row if cell.lstrip().startswith(FORMULA) and not _is_number(cell)]
    return found


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def try_names(count: int) -> Found:
    """Make a report of each name, and of every tenth the results."""
    plain_visit, trial = visit(), Found()
    expected_data = numbers_and_figures(report_data(named(plain_visit, PLAIN)))
    expected = texts(make_report(named(plain_visit, PLAIN)))
    for name in names(count):
        trial.count["names"] += 1
        request = named(plain_visit, name)
        where = f"{plain(name)[:80]!r} {name[:20]!r}"
        stated = json.dumps(numbers_and_figures(report_data(request)), ensure_ascii=False)
        if stated != json.dumps(expected_data, ensure_ascii=False):
            trial.faults.append(f"changed another text: {where}")
        pdf = make_report(request)
        if texts(pdf) != expected:
            trial.faults.append(f"changed another text: {where}")
        if alive_in(pdf):
            trial.faults.append(f"alive in the PDF: {where}")
        with tempfile.TemporaryDirectory() as folder:
            write_results(request.visit.session, request.visit.analysis, Path(folder))
            if formulas_in(Path(folder)):
                trial.faults.append(f"a formula in a table: {where}")
    return trial


if __name__ == "__main__":
    drive(__doc__, lambda asked, _: try_names(asked.count), count=500)
