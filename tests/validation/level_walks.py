"""Count level strides that are called stairs, on simulated walks of every kind and on people's recordings.

    python -m tests.validation.level_walks [--walks 50] [--first 0]

Each kind of walk breaks a rule that judges a stride by itself: people, straps, sensors, rates and belts as unkind as
those of strangers. Beside what a walk's runs of steps show, what each stride's own climb would say, as it does where
stairs are declared; then stairs that nobody declared. The recordings are used where GAITWRIGHT_TEST_DATA names the
shared folder: as they are, in pieces of seven contacts, and with accelerometers that are off.
"""

import os
import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from core.body import Segment, Side, Site
from core.gait.events import FootEvents, detect_events
from core.gait.strides import Reason, Strides, strides_of_feet
from core.samples import ImuBlock, RateKind
from core.session import Recording, RecordingKind, Session
from core.signal.sensors import SensorTracks
from devices.files.session_folder import read_session
from devices.files.xsens_mtmanager import mtmanager_trial
from devices.simulation.walker import (
    PEOPLE,
    CourseKind,
    Manner,
    SensorErrors,
    Standing,
    Tissue,
    Treadmill,
    Walk,
    WalkerSettings,
    simulate,
)
from devices.simulation.walker_courses import draw_course, simulate_course
from tests.benchmarks.gait import recorded_foot
from tests.driver import options
from tests.trials_of_files import import_with

FEET = {side: Site(f"{side}_{Segment.FOOT}") for side in Side}
ERRORS = SensorErrors(acc_bias_sd_m_s2=0.05)
RATES_HZ = (60.0, 75.0, 100.0, 128.0, 200.0)
HARDLY_ROLL, ON_TOES = (Manner.SHUFFLING, Manner.FLAT, Manner.DRAGGING), (Manner.TOES, Manner.TOE_FIRST)
PIECE_S = 8.0  # of a recording: six strides of each foot and more
ON_STAIRS = (Reason.STAIRS_UP, Reason.STAIRS_DOWN)

Feet = dict[Side, list[FootEvents]]


@dataclass(slots=True)
class WalksSeen:
    """Walks, their strides, those called stairs, and those that would be if each were judged by itself."""

    walks: int = 0
    strides: int = 0
    stairs: int = 0
    by_itself: int = 0

    def add(self, events: Feet) -> None:
        self.walks += 1
        self.strides += sum(len(strides) for strides in strides_of_feet(events).values())
        self.stairs += stairs_in(events)
        self.by_itself += stairs_in(events, are_declared=True)


def stairs_in(events: Feet, *, are_declared: bool = False) -> int:
    """How many strides of both feet are called stairs."""
    found: Mapping[Side, Strides] = strides_of_feet(events, are_stairs_declared=are_declared)
    return sum(reason in ON_STAIRS for strides in found.values() for reason in strides.reason)


def events_of(session: Session) -> Feet:
    """The events of both feet in the last recording."""
    recording = session.recordings[-1]
    tracks = SensorTracks(session, session.recordings, frozenset(), RateKind.INSTANTANEOUS)
    block = tracks.blocks(recording)[0]
    found: Feet = {}
    for side, site in FEET.items():
        pairs = zip(tracks.foot_motions(recording, site, block), tracks.oriented(recording, site, block), strict=True)
        found[side] = [detect_events(motion, worn.track.is_measured) for motion, worn in pairs]
    return found


def a_walk(rng: np.random.Generator) -> Walk:
    return Walk(speed_m_s=float(rng.uniform(0.6, 1.7)), strides=int(rng.integers(9, 17)))


def somebody(rng: np.random.Generator, walk: Walk) -> WalkerSettings:
    """Walks with a sensor on each foot; what the sensors are like, and the tissue under them, is chance."""
    return WalkerSettings(
        seed=int(rng.integers(2**31)),
        recordings=(Standing(), walk),
        sites=tuple(FEET.values()),
        tissue=list(Tissue)[int(rng.integers(len(Tissue)))],
        rate_hz=float(rng.choice(RATES_HZ)),
        errors=ERRORS,
        variation=PEOPLE,
    )


def one_of(rng: np.random.Generator, manners: tuple[Manner, ...]) -> Manner:
    return manners[int(rng.integers(len(manners)))]


