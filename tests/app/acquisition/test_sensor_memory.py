"""Tests of what emulated DOTs record in their memory.

It is fetched whole, or stated not to be, and erased only once it is kept.
"""

from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from pathlib import Path

import numpy as np
import pytest

from app.acquisition import sensor_memory
from app.acquisition.memory_fetching import MemoryFetching
from app.acquisition.sensor_memory import MemoryRecording
from app.storage.journal.decoding import DecodedJournal, decode
from app.storage.journal.writer import JournalWriter
from core.samples import ImuBlock
from devices.decoders import DECODERS
from devices.dot.memory import MemoryFullError
from devices.dot.sensor import DotRefusedError, DotSensor
from devices.dot.source import DotGroup
from devices.emulators.dot import EmulatedDot
from devices.emulators.dot_faults import DotFaults
from devices.live import SourceLostError, SourceRefusedError
from tests.devices.dot.virtual_time import VirtualRadio, worn
from tests.safety.journal_material import ID, KEY, NO_ROOM_ASKED

UTC_S = 1_600_000_000


class MemorySession:
    """Sensors that were synchronised to record in their memory, and the journal that they are fetched into."""

    def __init__(self, radio: VirtualRadio, folder: Path, faults: Sequence[DotFaults]) -> None:
        self.radio = radio
        self.air, self.dots = worn(radio, faults)
        self.group = DotGroup(radio, [DotSensor(radio, one) for one in self.air.announced()])
        self.group.make_ready_to_record()
        self.memory = MemoryRecording(self.group)
        self.writer = JournalWriter.create(folder, ID, KEY, room=NO_ROOM_ASKED, now_ns=radio.now_ns)
        self.reported: list[tuple[str, int, int]] = []
        self.segments: tuple[Path, ...] = ()

    def record(self, seconds: float) -> None:
        self.memory.begin(UTC_S)
        self.radio.pass_s(seconds)
        assert self.memory.end() == {}

    @property
    def files(self) -> MemoryFetching:
        assert self.memory.fetching is not None
        return self.memory.fetching

    def fetch(self) -> None:
        assert self.files.fetch(self.writer, lambda *one: self.reported.append(one)) == {}

    def erase(self, *, is_confirmed: bool = True, may_lack: bool = False) -> None:
        self.files.erase("DOT 0001", UTC_S, is_confirmed=is_confirmed, may_lack=may_lack)

    def close(self) -> dict[str, bool]:
        self.segments = (self.writer.stop().path,)
        return dict(self.files.look_into(self.segments, KEY))

    @cached_property
    def decoded(self) -> DecodedJournal:
        return decode(self.segments, KEY, DECODERS)

    def block(self, number: int) -> ImuBlock:
        return self.decoded.sensors[f"DOT {number + 1:04d}"].block

    def lost(self, number: int) -> int:
        return self.decoded.sensors[f"DOT {number + 1:04d}"].counts.lost

    def stamps_off_s(self, number: int) -> tuple[float, float]:
        """Least and most that a stamp is off when its sample was taken."""
        file = self.file(number)
        opened_s = self.writer.header.opened_ns / 1e9
        truth_s = np.array([self.dots[number].taken_ns(ticks) / 1e9 for ticks in file.ticks]) - opened_s
        off_s = self.block(number).time_s - truth_s
        return float(off_s.min()), float(off_s.max())

    def file(self, number: int) -> "RecordedByDot":
        dot = self.dots[number]
        return RecordedByDot(dot)


class RecordedByDot:
    """What one sensor recorded: the oracle."""

    def __init__(self, dot: EmulatedDot) -> None:
        file = (dot.memory.files or dot.memory.erased)[0]
        self.ticks = file.ticks
        values = np.array(file.values)
        self.gyr_rad_s, self.acc_m_s2, self.q = values[:, 7:] * (np.pi / 180), values[:, 4:7], values[:, :4]


@pytest.fixture
def radio() -> Iterator[VirtualRadio]:
    one = VirtualRadio()
    yield one
    one.close()


Make = Callable[..., MemorySession]


