"""What the metronome sends to the sound device, found in its samples; and that it reports where nothing plays them."""

import os
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from pytestqt.qtbot import QtBot

from app.patient_screen.metronome import Metronome
from app.system import sounds
from app.system.audio_stream import RATE_HZ, AudioStream, PipedPlayer, SoundOutlet
from app.system.sounds import Loudspeaker
from core.samples import FloatArray
from tests.app.patient_screen.sound_detection import onsets_s

MOST_OFF_S = 0.002
REFUSES = [sys.executable, "-c", "import sys; sys.exit(1)"]


class Device:
    """A sound device that plays as fast as it is given, and notes every sample; it stops the metronome's thread at
    `seconds` until it is given more of them."""

    def __init__(self, seconds: float) -> None:
        self.samples = bytearray()
        self.most = round(2 * RATE_HZ * seconds)
        self.is_over = False

    def write(self, samples: bytes) -> None:
        while len(self.samples) >= self.most and not self.is_over:
            time.sleep(0.001)
        self.samples += samples

    def fall_silent(self) -> None:
        self.is_over = True

    def close(self) -> None:
        self.is_over = True

    @property
    def is_full(self) -> bool:
        return len(self.samples) >= self.most

    @property
    def played(self) -> FloatArray:
        return np.frombuffer(bytes(self.samples), "<i2").astype(float)


def playing_to(*ways: Callable[[], SoundOutlet]) -> Callable[[Callable[[int], bytes], Callable[[], None]], AudioStream]:
    return lambda read, failed: AudioStream(read, failed, ways)


@pytest.fixture
def made(qtbot: QtBot) -> Iterator[list[Metronome]]:
    made: list[Metronome] = []
    yield made
    for one in made:
        one.stop()


def test_what_is_sent_to_the_device_clicks_at_the_set_cadence_without_drift(
    qtbot: QtBot, made: list[Metronome]
) -> None:
    device = Device(120.0)
    metronome = Metronome(play=playing_to(lambda: device))
    made.append(metronome)
    metronome.start(103)
    qtbot.waitUntil(lambda: device.is_full)
    metronome.stop()
    found_s = onsets_s(device.played[: 120 * RATE_HZ], RATE_HZ)
    assert len(found_s) == 206
    # a tenth of what ten minutes may be off, in a fifth of their time: a sample is 0.02 ms
    assert np.abs(found_s - found_s[0] - 60.0 / 103 * np.arange(206)).max() < MOST_OFF_S / 10


def test_a_new_cadence_goes_into_the_same_stream_and_no_click_is_doubled(qtbot: QtBot, made: list[Metronome]) -> None:
    device = Device(5.3)
    metronome = Metronome(play=playing_to(lambda: device))
    made.append(metronome)
    metronome.start(60)
    qtbot.waitUntil(lambda: device.is_full)
    metronome.start(100)
    device.most += 2 * RATE_HZ * 10
    qtbot.waitUntil(lambda: device.is_full)
    metronome.stop()
    gaps_s = np.diff(onsets_s(device.played, RATE_HZ))
    assert gaps_s.min() > 0.6 - MOST_OFF_S
    assert gaps_s.max() < 1.0 + MOST_OFF_S
    assert np.abs(gaps_s[6:] - 0.6).max() < MOST_OFF_S


def test_the_bell_makes_it_silent_and_the_clicks_after_it_are_in_time(qtbot: QtBot, made: list[Metronome]) -> None:
    device = Device(4.5)
    metronome = Metronome(play=playing_to(lambda: device))
    made.append(metronome)
    metronome.start(60)
    qtbot.waitUntil(lambda: device.is_full)
    sounds.set_on(False)
    try:
        device.most += 2 * RATE_HZ * 4
        qtbot.waitUntil(lambda: device.is_full)
    finally:
        sounds.set_on(True)
    device.most += 2 * RATE_HZ * 4
    qtbot.waitUntil(lambda: device.is_full)
    metronome.stop()
    found_s = onsets_s(device.played, RATE_HZ)
    assert len(found_s) in (9, 10)
    assert np.abs(found_s - found_s[0] - np.round(found_s - found_s[0])).max() < MOST_OFF_S
    assert np.diff(found_s).max() == pytest.approx(5.0, abs=MOST_OFF_S)


