"""State of the library on the clinic's server:

open to stations or not. It is closed while being moved there, and once it left.
"""

from enum import StrEnum

from sqlalchemy.orm import Session as OrmSession

from app.storage.database.models import SettingRow
from app.storage.stored import LibraryError, LibraryFaultError
from app.wording.translation import tr

STATE_SETTING = "server state"
TARGET_SETTING = "brought back to"  # by which station, into which folder: two folders would be two libraries


class ServerState(StrEnum):
    """Moving: rows are there, and are still being compared. Closed: the library was, or is being, brought back."""

    MOVING = "moving"
    OPEN = "open"
    CLOSED = "closed"


def state_of(session: OrmSession) -> ServerState | None:
    """None: there is no library on the server."""
    row = session.get(SettingRow, STATE_SETTING)
    return None if row is None else ServerState(row.value)


def set_state(session: OrmSession, state: ServerState) -> None:
    SettingRow.put(session, STATE_SETTING, state.value)


def close_for(session: OrmSession, target: str) -> None:
    """Close the library on the server, which goes to `target`; raises LibraryError if bound elsewhere."""
    before = SettingRow.of(session, TARGET_SETTING, target)
    if state_of(session) is ServerState.CLOSED and before != target:
        raise LibraryError(
            tr("The library was or is being moved back to another folder: {folder}").format(
                folder=str(before).partition(" ")[2]
            ),
            "Use the library in that folder. If nobody uses that folder, first reopen the server: "
            "gaitwright clinic back --give-up",
        )
    SettingRow.put(session, TARGET_SETTING, target)
    set_state(session, ServerState.CLOSED)


def refuse_closed(session: OrmSession) -> None:
    """Raise LibraryFaultError where the server's library is closed; recordings then wait here."""
    found = state_of(session)
    if found is ServerState.OPEN:
        return
    if found is None:
        raise LibraryFaultError(
            "No library was found on the clinic's server",
            "First move a library to the server, in the settings of the workstation that has it",
        )
    if found is ServerState.MOVING:
        raise LibraryFaultError(
            "The library is still being moved to the clinic's server", "Wait until the move is complete"
        )
    raise LibraryFaultError(
        "The library is no longer on the clinic's server", "Ask the person who moved it back for its new location"
    )
