"""Time that the next try at a passphrase has to wait.

After three wrong ones, twice as long after each further one. The count is beside the library, and is raised before
a passphrase is tried: neither a restart nor a kill in between is worth a try. No time is kept. A program that starts
begins the wait again, so a clock that was set changes nothing, and nobody ever waits longer than `LONGEST_DELAY_S`.

Where the count cannot be kept, on a disk that is read only, every try waits `UNKEPT_DELAY_S`. Who may write to the
library's folder can remove the file; the count slows down whoever sits at the screen, Argon2id whoever has a copy.
"""

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from app.storage.files import replace_file
from app.storage.keys import KeyRefusedError

FORMAT = "gaitwright-tries/1"
FILE = "tries.json"
FREE_TRIES = 3
FIRST_DELAY_S, LONGEST_DELAY_S = 2.0, 300.0
UNKEPT_DELAY_S = 10.0
MOST_COUNTED = 1000  # what is more comes from no keyboard, and waits no longer


class LoginDelay:
    """The tries at one library. `read` and `trying` may wait for the disk; `now_s` never goes back."""

    def __init__(self, folder: Path, now_s: Callable[[], float]) -> None:
        self._path, self._now_s = folder / FILE, now_s
        self._wrong: dict[str, int] = {}
        self._free_at_s: dict[str, float] = {}
        self._all_free_at_s = -float("inf")

    def read(self) -> None:
        """Begin the waits that an earlier program left."""
        try:
            self._wrong, is_whole = _counts(self._path.read_bytes()), True
        except FileNotFoundError:
            self._wrong, is_whole = {}, True
        except (OSError, ValueError, TypeError, AttributeError, KeyError):
            is_whole = False
        for code in self._wrong:
            self._begin_wait(code)
        if not self._is_kept() or not is_whole:
            self._all_free_at_s = self._now_s() + UNKEPT_DELAY_S

    def left_s(self, code: str) -> float:
        free_at_s = max(self._free_at_s.get(_folded(code), self._all_free_at_s), self._all_free_at_s)
        return max(0.0, free_at_s - self._now_s())

    @contextmanager
    def trying(self, code: str) -> Iterator[None]:
        """Count what is tried inside: a `KeyRefusedError` was a wrong passphrase, and any other trouble none."""
        code = _folded(code)
        before = self._wrong.get(code, 0)
        self._wrong[code] = min(before + 1, MOST_COUNTED)
        is_kept = self._is_kept()
        try:
            yield
        except KeyRefusedError:
            self._begin_wait(code)
            if not is_kept:
                self._all_free_at_s = self._now_s() + UNKEPT_DELAY_S
            raise
        except BaseException:
            self._set(code, before)
            raise
        self._set(code, 0)
        self._free_at_s.pop(code, None)

    def _set(self, code: str, wrong: int) -> None:
        self._wrong[code] = wrong
        if not wrong:
            del self._wrong[code]
        self._is_kept()

    def _begin_wait(self, code: str) -> None:
        if (wrong := self._wrong[code]) >= FREE_TRIES:
            doublings = min(wrong - FREE_TRIES, 20)
            self._free_at_s[code] = self._now_s() + min(LONGEST_DELAY_S, FIRST_DELAY_S * 2.0**doublings)

    def _is_kept(self) -> bool:
        """Write the counts; False where that cannot be done."""
        try:
            replace_file(self._path, json.dumps({"format": FORMAT, "wrong": self._wrong}).encode())
        except OSError:
            return False
        return True


def _counts(content: bytes) -> dict[str, int]:
    kept = json.loads(content)
    if kept["format"] != FORMAT:
        raise ValueError(kept["format"])
    return {str(code): min(max(int(count), 1), MOST_COUNTED) for code, count in kept["wrong"].items()}


def _folded(code: str) -> str:
    return code.strip().casefold()
