"""Measure how much full contact and heel rise scatter within a foot's walk, in every manner and on people's treadmills.

    python -m tests.benchmarks.full_contact [--seeds 3]

Simulated walks against their truth; after a stroke, without a reference, from contact and to toe-off.
"""

import os
from collections import defaultdict
from pathlib import Path

import numpy as np

from core.body import Side
from core.gait.events import FootEvents, gait_of
from core.samples import FloatArray
from devices.simulation.walker import PEOPLE, FootTruth, Manner, Standing, Tissue, Treadmill, Walk, WalkerSettings
from tests.benchmarks.gait_simulated import walks_of
from tests.core.gait.test_stroke_walks import COUNTED, events_of
from tests.driver import options

EVENTS = ("full_contact_s", "heel_rise_s")
SPEEDS_M_S = (0.3, 0.5, 0.8)
BELT = Treadmill(ripple=0.04)
SAME_S = 0.2


def settings(manner: Manner, speed_m_s: float, tissue: Tissue, seed: int) -> WalkerSettings:
    """A walk on a belt; hemiparetic on the left."""
    is_one_sided = manner is Manner.HEMIPARETIC
    walk = Walk(
        speed_m_s=speed_m_s,
        strides=12,
        manner=Manner.ORDINARY if is_one_sided else manner,
        manner_of_side={Side.LEFT: manner} if is_one_sided else {},
        treadmill=BELT,
    )
    return WalkerSettings(seed=seed, recordings=(Standing(), walk), tissue=tissue, variation=PEOPLE)


def late_s(found: FootEvents, truth: FootTruth, event: str) -> FloatArray:
    """By how much an event is late in each swing but the first and the last, less the foot's median."""
    apart = np.abs(found.initial_contact_s - truth.events.initial_contact_s[:, None])
    late = getattr(found, event)[apart.argmin(axis=1)] - getattr(truth.events, event)
    late = late[apart.min(axis=1) < SAME_S][1:-1]
    late = late[np.isfinite(late)]
    return np.asarray(late - np.median(late))


def main() -> None:
    seeds = options(__doc__, seeds=3).seeds
    sd_ms: dict[str, list[float]] = defaultdict(list)
    for manner in Manner:
        for speed_m_s in SPEEDS_M_S:
            for tissue in (Tissue.SOFT, Tissue.REAL):
                late: dict[str, list[FloatArray]] = defaultdict(list)
                for seed in range(seeds):
                    for foot, truth in walks_of(settings(manner, speed_m_s, tissue, seed)).values():
                        found = gait_of(foot)
                        for event in EVENTS:
                            late[event].append(late_s(found, truth, event))
                here = {event: 1000.0 * float(np.std(np.concatenate(late[event]))) for event in EVENTS}
                for event, value in here.items():
                    sd_ms[event].append(value)
                print(
                    manner, speed_m_s, tissue, *(f"{event} {value:.0f} ms" for event, value in here.items()), flush=True
                )
    for event, values in sd_ms.items():
        print(f"{event}: sd {np.mean(values):.1f} ms over all, {np.max(values):.0f} at worst")
    data = os.environ.get("GAITWRIGHT_TEST_DATA")
    for name in COUNTED if data else ():
        for side in Side:
            found, _ = events_of(Path(data or "") / "stroke_treadmill" / name, side)
            loading, lifting = found.full_contact_s - found.initial_contact_s, found.toe_off_s - found.heel_rise_s
            reported = (f"{1000.0 * np.nanstd(values[1:-1]):.0f}" for values in (loading, lifting))
            print(name, side, "contact to full contact {} ms, heel rise to toe-off {} ms".format(*reported), flush=True)


if __name__ == "__main__":
    main()