@pytest.fixture
def make(radio: VirtualRadio, tmp_path: Path) -> Make:
    """As many sensors as it is given faults."""
    return lambda *faults: MemorySession(radio, tmp_path, faults)


@pytest.mark.endurance
def test_six_record_at_120_hz_and_are_fetched_through_lost_links_and_damage(make: Make) -> None:
    faults = [DotFaults() for _ in range(6)]
    faults[0].drops_export_after = [100, 700, 300]
    faults[1].drops_export_after, faults[1].again = [500, 500, 500], False
    faults[2].damaged = 0.01
    faults[3].silent = 0.01
    faults[4].busy = 3
    session = make(*faults)
    session.record(20.0)
    session.fetch()
    assert session.close() == {f"DOT {number + 1:04d}": True for number in range(6)}
    offs = [session.stamps_off_s(number) for number in range(6)]
    for number in range(6):
        one, file = session.block(number), session.file(number)
        result = session.files.results[one.sensor]
        assert result.is_complete
        assert result.samples == len(file.ticks) == len(one) > 2390
        assert np.array_equal(one.gyr_rad_s, file.gyr_rad_s)
        assert np.array_equal(one.acc_m_s2, file.acc_m_s2)
        assert one.q_earth_from_sensor is not None
        assert np.array_equal(one.q_earth_from_sensor, file.q)
        assert session.lost(number) == 0
    assert max(most for _, most in offs) - min(least for least, _ in offs) < 0.002
    reported = [one for one in session.reported if one[0] == "DOT 0001"]
    done = [one[1] for one in reported]
    assert done == sorted(done)
    assert done[-1] <= reported[-1][2]


def test_what_cannot_be_had_is_a_gap_that_is_stated_by_number(make: Make) -> None:
    session = make(DotFaults(), DotFaults())
    session.record(5.0)
    session.dots[0].memory.unreadable = {300, 301, 302, 500}
    session.fetch()
    assert session.close() == {"DOT 0001": True, "DOT 0002": True}
    result = session.files.results["DOT 0001"]
    assert result.missing == (range(300, 303), range(500, 501))
    assert not result.is_complete
    assert session.lost(0) == 4
    assert session.files.results["DOT 0002"].is_complete
    steps = np.diff(session.block(0).time_s)
    assert np.round(steps[[299, 496]] / np.median(steps)).tolist() == [4, 2]
    with pytest.raises(DotRefusedError, match="has data that were not fetched"):
        session.erase()
    assert session.dots[0].memory.files
    session.erase(may_lack=True)
    assert not session.dots[0].memory.files


def test_the_last_samples_are_asked_for_until_the_sensor_states_that_there_are_no_more(make: Make) -> None:
    session = make(DotFaults())
    session.record(5.0)
    last = len(session.file(0).ticks) - 1
    session.dots[0].memory.not_received = [last, last - 1]  # once each
    session.fetch()
    assert session.files.results["DOT 0001"].samples == last + 1
    assert session.files.results["DOT 0001"].is_complete


def test_one_that_goes_on_only_while_it_sends_is_asked_then(make: Make) -> None:
    session = make(DotFaults(again=False))
    session.record(5.0)
    last = len(session.file(0).ticks) - 1
    session.dots[0].memory.not_received = [last - 1, last]
    session.fetch()
    assert session.close() == {"DOT 0001": True}
    assert session.files.results["DOT 0001"].is_complete
    assert session.files.results["DOT 0001"].samples == last + 1


def test_a_sensor_that_goes_away_while_it_is_fetched_is_named_and_goes_on_later(make: Make) -> None:
    session = make(DotFaults(), DotFaults())
    session.record(5.0)
    session.dots[0].faults.drops_export_after = [200]
    session.dots[0].faults.unreachable_after_drop_s = 300.0
    failed = session.files.fetch(session.writer, lambda *_: None)
    assert list(failed) == ["DOT 0001"]
    assert isinstance(failed["DOT 0001"], SourceLostError)
    assert list(session.files.results) == ["DOT 0002"]
    with pytest.raises(DotRefusedError, match="is not confirmed as saved"):
        session.erase()
    session.radio.pass_s(300.0)
    sent = session.dots[0].memory.exported
    session.fetch()
    assert session.close() == {"DOT 0001": True, "DOT 0002": True}
    assert session.files.results["DOT 0001"].is_complete
    assert session.dots[0].memory.exported - sent < len(session.file(0).ticks) - 150, "what came is not sent again"


