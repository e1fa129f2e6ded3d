"""Movella DOTs as live sources: one for each sensor, and one clock for those that are worn together."""

import threading
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from core.samples import ImuBlock
from core.session import RecordingKind
from devices.clocks.live_clock import LiveClock, LiveLine
from devices.dot.fetching import reached
from devices.dot.memory import RECORD_HZ
from devices.dot.messages import EMULATED
from devices.dot.samples import DRIVER, TURN_S, VERSION, DotFramer, StreamMode
from devices.dot.sensor import DotSensor
from devices.dot.synchronising import (
    RENEWED_S,
    NotSynchronisedError,
    ShowMessage,
    Synchronised,
    SyncStage,
    end_synchronising,
    let_go,
    refuse_while_recording,
    synchronise,
)
from devices.live import Keep, SensorDetails, SourceLostError, SourceRefusedError, SourceRestartedError
from devices.quiet import Quiet
from devices.source import SourceInfo
from devices.transport.bluetooth import Radio, Tick
from devices.transport.channels import READ_S

LIVE_HZ = 60
GENERAL = 0


def _show_nobody(_stage: SyncStage, _sensor: str, _left_s: float) -> None:
    """Who synchronises in passing shows no steps."""


class DotUse(StrEnum):
    """What a group does."""

    STREAMING = "streaming"
    RECORDING = "recording"  # in its memories, or ready to; it sends nothing


@dataclass(slots=True)
class _Common:
    """The clock that sensors were brought onto, at which rate, by whom it is kept, and what is known of it."""

    synchronised: Synchronised
    rate_hz: int
    members: set[str]
    line: LiveLine = field(default_factory=LiveLine)


class DotGroup:
    """Sensors that are worn together: they are synchronised before the first of them is read. Methods from any thread.

    Attributes
    ----------
    use
        Whether they stream, or are ready to record in their memories.
    turn
        So often they were brought to something else, and streams that go on do not join what came before.

    Parameters
    ----------
    sensors
        The first one is the root of synchronising, and should be worn nearest to all others.
    rate_hz
        60, or 30 where the air is too full for that.
    record_hz
        Of what is recorded in memories. Where it is another, going over from one to the other synchronises again. None:
        nothing is to be recorded there.
    """

    def __init__(
        self,
        radio: Radio,
        sensors: Sequence[DotSensor],
        rate_hz: int = LIVE_HZ,
        profile: int = GENERAL,
        record_hz: int | None = RECORD_HZ,
    ) -> None:
        self.radio, self.sensors = radio, tuple(sensors)
        self.rate_hz, self.profile, self.record_hz = rate_hz, profile, record_hz
        self.use, self.turn = DotUse.STREAMING, 0
        self._common: _Common | None = None
        self._synchronising = threading.Lock()

    def sources(self) -> "tuple[DotSource, ...]":
        return tuple(DotSource(sensor, self) for sensor in self.sensors)

    def set_root(self, name: str) -> None:
        """Let this sensor be the one that all others follow, from the next time on: it is worn nearest to all."""
        first = [sensor for sensor in self.sensors if sensor.name == name]
        self.sensors = (*first, *(sensor for sensor in self.sensors if sensor.name != name))

    @property
    def is_synchronising(self) -> bool:
        return self._synchronising.locked()

    @property
    def is_recording_use(self) -> bool:
        """Whether they are ready to record in their memories, or do, and send nothing."""
        return self.use is DotUse.RECORDING

    def synchronise(self, show_message: ShowMessage = _show_nobody, tick: Tick | None = None) -> None:
        """Bring all onto one clock and stream; takes half a minute to two, never while one is recorded.
        Raises NotSynchronisedError (to be retried) or SourceRefusedError, and what the callbacks raise.
        """
        with self._synchronising:
            self._bring_together(self.rate_hz, show_message, tick, must_stream=True)
            self.use = DotUse.STREAMING

    def make_ready_to_record(self, show_message: ShowMessage = _show_nobody, tick: Tick | None = None) -> None:
        """Bring all onto one clock at the recording rate; where they are on it, only stop streaming."""
        rate_hz = self.record_hz or self.rate_hz
        with self._synchronising:
            if self.are_one_at(rate_hz):
                self.turn += 1
                self.radio.run(_silenced(self.sensors), tick)
            elif len(self.sensors) > 1:
                self._bring_together(rate_hz, show_message, tick, must_stream=False)
            else:
                self.turn += 1
                self.radio.run(_set_up(self.sensors[0], rate_hz, self.profile), tick)
            self.use = DotUse.RECORDING

    def fall_silent(self, tick: Tick | None = None) -> None:
        """Stop streaming on any clock, so that memories can be asked; raises SourceLostError, DotRefusedError.

        After an error some may go on streaming, and are taken for what they were.
        """
        with self._synchronising:
            self.turn += 1
            self.radio.run(_silenced(self.sensors), tick)
            self.use = DotUse.RECORDING

    @property
    def is_ready_to_record(self) -> bool:
        """Whether memories can record now, on a clock that holds for long enough still."""
        is_one = len(self.sensors) == 1 or self.are_one_at(self.record_hz or self.rate_hz)
        return self.is_recording_use and not self.is_synchronising and is_one

    def stream_again(self, show_message: ShowMessage = _show_nobody, tick: Tick | None = None) -> None:
        """Go back from memories to streams; as `synchronise`."""
        if len(self.sensors) > 1 and not self.are_one_at(self.rate_hz):
            self.synchronise(show_message, tick)
            return
        with self._synchronising:
            self.turn += 1
            for sensor in self.sensors:
                self.radio.run(_streaming(sensor, self.rate_hz, self.profile), tick)
            self.use = DotUse.STREAMING

    def are_one_at(self, rate_hz: int) -> bool:
        """Whether all are on one clock at this rate, for long enough still."""
        common, left_s = self._common, self.renewal_due_s()
        is_whole = common is not None and common.rate_hz == rate_hz and len(common.members) == len(self.sensors)
        return is_whole and left_s is not None and left_s > 0

    def _bring_together(self, rate_hz: int, show_message: ShowMessage, tick: Tick | None, *, must_stream: bool) -> None:
        self._common = None
        self.turn += 1
        work = synchronise(self.sensors, rate_hz, self.profile, show_message, must_stream=must_stream)
        found = self.radio.run(work, tick)
        self._common = _Common(found, rate_hz, {sensor.name for sensor in self.sensors})

    def end(self) -> None:
        """Let each have its own clock again, which spares the batteries."""
        with self._synchronising:
            self._common = None
            self.turn += 1
            self.radio.run(end_synchronising(self.sensors))

    def prepare(self) -> None:
        """Synchronise, unless that was done or there is nobody to synchronise with."""
        if len(self.sensors) > 1 and self._common is None and not self.is_synchronising:
            self.synchronise()

    def renewal_due_s(self) -> float | None:
        """How long the clocks are one still, s, negative where they may not be; None: they are not."""
        if (common := self._common) is None:
            return None
        return RENEWED_S - (self.radio.now_ns() - common.synchronised.at_ns) / 1e9

    def clock_of(self, sensor: str) -> str:
        """The name of the clock that a sensor is on; empty: its own."""
        common = self._common
        return common.synchronised.name if common is not None and sensor in common.members else ""

    def line_of(self, sensor: str) -> LiveLine | None:
        """What is known of that clock; None where it is the sensor's own."""
        common = self._common
        return common.line if common is not None and sensor in common.members else None

    def leave(self, sensor: str) -> None:
        """A sensor that was switched off, or let go, has lost the common clock."""
        if (common := self._common) is not None:
            common.members.discard(sensor)
            if not common.members:
                self._common = None


