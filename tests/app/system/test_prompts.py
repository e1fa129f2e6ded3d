"""Spoken prompts: every hint has its phrase in each language, and each is spoken once, if at all."""

import runpy
import wave
from pathlib import Path

import pytest
from PySide6.QtCore import QSettings

from app.system.prompts import AGAIN_AFTER_S, Prompter
from app.system.settings import Settings
from app.wording.translation import LANGUAGES, use_language
from tests.app.wizard.free_motion.test_hints import every_hint

ROOT = Path(__file__).parents[3]
FOLDER = ROOT / "resources" / "sounds" / "spoken"
PHRASES = runpy.run_path(str(ROOT / "packaging" / "make_prompts.py"))["PHRASES"]
ELSEWHERE = {"swapped", "stand-still"}  # of a banner, and of standing
SPELLED_OUT = {"walk-with-turn", "loose-several"}  # a unit is spoken as a word, a count is not spoken
LARGEST_BYTES = 3_000_000


def test_every_hint_has_its_phrase_and_no_phrase_is_without_one() -> None:
    assert {hint.phrase for hint in every_hint()} | ELSEWHERE == set(PHRASES)


@pytest.mark.parametrize("language", LANGUAGES)
def test_what_is_spoken_is_what_the_screen_shows(language: str) -> None:
    use_language(language)
    try:
        hints = [hint for hint in every_hint() if hint.phrase not in SPELLED_OUT]
    finally:
        use_language("en")
    differing = {hint.sentence for hint in hints if PHRASES[hint.phrase][language] != f"{hint.sentence}."}
    assert differing == set()


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


def test_the_switch_is_off_at_first_and_is_kept(tmp_path: Path) -> None:
    kept = QSettings(str(tmp_path / "settings.ini"), QSettings.Format.IniFormat)
    assert not Settings(kept).has_prompts
    Settings(kept).has_prompts = True
    assert Settings(kept).has_prompts
