"""Share of what is not reported, and why. Of healthy simulated walks, and of the walks of strangers.

    `GAITWRIGHT_TEST_DATA=... python -m tests.benchmarks.withheld [--seeds 20]`

Required: at most 5 % of the joints of healthy simulated walks, walks without free motion included.
"""

import os
from collections import Counter
from collections.abc import Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import partial
from pathlib import Path

from core.analysis import analyse
from core.session import RecordingKind, Session
from core.verdicts.model import Assessment
from devices.simulation.walker import PEOPLE, FreeMotion, Standing, Tissue, Walk, WalkerSettings, simulate
from tests.benchmarks.null_differences import real_walks
from tests.driver import options

WALK = Walk(strides=16)
MOTIONS = {
    "all three recordings": (Standing(), FreeMotion(), WALK),
    "no free motion": (Standing(), WALK),
}
PARTS = ("shape", "height", "timing", "distance", "between")

Stated = tuple[str, str, tuple[str, ...]]
"""Part, verdict, and the gates that decided it."""


def stated_of(session: Session) -> list[Stated]:
    """Every verdict of every walk of a session."""
    found: list[Stated] = []
    for recording in analyse(session).recordings:
        if recording.kind is not RecordingKind.WALKING:
            continue
        verdicts = recording.verdicts
        for joint in verdicts.joints.values():
            found += [_stated("shape", joint.shape), _stated("height", joint.height)]
        for leg in verdicts.legs.values():
            found += [_stated("timing", leg.timing), _stated("distance", leg.distance)]
        found.append(_stated("between", verdicts.between))
    return found


def _stated(part: str, found: Assessment) -> Stated:
    gates = {reason.gate for reason in found.reasons if reason.verdict is found.verdict}
    return part, str(found.verdict), tuple(sorted(gates))


def of_seed(seed: int, tissue: Tissue, motions: str, rate_hz: float) -> list[Stated]:
    settings = WalkerSettings(seed=seed, tissue=tissue, rate_hz=rate_hz, variation=PEOPLE, recordings=MOTIONS[motions])
    session = simulate(settings).session
    # as a recording of strangers comes: nothing is known of its clocks
    sensors = {site: replace(info, clock="") for site, info in session.sensors.items()}
    return stated_of(replace(session, sensors=sensors))


def lines(name: str, found: Iterable[Stated]) -> Iterator[str]:
    everything = list(found)
    for part in PARTS:
        mine = [stated for stated in everything if stated[0] == part]
        if not mine:
            continue
        counts = Counter(verdict for _, verdict, _ in mine)
        share = {verdict: 100.0 * counts[verdict] / len(mine) for verdict in ("read", "care", "withheld")}
        gates = Counter(gate for _, verdict, why in mine if verdict in ("care", "withheld") for gate in why)
        why = ", ".join(f"{gate} {count}" for gate, count in gates.most_common(5))
        figures = " | ".join(f"{share[verdict]:.0f} %" for verdict in share)
        yield f"| {name} | {part} | {len(mine)} | {figures} | {why} |"


def main() -> None:
    required = options(__doc__, seeds=20, workers=1)
    print("| walks | part | n | read | care | withheld | gates |")
    reported = os.environ.get("GAITWRIGHT_TEST_DATA")
    if reported:
        for name, session in real_walks(Path(reported)):
            print(*lines(name, stated_of(session)), sep="\n")
    with ProcessPoolExecutor(required.workers) as pool:
        for motions in MOTIONS:
            for tissue in Tissue:
                one = partial(of_seed, tissue=tissue, motions=motions, rate_hz=100.0)
                found = [stated for of_one in pool.map(one, range(required.seeds)) for stated in of_one]
                print(*lines(f"{tissue}, {motions}", found), sep="\n", flush=True)


if __name__ == "__main__":
    main()