async def _silenced(sensors: Sequence[DotSensor]) -> None:
    for sensor in sensors:
        await reached(sensor)
        await refuse_while_recording(sensor)
        await sensor.stop_stream()


async def _set_up(sensor: DotSensor, rate_hz: int, profile: int) -> None:
    await _silenced([sensor])
    await sensor.set_up(rate_hz, profile)


async def _streaming(sensor: DotSensor, rate_hz: int, profile: int) -> None:
    await _set_up(sensor, rate_hz, profile)
    sensor.taken()
    await sensor.start_stream()


class DotSource:
    """The `LiveSource` of one sensor: streams, and goes on streaming while its link is lost.

    `sensor`, `group`: whose source it is, and with whom it is worn.
    """

    has_bytes = True

    def __init__(self, sensor: DotSensor, group: DotGroup) -> None:
        self.sensor, self.group = sensor, group
        self.info = SourceInfo(DRIVER, VERSION, sensors=(sensor.name,))
        self._framer: DotFramer | None = None
        self._clock, self._clock_name = LiveClock(), ""
        self._was_open = False
        self._clock_begun = 0  # so often its own clock is known to have begun again
        self._keeps_link = False
        self._turn = -1

    @property
    def sent(self) -> Sequence[bytes]:
        return tuple(self.sensor.sent)

    def open(self) -> None:
        if self.group.is_synchronising:
            raise SourceLostError(f"{self.sensor.name} is being synchronised")
        if self.group.is_recording_use:
            return  # it sends nothing; once it is to, `read` states that it begins again
        self._keeps_link = False
        try:
            if not self._was_open:
                self.group.prepare()
            self.sensor.sent.clear()
            self.group.radio.run(self._opened())
        except SourceLostError as problem:
            raise SourceRefusedError(
                "{sensor} does not respond", "Press its button, and bring it closer", sensor=self.sensor.name
            ) from problem
        self._was_open = True

    async def _opened(self) -> None:
        sensor, group = self.sensor, self.group
        self._turn = group.turn
        await sensor.connect()
        await refuse_while_recording(sensor)
        mode = await sensor.streaming()
        if mode is None or (await sensor.settings()).rate_hz != group.rate_hz:
            if self._was_open:  # it was switched off meanwhile: its clock has begun again
                group.leave(sensor.name)
                self._clock_begun += 1  # now: should the link be lost next, nothing shows it any more
            await sensor.stop_stream()
            await sensor.set_up(group.rate_hz, group.profile)
            sensor.taken()
            mode = await sensor.start_stream()
        if not self._was_open:
            sensor.taken()  # it streamed before anybody asked for it
        self._begin(mode)

    def _begin(self, mode: StreamMode) -> None:
        sensor, group = self.sensor, self.group
        info = sensor.info
        assert info is not None
        settings: dict[str, object] = {"rate_hz": group.rate_hz, "mode": mode.number, "profile": group.profile}
        name = group.clock_of(sensor.name)
        if name:
            settings |= {"clock": name, "turn_s": TURN_S}
        if self._clock_begun:
            settings["clock_begun"] = self._clock_begun  # its stamps alone may seem to follow those before
        if sensor.has_heading_reset:
            settings["has_heading_reset"] = True
        if name != self._clock_name or not name:
            self._clock = LiveClock(group.line_of(sensor.name))
        self._clock.begin()
        self._clock_name = name
        self.info = SourceInfo(
            DRIVER, VERSION, info.serial, (sensor.name,), settings, is_simulated=info.model == EMULATED
        )
        self._framer = DotFramer(self.info)

    def read(self, keep: Keep) -> Sequence[ImuBlock]:
        radio, framer = self.group.radio, self._framer
        if self.group.is_synchronising or self.group.is_recording_use:
            radio.wait(threading.Event(), READ_S)
            return ()
        if framer is None or self._turn != self.group.turn:
            self._keeps_link = True
            raise SourceRestartedError(f"{self.sensor.name} sends again")
        radio.wait(self.sensor.arrived, READ_S)
        data = b"".join(frame for _, frame in self.sensor.taken())
        if not data:
            if not self.sensor.is_up:
                raise SourceLostError(f"{self.sensor.name} was lost")
            return ()
        keep(data)
        now_s = radio.now_ns() / 1e9
        framer.feed(data, now_s)
        rows, framer.received.rows = np.array(framer.received.rows, dtype=float), []
        framer.received.orientations.clear()
        if not len(rows):
            return ()
        stamps_s = self._clock.stamp(rows[:, 0], now_s)
        return (ImuBlock(self.sensor.name, stamps_s, rows[:, 1:4], rows[:, 4:7]),)

    def close(self) -> None:
        self._framer = None
        if self._keeps_link or self.group.is_synchronising:
            return
        with suppress(Exception):
            self.group.radio.run(self._closed())

    async def _closed(self) -> None:
        """One that is in reach is not needed any more; one that is lost goes on, and is looked for."""
        if self.sensor.is_up:
            self._was_open = False
            is_synchronised = bool(self.group.clock_of(self.sensor.name))
            self.group.leave(self.sensor.name)
            await let_go(self.sensor, is_synchronised=is_synchronised)
        await self.sensor.disconnect()

    def details(self) -> Mapping[str, SensorDetails]:
        sensor, group = self.sensor, self.group
        if (info := sensor.info) is None:
            return {}
        is_recording = group.is_recording_use
        quiet = Quiet.SYNCHRONISING if group.is_synchronising else Quiet.IN_MEMORY if is_recording else None
        reported = SensorDetails(
            info.model,
            info.serial,
            ".".join(map(str, info.firmware)),
            group.record_hz if is_recording and group.record_hz else group.rate_hz,
            battery=sensor.battery,
            clock=group.clock_of(sensor.name),
            quiet=quiet,
        )
        return {sensor.name: reported}

    def identify(self, sensor: str) -> bool:
        is_busy = self.group.is_synchronising or self.group.is_recording_use
        if sensor != self.sensor.name or self._framer is None or is_busy:
            return False
        with suppress(SourceLostError):  # what is lost is noticed by whoever reads
            self.group.radio.run(self.sensor.identify())
            return True
        return False

    def ask(self, kind: RecordingKind | None) -> None:
        """Only simulated patients listen."""


__all__ = ["DotGroup", "DotSource", "NotSynchronisedError"]
