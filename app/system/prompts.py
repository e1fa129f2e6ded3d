"""Spoken prompts: what is to be done now, for those who look at the patient and not at the screen.

Each phrase is a file in every language of the screen, made once by `packaging/make_prompts.py`. Off by default.
"""

import math
from collections.abc import Callable
from time import monotonic

from app.system import sounds
from app.wording.translation import spoken_language

AGAIN_AFTER_S = 6.0  # the same phrase; what changes to and fro is not repeated each time


class Prompter:
    """Has each new phrase spoken, in the language of the screen; it cuts off the one before.

    Parameters
    ----------
    play
        Plays the phrase of this language and name, as `sounds.speak` does.
    now_s
        A clock that goes on evenly.
    """

    def __init__(self, play: Callable[[str], object] = sounds.speak, now_s: Callable[[], float] = monotonic) -> None:
        self.is_on = False
        self._play, self._now_s = play, now_s
        self._latest = ""
        self._spoken_s: dict[str, float] = {}

    def speak(self, phrase: str) -> None:
        """Speak `phrase` if it is new; empty: silence. A phrase spoken a moment ago is not repeated yet."""
        if not self.is_on or phrase == self._latest:
            return
        now_s = self._now_s()
        if phrase and now_s - self._spoken_s.get(phrase, -math.inf) < AGAIN_AFTER_S:
            return
        self._latest = phrase
        if phrase:
            self._spoken_s[phrase] = now_s
            self._play(f"{spoken_language()}/{phrase}")

    def end(self) -> None:
        """Forget what was spoken latest: the step is left, and may ask for the same when it is entered again."""
        self._latest = ""


prompter = Prompter()
