"""Time that a report, and a look at its pages, take. Of the demonstration, and of three conditions; seconds.

python -m tests.benchmarks.report [--repeats 5]
"""

import time
from dataclasses import replace
from datetime import UTC, datetime
from statistics import median

from PySide6.QtGui import QImage

from app.reports.patient.document import ReportPreview, make_report
from app.summary.request import AnalysedVisit, ReportRequest, default_walks
from core.analysis import analyse
from core.session import RecordingKind
from devices.simulation.walker import DEMONSTRATION, FreeMotion, Standing, Walk, simulate
from tests.driver import options

PREVIEW_PPI = 80.0  # of a page beside the words in a window of 1280 x 800


def visit_of(walks: int) -> AnalysedVisit:
    """Give a simulated visit, every walk under a condition of its own."""
    walking = tuple(Walk(name=f"walk {k + 1}", strides=14) for k in range(walks))
    session = simulate(replace(DEMONSTRATION, recordings=(Standing(), FreeMotion(), *walking))).session
    named = tuple(replace(r, condition=r.name if r.kind is RecordingKind.WALKING else "") for r in session.recordings)
    session = replace(session, recordings=named)
    return AnalysedVisit(session, analyse(session))


def main() -> None:
    repeats = options(__doc__, repeats=5).repeats
    for walks in (1, 3):
        visit = visit_of(walks)
        request = ReportRequest(visit, default_walks(visit), datetime.now(UTC), "0")
        walls, cpus = [], []
        for _ in range(repeats + 1):  # the first one also reads the fonts
            wall, cpu = time.perf_counter(), time.process_time()
            make_report(request)
            walls.append(time.perf_counter() - wall)
            cpus.append(time.process_time() - cpu)
        preview, looks, looks_cpus = ReportPreview(), [], []
        for k in range(2 * repeats):
            wall, cpu = time.perf_counter(), time.process_time()
            pages = preview.pages(replace(request, comment=f"Words {k} of the clinician."), PREVIEW_PPI)
            QImage.fromData(pages[0])  # the page that is looked at
            looks.append(time.perf_counter() - wall)
            looks_cpus.append(time.process_time() - cpu)
        stated = f"{walks} walk(s): first {walls[0]:.2f} s, then {median(walls[1:]):.2f} s"
        print(f"{stated} (processor {cpus[0]:.2f} s, {median(cpus[1:]):.2f} s)")
        again = f"with other words {median(looks[1:]):.2f} s, at most {max(looks[1:]):.2f} s"
        stated = f"   a look: first {looks[0]:.2f} s, {again}"
        print(f"{stated} (processor {median(looks_cpus[1:]):.2f} s)")


if __name__ == "__main__":
    main()