def turning(rng: np.random.Generator) -> WalkerSettings:
    return somebody(rng, replace(a_walk(rng), turn_rad=float(rng.choice([-np.pi, np.pi]))))


def on_a_belt(rng: np.random.Generator) -> WalkerSettings:
    belt = Treadmill(ripple=float(rng.uniform(0.0, 0.08)), slope=float(rng.choice([0.0, rng.uniform(0.0, 0.12)])))
    return somebody(rng, replace(a_walk(rng), treadmill=belt))


def loosely_strapped(rng: np.random.Generator) -> WalkerSettings:
    straps = {site: float(rng.uniform(0.5, 2.0)) for site in FEET.values()}
    return replace(somebody(rng, a_walk(rng)), loose_straps=straps)


def asymmetric(rng: np.random.Generator) -> WalkerSettings:
    """After a stroke, with a prosthesis, or with a stiff knee or ankle on one side."""
    side, kind = list(Side)[int(rng.integers(2))], int(rng.integers(4))
    walk = replace(a_walk(rng), speed_m_s=float(rng.uniform(0.4, 1.2)))
    if kind < 2:
        return somebody(rng, replace(walk, manner_of_side={side: (Manner.HEMIPARETIC, Manner.STIFF)[kind]}))
    made = somebody(rng, walk)
    return replace(made, prosthetic_side=side) if kind == 2 else replace(made, stiff_knee_side=side)


def badly_measured(rng: np.random.Generator) -> WalkerSettings:
    """Accelerometers that end at 2 to 4 g, or whose scale is off, one foot's more than the other's."""
    errors = {}
    for site in FEET.values():
        range_m_s2, scale_sd = float(rng.choice([2.0, 3.0, 4.0])) * 9.81, float(rng.uniform(0.003, 0.03))
        errors[site] = replace(ERRORS, acc_range_m_s2=range_m_s2, acc_scale_sd=scale_sd)
    return replace(somebody(rng, a_walk(rng)), site_errors=errors)


KINDS: Mapping[str, Callable[[np.random.Generator], WalkerSettings]] = {
    "0.6 to 1.7 m/s": lambda rng: somebody(rng, a_walk(rng)),
    "0.3 to 0.6 m/s": lambda rng: somebody(rng, replace(a_walk(rng), speed_m_s=float(rng.uniform(0.3, 0.6)))),
    "six strides": lambda rng: somebody(rng, replace(a_walk(rng), strides=6)),
    "U-turn": turning,
    "treadmill": on_a_belt,
    "loose straps": loosely_strapped,
    "asymmetric": asymmetric,
    "feet that hardly roll": lambda rng: somebody(rng, replace(a_walk(rng), manner=one_of(rng, HARDLY_ROLL))),
    "on the toes": lambda rng: somebody(rng, replace(a_walk(rng), manner=one_of(rng, ON_TOES))),
    "clipped, off scale": badly_measured,
}


def simulated(kind: str, first: int, walks: int) -> WalksSeen:
    """What is found in simulated walks of one kind."""
    count = WalksSeen()
    for number in range(first, first + walks):
        rng = np.random.default_rng([number, list(KINDS).index(kind)])
        count.add(events_of(simulate(KINDS[kind](rng)).session))
    return count


def walk_of(imu: Mapping[Site, ImuBlock]) -> Session:
    return Session((Recording("walk 1", RecordingKind.WALKING, "walk_1", imu),))


def feet_of_whole_body(data: Path) -> Session:
    with np.load(data / "full_body_free_motion/legs_arms.npz") as held:
        time_s = np.asarray(held["t"], dtype=np.float64)
        imu = {}
        for side, site in FEET.items():
            gyr, acc = (held[f"foot_{side}_{kind}"].astype(np.float64) for kind in ("gyr", "acc"))
            imu[site] = ImuBlock(site, time_s, gyr, acc)
    return walk_of(imu)


