"""Count how often a difference is called larger than its error where nothing differs.

    GAITWRIGHT_TEST_DATA=... python -m tests.benchmarks.null_differences [--walks 200] [--parts 2 3]

Every walk is cut into halves and thirds, which are analysed as conditions of one session: walks of people after a
stroke, both feet beside optics, and simulated walks with tissue as loose as real one. Required: at most 5 % of the
judged rows called larger, and at most 5 % of the sessions with any sentence.
"""

import argparse
import os
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from app.summary.differences import comparisons_of, rows_of
from core.analysis import analyse
from core.body import Site
from core.samples import ImuBlock, Recording, RecordingKind, Session
from core.verdicts.measurement_error import Judgement
from devices.files.session_folder import read_session
from devices.simulation.walker import FreeMotion, Standing, Tissue, Walk, WalkerSettings, simulate
from tests.benchmarks.cuts import cut

JUDGED = (Judgement.EXCEEDS_ERROR, Judgement.INSIDE_ERROR)
STRIDES = 45  # thirds have ten and more used


@dataclass(frozen=True, slots=True)
class Tally:
    """Rows judged, rows called larger, whether any is worth a sentence; which columns were called larger."""

    judged: int
    larger: int
    has_sentence: bool
    columns: tuple[str, ...]


def tally(session: Session) -> Tally:
    """All differences between the conditions of one session."""
    analysis = analyse(session)
    found = comparisons_of([(session, analysis)])
    rows = [row for comparison in found for row in rows_of(comparison)]
    judged = [row for row in rows if row.difference.judgement in JUDGED]
    larger = [row for row in judged if row.difference.exceeds]
    return Tally(
        len(judged),
        len(larger),
        any(row.is_reported and row.difference.is_worth_a_sentence for one in found for row in one.rows),
        tuple(f"{row.side} {row.parameter}" for row in larger),
    )


def real_walks(data: Path) -> Iterator[tuple[str, Session]]:
    """The walks of strangers."""
    for folder in sorted((data / "stroke_treadmill").glob("stroke*")):
        yield folder.name, read_session(folder)
    yield "feet beside optics", optical_feet(data)


def optical_feet(data: Path) -> Session:
    """Both feet of one healthy person."""
    with np.load(data / "feet_mocap_events" / "healthy_feet.npz") as archive:
        found = {name: np.asarray(archive[name], dtype=float) for name in archive.files}
    rate_hz = float(found["fs"])
    imu = {}
    for side in ("left", "right"):
        acc, gyr = found[f"{side}_foot_acc"], found[f"{side}_foot_gyr"]
        imu[Site(f"{side}_foot")] = ImuBlock(side, np.arange(len(acc)) / rate_hz, gyr, acc)
    return Session((Recording("walk", RecordingKind.WALKING, "walk", imu),))


def simulated_walk(seed: int) -> Session:
    motions = (Standing(), FreeMotion(), Walk(strides=STRIDES))
    return simulate(WalkerSettings(seed=seed, tissue=Tissue.REAL, recordings=motions)).session


def tally_simulated(seed: int, parts: int) -> Tally:
    return tally(cut(simulated_walk(seed), parts))


def report(name: str, found: list[Tally]) -> str:
    judged, larger = sum(one.judged for one in found), sum(one.larger for one in found)
    sentences = sum(one.has_sentence for one in found)
    share = 100.0 * larger / max(judged, 1)
    return f"{name:34} {judged:6} {larger:6} {share:6.1f} %   {sentences:3} of {len(found)} with a sentence"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--walks", type=int, default=200)
    parser.add_argument("--parts", type=int, nargs="+", default=[2, 3])
    parser.add_argument("--workers", type=int, default=1)
    required = parser.parse_args()
    reported = os.environ.get("GAITWRIGHT_TEST_DATA")
    print(f"{'walks':34} {'judged':>6} {'larger':>6}")
    for parts in required.parts:
        if reported:
            real = {name: tally(cut(session, parts)) for name, session in real_walks(Path(reported))}
            for name, one in real.items():
                print(report(f"{name}, in {parts}", [one]), *one.columns)
            print(report(f"strangers, in {parts}", list(real.values())))
        with ProcessPoolExecutor(required.workers) as pool:
            found = list(pool.map(partial(tally_simulated, parts=parts), range(required.walks)))
        print(report(f"simulated, real tissue, in {parts}", found))
        print("  called larger:", dict(Counter(name for one in found for name in one.columns)))


if __name__ == "__main__":
    main()
