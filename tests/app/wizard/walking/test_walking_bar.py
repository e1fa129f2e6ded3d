"""The bar below the Walking step: its quiet actions do what they say, and what is no walk is not called one."""

from functools import partial
from types import SimpleNamespace
from typing import Any, cast

import pytest

from app.editing.session_recording import Ongoing
from app.storage.stored import RecordingState
from app.widgets.action_bar import BarAction
from app.wizard.visit import Visit
from app.wizard.walking.bench_control import Bench
from app.wizard.walking.memory_control import MemoryControl
from app.wizard.walking.step import WalkingStep
from app.wizard.walking.timed_control import TimedControl
from app.wizard.walking.walk_start import WalkStart
from app.wizard.walking.walking_bar import WalkingBar
from app.wording.recordings import shown_names
from core.session import Recording, RecordingKind
from core.timed.protocols import PlannedTest, TimedProtocol
from tests.app.wizard.walking.bench_material import WALKED, bench_visit

SYNCHRONISE = BarAction("Synchronise again", lambda: None)


@pytest.fixture
def visit() -> Any:
    """Nothing is recorded, and the latest of three walks waits to be kept."""
    visit = bench_visit()
    for one in visit.recordings.walks:
        one.is_decided, one.stored = one is not visit.recordings.walks[-1], SimpleNamespace(state=RecordingState.CLOSED)
    reported: dict[str, Any] = {
        "is_recording": False,
        "is_stopping": False,
        "ongoing": None,
        "must_move": False,
        "called": str,
    }
    reported |= {"shown_names": shown_names(WALKED), "has_moved": True}
    visit.recordings = SimpleNamespace(**vars(visit.recordings), **reported)
    visit.cannot_record, visit.sensors = "", SimpleNamespace(site_of={"a": "left_foot"})
    return visit


@pytest.fixture
def bench(visit: Any) -> Bench:
    return Bench(cast("Visit", visit), cast("Any", None))


@pytest.fixture
def timed() -> SimpleNamespace:
    return SimpleNamespace(planned=None, is_running=False, next_words=lambda label: f"Next: test, {label}")


@pytest.fixture
def walks() -> SimpleNamespace:
    """Notes what is done."""
    pressed: list[str] = []
    does = ("run", "stop", "go_on", "keep_at_bench", "discard", "return_to_first", "toggle_patient_screen")
    return SimpleNamespace(pressed=pressed, **{name: partial(pressed.append, name) for name in does})


@pytest.fixture
def bar(visit: Any, walks: SimpleNamespace, bench: Bench, timed: SimpleNamespace) -> WalkingBar:
    """Of sensors whose clocks have drifted apart."""
    memory = SimpleNamespace(bar=lambda: None, quiet=lambda *, wants_live: SYNCHRONISE)
    start = SimpleNamespace(is_possible=False, missing_now="")
    return WalkingBar(
        cast(WalkingStep, walks),
        visit,
        cast("WalkStart", start),
        bench,
        cast("TimedControl", timed),
        cast("MemoryControl", memory),
    )


def reported(bar: WalkingBar) -> list[str]:
    return [action.text for action in bar.state("Shoes").quiet]


def test_at_the_bench_discard_discards_also_while_clocks_drift(
    visit: Any, walks: SimpleNamespace, bar: WalkingBar
) -> None:
    assert reported(bar) == ["Walks", "Exclude"]
    bar.state("Shoes").quiet[1].run()
    assert walks.pressed == ["discard"]
    visit.recordings.walks[-1].is_decided = True
    assert reported(bar) == ["Walks"]


def test_at_the_bench_it_states_what_the_next_walk_is_walked_with(visit: Any, bench: Bench, bar: WalkingBar) -> None:
    visit.recordings.walks[-1].is_decided = True
    again = bar.state("Shoes")
    assert [one.text for one in again.others] == ["Return to A", "Repeat C"]
    bench.entry.step("turns", 1)
    visit.recordings.walks[-1].is_decided = False
    asked = bar.state("Shoes")
    assert [one.text for one in asked.others] == ["Return to A", "Walk with D"]
    assert asked.primary is not None
    assert (asked.primary.text, asked.note) == ("Include C", "No timed test; T chooses one.")


def test_beside_the_list_of_walks_the_clocks_can_be_synchronised(visit: Any, bench: Bench, bar: WalkingBar) -> None:
    bench.is_requested = False
    visit.recordings.walks[-1].is_decided = True
    assert reported(bar) == ["Alignment", "Synchronise again", "Patient screen"]
    assert bar.state("Shoes").quiet[1] is SYNCHRONISE


@pytest.mark.parametrize(
    ("kind", "is_stopping", "primary", "note"),
    [
        (RecordingKind.WALKING, True, "Start walk", "The walk is being loaded."),
        (RecordingKind.FREE_MOTION, True, "Start walk", "Free motion: being loaded"),
        (RecordingKind.FREE_MOTION, False, "Start walk", "Free motion: being loaded"),
    ],
)
def test_what_another_step_recorded_is_not_called_a_walk(
    visit: Any, bar: WalkingBar, kind: RecordingKind, is_stopping: bool, primary: str, note: str
) -> None:
    name = str(kind).replace("_", " ")
    visit.recordings.ongoing = Ongoing(Recording(name, kind, name, {}), 1.0)
    visit.recordings.is_recording, visit.recordings.is_stopping = True, is_stopping
    state = bar.state("Shoes")
    assert state.primary is not None
    assert (state.primary.text, state.primary.is_enabled, state.note) == (primary, False, note)
    assert state.recording is None


@pytest.mark.parametrize("is_bench", [True, False])
@pytest.mark.parametrize("is_asked", [True, False])
def test_a_timed_test_that_the_next_walk_is_is_on_the_bar(
    visit: Any, bench: Bench, bar: WalkingBar, timed: SimpleNamespace, is_bench: bool, is_asked: bool
) -> None:
    """T chooses one also where the chooser is not in sight."""

    def words() -> tuple[str, str]:
        state = bar.state("Alignment D")
        assert state.primary is not None
        key = [action.text for action in (state.primary, *state.others) if action.key == "Space"]
        return key[0], state.note

    bench.is_requested, visit.recordings.walks[-1].is_decided = is_bench, not is_asked
    assert "10-metre" not in words()[0]
    timed.planned = PlannedTest(TimedProtocol.TEN_METRES)
    label = "Alignment C" if is_bench else "Alignment D"
    start = "Include, start 10-metre walk" if is_asked and not is_bench else "Start 10-metre walk"
    assert words() == (start, f"Next: test, {label}")