def test_a_player_beside_the_program_is_given_the_same_samples(
    qtbot: QtBot, made: list[Metronome], tmp_path: Path
) -> None:
    file = tmp_path / "played"
    takes = f"import sys; open({str(file)!r}, 'wb').write(sys.stdin.buffer.read({20 * 2 * RATE_HZ}))"
    player = [sys.executable, "-c", takes]
    metronome = Metronome(play=playing_to(lambda: PipedPlayer(["no-such-player"]), lambda: PipedPlayer(player)))
    made.append(metronome)
    metronome.start(120)
    qtbot.waitUntil(lambda: file.exists() and file.stat().st_size == 20 * 2 * RATE_HZ)
    found_s = onsets_s(np.frombuffer(file.read_bytes(), "<i2").astype(float), RATE_HZ)
    assert len(found_s) == 40
    assert np.abs(np.diff(found_s) - 0.5).max() < MOST_OFF_S


@pytest.mark.skipif(os.name == "nt", reason="Windows keeps no ended process for the one that started it")
def test_it_stops_at_once_and_leaves_no_player_behind(qtbot: QtBot, made: list[Metronome], tmp_path: Path) -> None:
    number = tmp_path / "number"
    waits = f"import os, time; print(os.getpid(), file=open({str(number)!r}, 'w'), flush=True); time.sleep(600)"
    metronome = Metronome(play=playing_to(lambda: PipedPlayer([sys.executable, "-c", waits])))
    made.append(metronome)
    metronome.start(60)
    qtbot.waitUntil(lambda: number.exists() and number.read_text().endswith("\n"))
    metronome.stop()
    assert metronome.beats_per_min == 0
    qtbot.waitUntil(lambda: is_gone(int(number.read_text())))


def is_gone(process: int) -> bool:
    """Return whether nothing is left of a process; one that ended and was not waited for is still there."""
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return True
    return False


def test_without_a_sound_device_it_is_silent_and_states_so(
    qtbot: QtBot, made: list[Metronome], monkeypatch: pytest.MonkeyPatch
) -> None:
    nothing = Loudspeaker([REFUSES])
    monkeypatch.setattr(sounds, "_loudspeaker", nothing)
    metronome = Metronome(play=playing_to(lambda: PipedPlayer(REFUSES)))
    made.append(metronome)
    assert not metronome.is_silent
    metronome.start(200)
    qtbot.waitUntil(lambda: metronome.is_silent)
    assert metronome.beats_per_min == 200
    metronome.stop()
    assert not metronome.is_silent


def test_where_no_stream_can_be_played_it_ticks_one_by_one(
    qtbot: QtBot, made: list[Metronome], monkeypatch: pytest.MonkeyPatch
) -> None:
    ticks: list[str] = []
    monkeypatch.setattr(sounds, "play", ticks.append)
    monkeypatch.setattr(sounds, "has_output", lambda: True)
    metronome = Metronome(play=playing_to())
    made.append(metronome)
    metronome.start(200)
    qtbot.waitUntil(lambda: len(ticks) >= 2)
    assert not metronome.is_silent
    metronome.start(30)  # goes over to it
    assert metronome.beats_per_min == 30


def test_a_stream_that_was_stopped_meanwhile_starts_no_ticks(
    qtbot: QtBot, made: list[Metronome], monkeypatch: pytest.MonkeyPatch
) -> None:
    ticks: list[str] = []
    monkeypatch.setattr(sounds, "play", ticks.append)
    failing: list[Callable[[], None]] = []

    def never(read: Callable[[int], bytes], failed: Callable[[], None]) -> AudioStream:
        failing.append(failed)
        return AudioStream(read, lambda: None, ())

    metronome = Metronome(play=never)
    made.append(metronome)
    metronome.start(60)
    metronome.stop()
    metronome.start(90)
    failing[0]()
    with qtbot.waitSignal(metronome.changed):
        failing[1]()  # comes after the other
    assert len(ticks) == 1


def test_a_rate_nobody_walks_at_is_refused() -> None:
    with pytest.raises(ValueError, match="expected 30 to 200"):
        Metronome(play=playing_to()).start(10)
