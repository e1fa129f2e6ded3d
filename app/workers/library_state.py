"""What the library's thread gives the screen: a library that is open, or a folder's; what became of what was
asked."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple
from uuid import UUID

from app.workers.refusals import Refusal

if TYPE_CHECKING:
    from app.storage.data_key import DataKey
    from app.storage.login_delay import LoginDelay
    from app.storage.opened import OpenedLibrary
    from app.storage.recovery import Interrupted
    from app.storage.rollback import Rollback
    from app.storage.stored import Operator


@dataclass(frozen=True, slots=True)
class OpenedState:
    """What was found on opening.

    `brought_home`: recordings that were made while the library was gone, and are in it again.
    `is_recovery_key_confirmed`: whether somebody typed the recovery key back from its sheet since it was made.
    `still_away`: why sessions that were made without the clinic's server are still on this computer alone.
    `is_passphrase_given`: whether somebody else chose the operator's passphrase: an own one comes before anything else.
    `is_continued`: it was opened again for whoever was logged in: all that is asked first was asked before.
    """

    library: "OpenedLibrary"
    operator: "Operator"
    interrupted: tuple["Interrupted", ...] = ()  # recordings that nobody stopped, to be looked at
    is_end_lost: bool = False  # the library was not closed well, and what was saved last is damaged
    brought_home: frozenset[UUID] = frozenset()
    recovery_key: str = field(default="", repr=False)  # of a library that was just made, to be shown once; else empty
    rollback: "Rollback | None" = None  # what this computer has seen of the library and it does not hold any more
    is_recovery_key_confirmed: bool = True
    is_away: bool = False  # it is what a clinic's station works with while the server does not answer
    brought_from_away: int = 0  # how many sessions that were made without the clinic's server are on it now
    still_away: Refusal | None = None
    is_passphrase_given: bool = False
    is_continued: bool = False

    @property
    def is_demonstration(self) -> bool:
        return self.library.data_key is None


@dataclass(frozen=True, slots=True)
class LibraryPlace:
    """What a folder contains before its library is opened. `remembered`: operators whom the keyring may let in.

    `server`: the name of the clinic's server that it is a station of; empty where the server is this computer, None
    where the library is in the folder itself.
    """

    folder: Path
    exists: bool
    codes: tuple[str, ...]
    remembered: tuple[str, ...]
    has_keyring: bool
    delay: "LoginDelay"
    server: str | None = None


@dataclass(frozen=True, slots=True)
class KeptLogIn:
    """What opens a library again that was closed for a moment: in memory only, for whoever was logged in.

    `is_away`: without the clinic's server, whose station is in `folder`.
    """

    folder: Path
    code: str
    data_key: "DataKey" = field(repr=False)
    is_away: bool


class NotOpened(NamedTuple):
    """`is_key`: it was the key that did not open; `can_work_away`: the clinic's server does not answer."""

    what: str
    remedy: str
    is_key: bool
    can_work_away: bool = False


class Closed(NamedTuple):
    pass


class Unlocked(NamedTuple):
    pass


class Reopened(NamedTuple):
    """What came of work for which the library was closed; `result` None: nothing but `refusal`.

    `state` None: nothing is open now.
    """

    state: OpenedState | None
    result: object | None
    refusal: Refusal


class Joined(NamedTuple):
    """What came of joining; None: the folder is a station's now. `is_place`: the recordings' place is missing.

    `place`: what the server names as it, to be confirmed.
    """

    refusal: Refusal | None
    is_place: bool = False
    place: str = ""