def test_nothing_is_written_to_a_sensor_that_records_but_what_asks_for_its_state(make: Make) -> None:
    """The emulated one ends its recording where a rate or a mode is written to it."""
    session = make(DotFaults(), DotFaults())
    session.memory.begin(UTC_S)
    begun_s = session.radio.loop.time()
    session.radio.pass_s(3.0)
    session.air.drop(session.dots[0])
    session.radio.pass_s(3.0)
    for source in session.group.sources():
        source.open()
        assert source.read(lambda _data: None) == ()
        assert not source.identify(source.sensor.name)
        source.close()
    with pytest.raises(SourceRefusedError, match="is recording to its memory"):
        session.group.synchronise()
    session.group.end()
    session.radio.pass_s(4.0)
    assert session.memory.end() == {}
    about = 120 * (session.radio.loop.time() - begun_s)
    assert [len(session.file(number).ticks) for number in (0, 1)] == pytest.approx([about, about], rel=0.05)
    session.fetch()
    assert all(session.close().values())


def test_a_full_memory_is_a_refusal_and_nobody_else_records(make: Make) -> None:
    session = make(DotFaults(), DotFaults())
    session.dots[1].memory.room = 0
    with pytest.raises(MemoryFullError, match="memory of DOT 0002 is full"):
        session.memory.begin(UTC_S)
    assert [dot.memory.state for dot in session.dots] == [0x06, 0x06]
    session.writer.stop()


def test_a_recording_that_ended_because_the_memory_was_full_is_fetched_to_there(make: Make) -> None:
    session = make(DotFaults(), DotFaults())
    session.dots[0].memory.room = 600
    session.record(10.0)
    session.fetch()
    assert all(session.close().values())
    results = session.files.results
    assert 600 <= results["DOT 0001"].samples <= 602
    assert results["DOT 0002"].samples > 1190
    early_s = session.memory.ended_early_s()
    assert list(early_s) == ["DOT 0001"]
    assert early_s["DOT 0001"] == pytest.approx(5.0, abs=0.5)
    assert results["DOT 0001"].is_complete


def test_a_sensor_whose_end_could_not_be_fetched_is_not_stated_to_have_ended_early(
    make: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sensor_memory, "EARLY_S", 0.4)  # each sample that never comes is asked for again and again
    session = make(DotFaults())
    session.record(1.0)
    session.dots[0].memory.unreadable = set(range(20, len(session.file(0).ticks)))
    session.fetch()
    (lack,) = session.memory.lacks()
    assert session.files.results["DOT 0001"].samples == 20
    assert (lack.early_s, lack.is_end_known) == (0.0, False)
    session.writer.stop()


@pytest.mark.parametrize("by_notice", [False, True], ids=["answered", "noticed"])
def test_a_full_memory_is_understood_however_it_is_reported(make: Make, by_notice: bool) -> None:
    session = make(DotFaults(full_by_notice=by_notice))
    session.dots[0].memory.room = 0
    with pytest.raises(MemoryFullError):
        session.memory.begin(UTC_S)
    session.writer.stop()


def test_an_answer_to_something_else_and_a_sensor_that_ends_slowly_are_waited_for(make: Make) -> None:
    session = make(DotFaults(stale_answers=3, ends_after_s=6.0))
    session.memory.begin(UTC_S)
    session.radio.pass_s(3.0)
    begun_s = session.radio.loop.time()
    session.dots[0].faults.stale_answers = 3
    assert session.memory.end() == {}
    assert session.radio.loop.time() - begun_s > 5.9
    session.fetch()
    assert session.close() == {"DOT 0001": True}
    assert session.files.results["DOT 0001"].samples == pytest.approx(400, abs=40), "what was taken until it was told"


