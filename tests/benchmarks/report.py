"""How long does a report take? Seconds to make one of the demonstration, and of three conditions.

python -m tests.benchmarks.report [--repeats 5]
"""

import argparse
import time
from dataclasses import replace
from datetime import UTC, datetime
from statistics import median

from app.reports.patient_report.document import make_report
from app.reports.patient_report.request import ReportRequest, Visit, default_walks
from core.analysis import analyse
from core.samples import RecordingKind
from devices.walker import DEMONSTRATION, FreeMotion, Standing, Walk, simulate


def visit_of(walks: int) -> Visit:
    """Give a simulated visit, every walk under a condition of its own."""
    walking = tuple(Walk(name=f"walk {k + 1}", strides=14) for k in range(walks))
    session = simulate(replace(DEMONSTRATION, recordings=(Standing(), FreeMotion(), *walking))).session
    named = tuple(replace(r, condition=r.name if r.kind is RecordingKind.WALKING else "") for r in session.recordings)
    session = replace(session, recordings=named)
    return Visit(session, analyse(session))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=5)
    repeats = parser.parse_args().repeats
    for walks in (1, 3):
        visit = visit_of(walks)
        request = ReportRequest(visit, default_walks(visit), datetime.now(UTC), "0")
        walls, cpus = [], []
        for _ in range(repeats + 1):  # the first one also reads the fonts
            wall, cpu = time.perf_counter(), time.process_time()
            make_report(request)
            walls.append(time.perf_counter() - wall)
            cpus.append(time.process_time() - cpu)
        said = f"{walks} walk(s): first {walls[0]:.2f} s, then {median(walls[1:]):.2f} s"
        print(f"{said} (processor {cpus[0]:.2f} s, {median(cpus[1:]):.2f} s)")


if __name__ == "__main__":
    main()
