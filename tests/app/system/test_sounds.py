"""Tests of the sounds: they are what they should be. Playing them holds up nobody, with a player or without."""

import os
import subprocess
import sys
import threading
import wave
from pathlib import Path
from statistics import median
from time import perf_counter

import numpy as np
import pytest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from app.system import sounds
from app.system.sounds import Loudspeaker, Sound
from core.samples import FloatArray

FOLDER = Path(__file__).parents[3] / "resources" / "sounds"
RATE_HZ = 48_000
NO_PLAYER = [["no-such-player"]]


def read(sound: Sound) -> FloatArray:
    """Give the samples of a sound file, full scale 1."""
    with wave.open(str(FOLDER / f"{sound}.wav")) as file:
        assert (file.getnchannels(), file.getsampwidth(), file.getframerate()) == (1, 2, RATE_HZ)
        return np.frombuffer(file.readframes(file.getnframes()), "<i2") / 2**15


def loudest_hz(part: FloatArray) -> float:
    spectrum = np.abs(np.fft.rfft(part * np.hanning(len(part)), n=RATE_HZ))
    return float(np.argmax(spectrum))


@pytest.mark.parametrize("sound", Sound)
def test_a_sound_is_as_loud_as_the_others_and_short(sound: Sound) -> None:
    samples = read(sound)
    assert 20 * np.log10(np.abs(samples).max()) == pytest.approx(-18, abs=0.05)
    assert len(samples) < 0.5 * RATE_HZ


@pytest.mark.parametrize("sound", Sound)
def test_a_sound_begins_and_ends_without_a_click(sound: Sound) -> None:
    samples = read(sound)
    assert np.abs(samples[[0, -1]]).max() < 1e-4
    highest_hz = 990
    # no step is larger than the steepest place of a pure tone: where a tone is cut off, one is
    assert np.abs(np.diff(samples)).max() < 10 ** (-18 / 20) * 2 * np.pi * highest_hz / RATE_HZ * 1.05


@pytest.mark.parametrize(
    ("sound", "first_hz", "last_hz"),
    [
        (Sound.START, 660, 880),
        (Sound.STOP, 880, 660),
        (Sound.COUNT, 440, 440),
        (Sound.READY, 990, 990),
        (Sound.LOSS, 220, 220),
        (Sound.REACHED, 880, 880),
        (Sound.TICK, 660, 660),
    ],
)
def test_a_sound_has_its_tones(sound: Sound, first_hz: float, last_hz: float) -> None:
    samples = read(sound)
    third = len(samples) // 3
    assert loudest_hz(samples[:third]) == pytest.approx(first_hz, abs=8)
    assert loudest_hz(samples[-third:]) == pytest.approx(last_hz, abs=8)


def test_the_files_are_those_that_the_script_makes(tmp_path: Path) -> None:
    script = Path(__file__).parents[3] / "packaging" / "make_sounds.py"
    code = "import sys, pathlib, make_sounds as m; [m.write(name, pathlib.Path(sys.argv[1])) for name in m.SOUNDS]"
    paths = {**os.environ, "PYTHONPATH": str(script.parent)}
    subprocess.run([sys.executable, "-c", code, str(tmp_path)], check=True, env=paths)
    assert sorted(file.name for file in tmp_path.iterdir()) == sorted(f"{sound}.wav" for sound in Sound)
    for made in tmp_path.iterdir():
        assert made.read_bytes() == (FOLDER / made.name).read_bytes(), made.name


def player(folder: Path, does: str) -> list[str]:
    """Give a player that notes what it is asked to play, line by line, and then `does` something."""
    note = f"import sys, os, time; open({str(folder / 'played')!r}, 'a').write(os.path.basename(sys.argv[-1]) + '\\n')"
    return [sys.executable, "-c", f"{note}; {does}"]


def played(folder: Path) -> list[str]:
    note = folder / "played"
    return note.read_text().split() if note.exists() else []


def is_gone(process: int) -> bool:
    """Return whether nothing is left of a process; one that ended and was not waited for is still there."""
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return True
    return False


@pytest.fixture
def beeps(monkeypatch: pytest.MonkeyPatch) -> list[threading.Thread]:
    """Note the thread of every beep."""
    received: list[threading.Thread] = []
    monkeypatch.setattr(QApplication, "beep", lambda: received.append(threading.current_thread()))
    return received


def test_a_sound_is_given_to_the_player(qtbot: QtBot, tmp_path: Path) -> None:
    loudspeaker = Loudspeaker([player(tmp_path, "")])
    loudspeaker.play(Sound.START)
    qtbot.waitUntil(lambda: played(tmp_path) == ["start.wav"])


@pytest.mark.skipif(os.name == "nt", reason="Windows keeps no ended process for the one that started it")
def test_a_player_that_has_ended_leaves_no_process_behind(qtbot: QtBot, tmp_path: Path) -> None:
    number = tmp_path / "number"
    loudspeaker = Loudspeaker([player(tmp_path, f"print(os.getpid(), file=open({str(number)!r}, 'w'))")])
    loudspeaker.play(Sound.START)
    qtbot.waitUntil(lambda: number.exists() and number.read_text().endswith("\n"))
    qtbot.waitUntil(lambda: is_gone(int(number.read_text())))