def feet_of_opensense(data: Path) -> Session:
    folder = data / "vendor_exports/xsens_mtmanager"
    sensors = ET.parse(folder / "OpenSenseExample_myIMUMappings.xml").iter("ExperimentalSensor")
    names = {sensor.findtext("name_in_model"): sensor.attrib["name"] for sensor in sensors}
    worn = {site: names[f"calcn_{side[0]}_imu"] for side, site in FEET.items()}
    files = sorted(folder.glob("OpenSenseExample_*.txt"))
    return walk_of(import_with(mtmanager_trial, files, worn, "walk 1").imu)


def session_at(folder: str) -> Callable[[Path], Session]:
    return lambda data: read_session(data / folder)


# everybody who walks on level ground in the shared recordings
RECORDED: Mapping[str, Callable[[Path], Session]] = {
    **{f"stroke0{number}": session_at(f"stroke_treadmill/stroke0{number}") for number in range(1, 7)},
    "feet beside optics": lambda data: walk_of({site: recorded_foot(data, side) for side, site in FEET.items()}),
    "free motion": feet_of_whole_body,
    "OpenSense": feet_of_opensense,
    **{name: session_at(f"cases/{name}") for name in ("clipped-at-2g", "pause-in-a-walk")},
}


def in_pieces(session: Session) -> Iterator[Session]:
    """The walk in pieces of `PIECE_S`, as short as many are."""
    walk = session.recordings[-1]
    last_s = max(float(block.time_s[-1]) for block in walk.imu.values())
    for from_s in np.arange(min(float(block.time_s[0]) for block in walk.imu.values()), last_s, PIECE_S):
        rows = {
            site: block.select((block.time_s >= from_s) & (block.time_s < from_s + PIECE_S))
            for site, block in walk.imu.items()
            if site in FEET.values()
        }
        yield replace(session, recordings=(*session.recordings[:-1], replace(walk, imu=rows)))


def made_worse(session: Session, seed: int) -> Session:
    """The same with accelerometers that are off by 0.05 m/s2 and 0.3 % (standard deviations)."""
    rng = np.random.default_rng(seed)
    walk = session.recordings[-1]
    imu = {
        site: replace(block, acc_m_s2=block.acc_m_s2 * rng.normal(1.0, 0.003, 3) + rng.normal(0.0, 0.05, 3))
        for site, block in walk.imu.items()
    }
    return replace(session, recordings=(*session.recordings[:-1], replace(walk, imu=imu)))


def recorded(session: Session) -> WalksSeen:
    """What is found in a recording as it is, in pieces, and made worse."""
    count = WalksSeen()
    for walk in (session, *in_pieces(session), *(made_worse(session, seed) for seed in range(3))):
        count.add(events_of(walk))
    return count


def on_stairs(first: int, courses: int) -> tuple[int, int, int]:
    """Strides on stairs that are there, that are found undeclared, and level ones that are called stairs."""
    there = found = level = 0
    for seed in range(first, first + courses):
        made = simulate_course(draw_course(CourseKind.STAIRS, seed))
        for side, strides in strides_of_feet(events_of(made.session)).items():
            for end_s, reason in zip(strides.end_s, strides.reason, strict=True):
                contact = int(np.argmin(np.abs(made.truth.contacts_s - end_s)))  # the feet land by turns
                is_there = abs(made.truth.climbs_m[side][contact // 2]) > 0.01
                there += is_there
                found += is_there and reason in ON_STAIRS
                level += not is_there and reason in ON_STAIRS
    return there, found, level


def main() -> None:
    required = options(__doc__, walks=(50, "of each kind"), first=(0, "the first seed"))
    print("| walks | how many | strides | called stairs, each by itself | by a run of steps |\n|---|---|---|---|---|")
    for kind in KINDS:
        print(row(kind, simulated(kind, required.first, required.walks)), flush=True)
    data = os.environ.get("GAITWRIGHT_TEST_DATA")
    for name, read in RECORDED.items() if data else ():
        print(row(name, recorded(read(Path(data or "")))), flush=True)
    there, found, level = on_stairs(required.first, max(1, 2 * required.walks // 5))
    print(f"\nStairs that nobody declared: {found} of {there} strides found, {level} level ones called stairs.")


def row(name: str, count: WalksSeen) -> str:
    return f"| {name} | {count.walks} | {count.strides} | {count.by_itself} | {count.stairs} |"


if __name__ == "__main__":
    main()
