"""Sessions that a batch can be tried with: a thigh and a shank that swing for some seconds, and a simulated walk."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

from core.body import Site
from core.samples import ImuBlock
from core.session import Patient, Recording, RecordingKind, Session
from devices.files.session_folder import write_session
from tests.simulated import SHORT_VISIT, session_of

SECONDS, RATE_HZ = 4, 50
NOBODY = Patient()


def swinging_session(seed: int, patient: Patient = NOBODY, notes: str = "") -> Session:
    """One joint, free motion and a walk without feet: analysed in a fifth of a second."""
    recordings = (
        Recording("free motion", RecordingKind.FREE_MOTION, "free_motion", _swinging(seed)),
        Recording("walk 1", RecordingKind.WALKING, "walk_1", _swinging(seed + 1000)),
    )
    return Session(recordings, patient=patient, notes=notes, started="2026-05-04T10:00:00")


@cache
def walked_session() -> Session:
    """A patient on whom everything was typed that states who it is, with a walk of both legs."""
    session = session_of(SHORT_VISIT)
    recordings = tuple(
        replace(one, condition="barefoot" if one.kind is RecordingKind.WALKING else "", note="Anna Muster limped")
        for one in session.recordings
    )
    patient = Patient("MUSTER-7", 1930, "female", 1.62, 58.5, "C-Leg 4", "cane", "left", "right")
    return replace(
        session,
        recordings=recordings,
        patient=patient,
        operator="Dr. Keller",
        notes="Anna Muster, Bern",
        started="2026-05-04T10:00:00",
    )


def write_swinging(folder: Path, count: int, most_patients: int = 3) -> None:
    """Session folders `visit 000` and so on, each another, of a few patients."""
    for number in range(count):
        patient = Patient(code=f"MUSTER-{number % most_patients}")
        write_session(swinging_session(number, patient), folder / f"visit {number:03d}")


def results_in(out: Path) -> dict[str, bytes]:
    """Every file of the results, by its path; of a report only its kind, since it holds the time of writing."""
    files = {path.relative_to(out).as_posix(): path.read_bytes() for path in sorted(out.rglob("*")) if path.is_file()}
    kept = {name: content for name, content in files.items() if not name.startswith(".gaitwright-batch/")}
    return {name: content[:5] if name.endswith("report.pdf") else content for name, content in kept.items()}


def _swinging(seed: int) -> dict[Site, ImuBlock]:
    rng = np.random.default_rng(seed)
    time_s = np.arange(SECONDS * RATE_HZ) / RATE_HZ
    blocks = {}
    for site, rate in ((Site.LEFT_THIGH, np.sin(3 * time_s)), (Site.LEFT_SHANK, 3 * np.sin(4 * time_s + 1))):
        tilt = np.cumsum(rate) / RATE_HZ
        gyr_rad_s = rng.normal(scale=0.05, size=(len(time_s), 3))
        gyr_rad_s[:, 1] += rate
        acc_m_s2 = 9.81 * np.stack([-np.sin(tilt), 0 * tilt, np.cos(tilt)], axis=1)
        blocks[site] = ImuBlock(str(site), time_s, gyr_rad_s, acc_m_s2 + rng.normal(scale=0.1, size=acc_m_s2.shape))
    return blocks