@pytest.mark.parametrize(
    ("waiting", "received"),
    [
        pytest.param((Sound.LOSS, Sound.READY, Sound.STOP), "stop.wav", id="the latest"),
        pytest.param((Sound.TICK, Sound.REACHED, Sound.TICK), "reached.wav", id="a tick takes no other sound's place"),
    ],
)
def test_two_sounds_never_overlap_and_of_those_that_wait_one_is_received(
    qtbot: QtBot, tmp_path: Path, waiting: tuple[Sound, ...], received: str
) -> None:
    flag = tmp_path / "sounding"
    alone = f"os.mkdir({str(flag)!r}); time.sleep(0.1); os.rmdir({str(flag)!r})"  # mkdir refuses where one sounds
    loudspeaker = Loudspeaker([player(tmp_path, alone), player(tmp_path, "print()")])
    loudspeaker.play(Sound.COUNT)
    qtbot.waitUntil(flag.exists)
    for sound in waiting:
        loudspeaker.play(sound)
    qtbot.waitUntil(lambda: len(played(tmp_path)) == 2)
    qtbot.waitUntil(lambda: not flag.exists())
    assert played(tmp_path) == ["count.wav", received]


def test_a_player_that_cannot_play_is_left_for_the_next(qtbot: QtBot, tmp_path: Path) -> None:
    (tmp_path / "bad").mkdir()
    refusing = player(tmp_path / "bad", "sys.exit(1)")
    loudspeaker = Loudspeaker([*NO_PLAYER, refusing, player(tmp_path, "")])
    loudspeaker.play(Sound.START)
    qtbot.waitUntil(lambda: len(played(tmp_path)) == 1)
    loudspeaker.play(Sound.STOP)
    qtbot.waitUntil(lambda: len(played(tmp_path)) == 2)
    assert played(tmp_path / "bad") == ["start.wav"]


def test_without_a_player_the_desktop_beeps_from_the_screens_thread(
    qtbot: QtBot, beeps: list[threading.Thread]
) -> None:
    loudspeaker = Loudspeaker(NO_PLAYER)
    loudspeaker.play(Sound.LOSS)
    qtbot.waitUntil(lambda: len(beeps) == 1)
    assert beeps == [threading.main_thread()]


def test_the_bell_turns_every_sound_off(qtbot: QtBot, tmp_path: Path, beeps: list[threading.Thread]) -> None:
    loudspeaker = Loudspeaker([player(tmp_path, "")])
    loudspeaker.is_on = False
    loudspeaker.play(Sound.LOSS)
    loudspeaker.is_on = True
    loudspeaker.play(Sound.STOP)
    qtbot.waitUntil(lambda: played(tmp_path) != [])
    assert (played(tmp_path), beeps) == (["stop.wav"], [])


def test_the_bell_of_the_whole_application_is_remembered() -> None:
    assert sounds.is_on()
    sounds.set_on(False)
    try:
        assert not sounds.is_on()
    finally:
        sounds.set_on(True)


def test_playing_takes_the_screens_thread_less_than_a_millisecond(qtbot: QtBot, tmp_path: Path) -> None:
    loudspeaker = Loudspeaker([player(tmp_path, "")])
    took_s = []
    for sound in [*Sound] * 3:
        begun_s = perf_counter()
        loudspeaker.play(sound)
        took_s.append(perf_counter() - begun_s)
    assert median(took_s) < 1e-3
    qtbot.waitUntil(lambda: played(tmp_path) != [])


def phrases(folder: Path) -> list[str]:
    return [name.removesuffix(".wav") for name in played(folder)]


def test_a_new_phrase_cuts_off_the_one_before(qtbot: QtBot, tmp_path: Path) -> None:
    loudspeaker = Loudspeaker([player(tmp_path, "time.sleep(60) if 'recorded' in sys.argv[-1] else None")])
    loudspeaker.speak("en/recorded")
    qtbot.waitUntil(lambda: phrases(tmp_path) == ["recorded"])
    loudspeaker.speak("de/enough-movement")
    qtbot.waitUntil(lambda: phrases(tmp_path) == ["recorded", "enough-movement"])


def test_a_tone_cuts_off_a_phrase_and_is_cut_off_by_none(qtbot: QtBot, tmp_path: Path) -> None:
    done = tmp_path / "done"
    ends = f"time.sleep(60 if 'recorded' in sys.argv[-1] else 0.1); open({str(done)!r}, 'w')"
    loudspeaker = Loudspeaker([player(tmp_path, ends)])
    loudspeaker.speak("en/recorded")
    qtbot.waitUntil(lambda: phrases(tmp_path) == ["recorded"])
    loudspeaker.play(Sound.START)
    qtbot.waitUntil(lambda: phrases(tmp_path) == ["recorded", "start"])
    loudspeaker.speak("en/swapped")
    qtbot.waitUntil(lambda: phrases(tmp_path) == ["recorded", "start", "swapped"])
    assert done.exists()


def test_a_phrase_takes_no_waiting_tones_place(qtbot: QtBot, tmp_path: Path) -> None:
    loudspeaker = Loudspeaker([player(tmp_path, "time.sleep(0.1)")])
    loudspeaker.play(Sound.READY)
    loudspeaker.speak("en/recorded")
    qtbot.waitUntil(lambda: phrases(tmp_path) == ["ready", "recorded"])


def test_without_a_player_a_phrase_is_no_beep(qtbot: QtBot, beeps: list[threading.Thread]) -> None:
    loudspeaker = Loudspeaker(NO_PLAYER)
    loudspeaker.speak("en/recorded")
    loudspeaker.play(Sound.LOSS)
    qtbot.waitUntil(lambda: len(beeps) == 1)
    qtbot.wait(50)
    assert len(beeps) == 1
