"""Detect when nobody has worked here for so long that the screen must be covered.

A recording is not known here, and so nothing here can end one: it is neither activity, which would leave a patient's
name on the screen of an empty room, nor a reason to wait. Its writer keeps the key of its own journal. What `lock`
does is the application's: show nothing of a patient, and ask for the passphrase.
"""

from collections.abc import Callable

LOCK_AFTER_S = 300.0


class IdleLock:
    """Calls `lock` once when nothing was done for `after_s`; polled by a timer, every few seconds.

    `now_s` is best the wall clock: others may stand still while the machine sleeps. That it may be set back does no
    harm, for only its steps forward are added up.
    """

    def __init__(self, now_s: Callable[[], float], lock: Callable[[], None], after_s: float = LOCK_AFTER_S) -> None:
        self._now_s, self._lock, self._after_s = now_s, lock, after_s
        self.is_locked = False
        self.is_asked_for = False
        """Whether somebody asked for the lock, instead of nobody being there."""
        self._idle_s = 0.0
        self._seen_s = now_s()

    def poll(self) -> None:
        """Lock if it is time."""
        now_s = self._now_s()
        self._idle_s += max(0.0, now_s - self._seen_s)
        self._seen_s = now_s
        if self._idle_s >= self._after_s and not self.is_locked:
            self.is_locked = True  # first: `lock` may let the timer poll again before it returns
            self._lock()

    def lock_now(self) -> None:
        """Lock without waiting, as somebody who leaves the desk asks for it."""
        if not self.is_locked:
            self.is_locked = self.is_asked_for = True
            self._lock()

    def note_activity(self) -> None:
        """A key or the mouse was used. It does not unlock."""
        self.poll()  # the mouse that wakes the machine must not come before the timer
        self._idle_s = 0.0

    def unlock(self) -> None:
        """The passphrase was right: start counting from zero."""
        self.is_locked = self.is_asked_for = False
        self._idle_s = 0.0
        self._seen_s = self._now_s()
