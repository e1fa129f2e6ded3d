"""Spoken prompts: every hint has its phrase in each language, and each is spoken once, if at all."""

import math
import runpy
import wave
from collections.abc import Iterator
from itertools import product
from pathlib import Path

import pytest

from app.system.prompts import AGAIN_AFTER_S, Prompter
from app.widgets.hint import Hint
from app.wizard.free_motion.hints import (
    first_hint,
    hint_for,
    hip_hint,
    last_hint,
    played_hint,
    recorded_hint,
    unplaced_hint,
)
from app.wording.translation import LANGUAGES, use_language
from core.body import LEG_JOINTS, LEG_SITES, Joint, Side
from core.live.excitation import Missing, Movement
from core.live.free_motion import FreeMotionState
from tests.app.wizard.free_motion.test_hints import motion, state

ROOT = Path(__file__).parents[3]
FOLDER = ROOT / "resources" / "sounds" / "spoken"
PHRASES = runpy.run_path(str(ROOT / "packaging" / "make_prompts.py"))["PHRASES"]
ELSEWHERE = {"swapped", "stand-still"}  # of a banner, and of standing
LARGEST_BYTES = 3_000_000


def every_hint() -> Iterator[Hint]:
    closed = {joint: state(0.8, 6.0, None, is_closed=True) for joint in LEG_JOINTS}
    loose = state(0.4, 4.0, None, axis_sd_with_floor_rad=math.radians(6.0), is_closed=True)
    stuck = {joint: state(3.8, 6.0, is_plateau=True) for joint in LEG_JOINTS}
    both = frozenset(Side)
    for movement, site, sides in product(Movement, LEG_SITES, (frozenset[Side](), both)):
        yield hint_for(Missing(site, movement), sides)
    yield from (first_hint(), unplaced_hint(), hip_hint(), played_hint(True), played_hint(False))
    yield last_hint(motion(closed))
    yield last_hint(motion(stuck))
    for knees in ((Joint.LEFT_KNEE,), (Joint.RIGHT_KNEE,), (Joint.LEFT_KNEE, Joint.RIGHT_KNEE)):
        yield last_hint(motion(closed | dict.fromkeys(knees, loose)), both)
    yield recorded_hint(FreeMotionState())
    yield recorded_hint(motion({joint: state(9.0, 40.0) for joint in LEG_JOINTS}))
    yield recorded_hint(motion(closed))


def test_every_hint_has_its_phrase_and_no_phrase_is_without_one() -> None:
    assert {hint.phrase for hint in every_hint()} | ELSEWHERE == set(PHRASES)


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_phrase_is_a_small_file_in_each_language_that_can_be_played(language: str) -> None:
    files = {file.stem: file for file in (FOLDER / language).iterdir()}
    assert set(files) == set(PHRASES)
    for file in files.values():
        with wave.open(str(file)) as spoken:
            assert (spoken.getnchannels(), spoken.getsampwidth(), spoken.getframerate()) == (1, 2, 16_000)
            assert 0.5 < spoken.getnframes() / spoken.getframerate() < 4.0, file
    assert sum(file.stat().st_size for file in FOLDER.rglob("*.wav")) < LARGEST_BYTES


def test_there_are_phrases_in_the_languages_of_the_screen_only() -> None:
    assert {folder.name for folder in FOLDER.iterdir()} == set(LANGUAGES)


class Room:
    """Notes what is spoken, at a time that the test sets."""

    def __init__(self) -> None:
        self.spoken: list[str] = []
        self.now_s = 100.0
        self.prompter = Prompter(self.spoken.append, lambda: self.now_s)
        self.prompter.is_on = True


@pytest.fixture
def room() -> Room:
    return Room()


def test_prompts_are_off_until_they_are_switched_on(room: Room) -> None:
    prompter = Prompter(room.spoken.append, lambda: 0.0)
    prompter.speak("recorded")
    assert room.spoken == []
    prompter.is_on = True
    prompter.speak("recorded")
    assert room.spoken == ["en/recorded"]


def test_a_hint_is_spoken_once_however_often_it_is_shown(room: Room) -> None:
    for _ in range(50):
        room.prompter.speak("bend-left_shank")
        room.now_s += 1.0
    room.prompter.speak("bend-right_shank")
    assert room.spoken == ["en/bend-left_shank", "en/bend-right_shank"]


def test_a_hint_that_comes_back_at_once_waits_its_time(room: Room) -> None:
    for phrase in ("bend-left_shank", "bend-right_shank", "bend-left_shank"):
        room.prompter.speak(phrase)
    assert room.spoken == ["en/bend-left_shank", "en/bend-right_shank"]
    room.now_s += AGAIN_AFTER_S
    room.prompter.speak("bend-left_shank")
    assert room.spoken[2:] == ["en/bend-left_shank"]


def test_entered_again_a_step_has_its_hint_spoken_again(room: Room) -> None:
    room.prompter.speak("stand-still")
    room.prompter.end()
    room.now_s += AGAIN_AFTER_S
    room.prompter.speak("stand-still")
    assert room.spoken == ["en/stand-still"] * 2


def test_prompts_follow_the_language_of_the_screen(room: Room) -> None:
    use_language("de")
    try:
        room.prompter.speak("recorded")
    finally:
        use_language("en")
    assert room.spoken == ["de/recorded"]
