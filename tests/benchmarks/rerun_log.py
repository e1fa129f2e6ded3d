"""Time to write a session for Rerun, its size, and whether it is what was recorded.

    python -m tests.benchmarks.rerun_log [--minutes 10] [--repeats 3]

Six sensors at 100 Hz, one simulated minute of walking stated over and over. The file is checked by `rerun rrd verify`,
then every sample and every angle is read back from it and compared.
"""

import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path
from statistics import median

import numpy as np
from rerun.chunk import RrdReader

from app.review.rerun_log import write_log
from core.analysis import analyse
from core.results import Analysis
from core.samples import FloatArray
from core.session import Session
from devices.simulation.walker import FreeMotion, Standing, Walk, WalkerSettings, simulate
from tests.benchmarks.long import STRIDES, repeated
from tests.driver import options

ROUNDING_S = 1.5e-9  # a timeline ticks in nanoseconds


def session_of(minutes: float) -> Session:
    """Standing, free motion and one walk, `minutes` long."""
    made = simulate(WalkerSettings(recordings=(Standing(), FreeMotion(), Walk(strides=STRIDES)))).session
    *calibrating, walk = made.recordings
    long = replace(walk, imu={site: repeated(block, 60 * minutes) for site, block in walk.imu.items()})
    return replace(made, recordings=(*calibrating, long))


def verified(path: Path) -> bool:
    """Whether Rerun's own program finds the file whole."""
    command = [sys.executable, "-m", "rerun", "rrd", "verify", str(path)]
    return subprocess.run(command, check=False, capture_output=True).returncode == 0


def differing(session: Session, analysis: Analysis, path: Path) -> list[str]:
    """Give the entities of the walk that do not read back as they were recorded and computed, to the last bit."""
    walk, angles = session.recordings[-1], analysis.recordings[-1]
    expected = {f"/raw/{site}/angular_rate": (block.time_s, block.gyr_rad_s) for site, block in walk.imu.items()}
    expected |= {f"/raw/{site}/specific_force": (block.time_s, block.acc_m_s2) for site, block in walk.imu.items()}
    for joint, angle in angles.joints.items():
        for name, angle_rad in (("result", angle.angle_rad), ("published", angle.published_rad)):
            expected[f"/angles/{joint}/{name}"] = angles.time_s, np.rad2deg(angle_rad)[:, None]
    found: dict[str, tuple[list[FloatArray], list[FloatArray]]] = {entity: ([], []) for entity in expected}
    for chunk in RrdReader(path).stream():
        if chunk.entity_path in found and "walking_1" in chunk.timeline_names:
            batch = chunk.to_record_batch()
            times, values = found[chunk.entity_path]
            times.append(batch.column("walking_1").cast("int64").to_numpy() / 1e9)
            values.append(np.array(batch.column("Scalars:scalars").to_pylist(), dtype=float))
    wrong = []
    for entity, recorded in expected.items():
        times, parts = found[entity]
        if not parts or not _are_equal(recorded, (np.concatenate(times), np.concatenate(parts))):
            wrong.append(entity)
    return wrong


def _are_equal(one: tuple[FloatArray, FloatArray], other: tuple[FloatArray, FloatArray]) -> bool:
    return (
        len(one[0]) == len(other[0])
        and np.allclose(one[0], other[0], rtol=0, atol=ROUNDING_S)
        and np.array_equal(one[1], other[1], equal_nan=True)
    )


def main() -> None:
    required = options(__doc__, minutes=10.0, repeats=3)
    session = session_of(required.minutes)
    analysis = analyse(session)
    with tempfile.TemporaryDirectory() as folder:
        path, walls, cpus = Path(folder) / "session.rrd", [], []
        for _ in range(required.repeats):
            wall, cpu = time.perf_counter(), time.process_time()
            write_log(session, analysis, path)
            walls.append(time.perf_counter() - wall)
            cpus.append(time.process_time() - cpu)
        wrong = differing(session, analysis, path)
        stated = f"{median(walls):.2f} s (first {walls[0]:.2f} s; processor {median(cpus):.2f} s)"
        size = f"{path.stat().st_size / 1e6:.1f} MB"
        print(f"{required.minutes:g} min: {stated}, {size}; {len(wrong)} entities differ {wrong}", flush=True)
        print(f"rerun rrd verify {'passes' if verified(path) else 'FAILS'}")


if __name__ == "__main__":
    main()