def test_fetching_that_is_left_off_goes_on_where_it_was(make: Make) -> None:
    session = make(DotFaults(), DotFaults())
    session.record(8.0)
    came = 0

    def progress(sensor: str, done: int, _of: int) -> None:
        nonlocal came
        came = done
        if (sensor, done) == ("DOT 0002", 500):
            raise InterruptedError

    with pytest.raises(InterruptedError):
        session.files.fetch(session.writer, progress)
    assert (list(session.files.results), came) == (["DOT 0001"], 500)
    assert session.dots[1].memory.state == 0x06, "it does not go on sending"
    sent = session.dots[1].memory.exported
    session.fetch()
    assert session.close() == {"DOT 0001": True, "DOT 0002": True}
    assert session.dots[1].memory.exported - sent < len(session.file(1).ticks) - 450


def test_another_file_that_was_fetched_meanwhile_is_not_gone_on_with(make: Make, tmp_path: Path) -> None:
    session = make(DotFaults())
    later = MemoryRecording(session.group)
    session.record(6.0)
    later.begin(UTC_S + 60)
    session.radio.pass_s(6.0)
    assert later.end() == {}

    def left_off(_sensor: str, done: int, _of: int) -> None:
        if done == 300:
            raise InterruptedError

    with pytest.raises(InterruptedError):
        session.files.fetch(session.writer, left_off)
    assert later.fetching is not None
    other = JournalWriter.create(tmp_path / "other", ID, KEY, room=NO_ROOM_ASKED, now_ns=session.radio.now_ns)
    assert later.fetching.fetch(other, lambda *_: None) == {}
    other.stop()
    session.fetch()
    assert session.close() == {"DOT 0001": True}
    assert np.array_equal(session.block(0).gyr_rad_s, session.file(0).gyr_rad_s)


def test_files_lie_in_time_where_they_were_ordered_and_one_clock_holds_them_together(make: Make) -> None:
    session = make(*(DotFaults() for _ in range(4)))
    session.dots[2].faults.drops_after = [1]  # over its order to begin
    session.record(5.0)
    session.fetch()
    session.close()
    offs = np.array([session.stamps_off_s(number) for number in range(4)])
    assert np.ptp(offs) < 0.002
    assert np.abs(offs).max() < 0.1
    assert all(one.clock is not None for one in session.decoded.sensors.values())


# erasing


def test_it_is_erased_only_once_it_is_in_the_journal_and_that_is_confirmed(make: Make) -> None:
    session = make(DotFaults())
    session.record(5.0)
    session.fetch()
    with pytest.raises(DotRefusedError, match="is not confirmed as saved"):  # nobody has looked
        session.erase()
    assert session.close() == {"DOT 0001": True}
    with pytest.raises(DotRefusedError, match="is not confirmed as saved"):
        session.erase(is_confirmed=False)
    assert session.dots[0].memory.files
    session.erase()
    assert not session.dots[0].memory.files


def test_a_journal_that_lacks_what_came_keeps_the_memory(make: Make) -> None:
    session = make(DotFaults())
    session.record(5.0)
    session.fetch()
    path = session.writer.stop().path
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])  # a disk that lies
    assert session.files.look_into((path,), KEY) == {"DOT 0001": False}
    with pytest.raises(DotRefusedError, match="is not confirmed as saved"):
        session.erase()
    assert session.dots[0].memory.files


def test_a_memory_that_holds_more_than_was_fetched_is_not_erased(make: Make) -> None:
    session = make(DotFaults())
    earlier = MemoryRecording(session.group)
    earlier.begin(UTC_S - 1000)
    session.radio.pass_s(2.0)
    assert earlier.end() == {}
    session.record(5.0)
    session.fetch()
    assert session.close() == {"DOT 0001": True}
    assert len(session.block(0)) == len(session.dots[0].memory.files[1].ticks)
    with pytest.raises(DotRefusedError, match=r"contains more recordings \(1\)"):
        session.erase()
    assert len(session.dots[0].memory.files) == 2


def test_forces_and_rates_that_changed_places_are_not_taken_for_kept(make: Make) -> None:
    session = make(DotFaults())
    session.record(5.0)
    file = session.dots[0].memory.files[0]
    file.values = [(*values[:4], *values[7:], *values[4:7]) for values in file.values]
    session.fetch()
    assert session.close() == {"DOT 0001": False}
