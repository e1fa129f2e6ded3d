"""What a prosthetist's bench is shown of: three walks, each with another alignment."""

from types import SimpleNamespace
from typing import Any

from app.wizard.walking.bench_control import Bench
from app.wizard.walking.bench_view import BenchState
from core.alignment import AlignmentChange, PartChange, ProsthesisPart
from core.body import Joint, Side
from core.results import Analysis, Calibration, Method
from core.session import Recording, RecordingKind, Session
from tests.core.verdicts.built_walk import calibrations, judged_walk, leg, walk

PYLON = ProsthesisPart.PYLON
OF_B = AlignmentChange("Alignment A", (PartChange(PYLON, height_mm=3.0),))
OF_C = AlignmentChange("Alignment B", (PartChange(PYLON, height_mm=-1.0),))


def recording(number: int, letter: str, change: AlignmentChange | None = None, **reported: Any) -> Recording:
    name = f"walk {number}"
    return Recording(
        name, RecordingKind.WALKING, name, {}, condition=f"Alignment {letter}", alignment=change, **reported
    )


WALKED = (recording(1, "A"), recording(2, "B", OF_B), recording(3, "C", OF_C))


def bench_visit() -> SimpleNamespace:
    """What the bench asks of a visit: three walks, the left leg prosthetic; the second bends its knee 10° more."""
    legs = (leg(Side.LEFT), leg(Side.LEFT, knee_range_deg=70.0), leg(Side.LEFT, knee_range_deg=71.0))
    walks = tuple(
        judged_walk(walk(left=one, name=f"walk {k}", folder=f"walk {k}")) for k, one in enumerate(legs, start=1)
    )
    span = Calibration(tuple(one.name for one in walks), calibrations())
    analysis = Analysis(Method.ROBUST, is_simulated=True, calibrations=(span,), recordings=walks)
    every = [SimpleNamespace(details=one, read_back=None) for one in WALKED]
    return SimpleNamespace(
        prosthetic_sides=frozenset({Side.LEFT}),
        prosthetic_joints=frozenset({Joint.LEFT_KNEE, Joint.LEFT_ANKLE}),
        recordings=SimpleNamespace(every=every, walks=every),
        evaluation=SimpleNamespace(analysis=analysis, session=Session(WALKED), is_busy=False, has_failed=False),
    )


def state_of(bench: Bench) -> BenchState:
    state = bench.state()
    assert state is not None
    return state
