"""Compare the exactness of rises and turns of timed tests with a pelvis sensor and with thighs and feet alone.

    python -m tests.validation.pelvis_courses [COURSES]

Of simulated courses with all seven sensors, on three kinds of tissue: by how much a rise's beginning and end are off by
the thighs' own tilt (`core.timed.seat`), and by the pelvis (from its pitch passing 10 deg/s, until the thighs are under
15 deg from standing); how many turns feet and pelvis report, and how often they contradict each other.
"""

import sys
from dataclasses import replace

import numpy as np

from core.analysis import analyse
from core.body import LEG_SITES, Site
from core.results import RecordingAnalysis
from core.samples import FloatArray
from core.timed.protocols import PlannedTest, TimedProtocol
from core.timed.seat import seat_motions
from core.verdicts.walk_findings import about_turns
from devices.simulation.walker_body import CourseKind, Tissue
from devices.simulation.walker_courses import CourseTruth, draw_course, simulate_course
from tests.validation.timed_validity import tracks_of

PITCHING_RAD_S, UPRIGHT_RAD = np.deg2rad(10.0), np.deg2rad(15.0)
KINDS = (CourseKind.UP_AND_GO, CourseKind.SIT_TO_STAND)


def by_pelvis(walk: RecordingAnalysis, about_s: float, tilt_rad: FloatArray) -> tuple[float, float]:
    """Beginning and end of the rise about an instant, by the rule above; NaN where it does not hold.

    Parameters
    ----------
    tilt_rad : (n,)
        Of the thighs from standing, at the walk's stamps.
    """
    assert walk.pelvis is not None
    step_s = float(np.median(np.diff(walk.time_s)))
    rate = np.gradient(walk.pelvis.tilt_rad, step_s)
    before = np.flatnonzero((walk.time_s > about_s - 1.5) & (walk.time_s <= about_s) & (rate > PITCHING_RAD_S))
    after = np.flatnonzero((walk.time_s > about_s) & (tilt_rad < UPRIGHT_RAD))
    if not len(before) or not len(after):
        return float("nan"), float("nan")
    begun = before[np.flatnonzero(np.diff(np.concatenate([[-9], before])) > 1)[-1]]
    return float(walk.time_s[begun]), float(walk.time_s[after[0]])


def thigh_tilt(walk: RecordingAnalysis) -> FloatArray:
    """How far the thighs are tilted from standing, by the hips and the pelvis (n,), rad."""
    assert walk.pelvis is not None
    return np.abs(np.mean([hip.angle_rad - walk.pelvis.tilt_rad for hip in walk.hips.values()], axis=0))


def errors_of(walk: RecordingAnalysis, truth: CourseTruth, found: list[tuple[float, float]]) -> list[list[float]]:
    """Beginning and end by thighs, beginning and end by the pelvis, less the truth, s; a row per rise."""
    rows = []
    for (left_s, upright_s), true_left_s, true_upright_s in zip(found, truth.left_seat_s, truth.upright_s, strict=True):
        pelvis = by_pelvis(walk, float(true_left_s), thigh_tilt(walk))
        rows.append(
            [left_s - true_left_s, upright_s - true_upright_s, pelvis[0] - true_left_s, pelvis[1] - true_upright_s]
        )
    return rows


def main(courses: int) -> None:
    """Print the figures of each kind of tissue."""
    for tissue in Tissue:
        rows, turns, contradictions, missing = [], 0, 0, 0
        for seed in range(courses):
            for kind in KINDS:
                course = replace(draw_course(kind, seed), sites=(*LEG_SITES, Site.PELVIS), tissue=tissue)
                made = simulate_course(course)
                *before, last = made.session.recordings
                planned = PlannedTest(TimedProtocol(kind.value))
                session = replace(made.session, recordings=(*before, replace(last, test=planned)))
                walk = analyse(session).recordings[-1]
                seat = seat_motions(*tracks_of(made.session))
                rises = [(rise.left_seat_s, rise.upright_s) for rise in seat.rises]
                if walk.pelvis is None or len(walk.hips) < 2 or len(rises) != len(made.truth.left_seat_s):
                    missing += 1
                    continue
                rows += errors_of(walk, made.truth, rises)
                turns += len(made.truth.turns)
                contradictions += len(about_turns(walk))
        table = np.abs(np.array(rows).reshape(-1, 4))
        print(f"\n{tissue.value}: {2 * courses} courses, {len(rows)} rises, {missing} without a pelvis or a rise")
        for name, column in zip(("thighs begin", "thighs end", "pelvis begin", "pelvis end"), table.T, strict=True):
            known = column[np.isfinite(column)]
            if len(known):
                print(f"  {name:13s} median {np.median(known):.3f} s, worst {known.max():.3f} s, of {len(known)}")
        print(f"  {turns} turns, {contradictions} courses whose feet and pelvis tell others")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 20)
