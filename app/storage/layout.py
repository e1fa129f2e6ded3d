"""What is where in a library's folder.

keys.json                          who may open it
library.db                         the encrypted database
recordings/ID.SEGMENT.journal      the samples
videos/ID.1.journal                one video of a walk each, as a journal is, by the id of its own
library-id                         which library it is, for whoever has no key
in-use                             locked by the program that records here
tries.json                         how many wrong passphrases were typed
keys-next.json, library-next.db    a change of the key that is not finished
moving-to-server                   it is being moved to a clinic's server, and not opened meanwhile (`clinic.moving`)

A station's folder has `station.json` and `cache/` in place of the database (`clinic.station`). The environment variable
GAITWRIGHT_DATABASE_URL names the clinic's server, and GAITWRIGHT_JOURNALS the recordings' place.

All of this is in the library's own folder, which `create_library` alone makes. One that is gone is never recreated:
recordings then go into a shelter on this computer (`app.storage.root`) until it is back (`app.storage.bringing_home`).
"""

import os
from pathlib import Path
from uuid import UUID

import platformdirs

KEYS, NEW_KEYS = "keys.json", "keys-next.json"
DATABASE, NEW_DATABASE = "library.db", "library-next.db"
RECORDINGS = "recordings"
VIDEOS = "videos"
IN_USE = "in-use"
MOVING = "moving-to-server"
STATION, CACHE = "station.json", "cache"
DATABASE_VARIABLE, JOURNALS_VARIABLE = "GAITWRIGHT_DATABASE_URL", "GAITWRIGHT_JOURNALS"
SUFFIX = ".journal"


def segment_name(recording_id: UUID, segment: int) -> str:
    """Name of a segment's file. Never read from a database, whose rows may name any file."""
    return f"{recording_id}.{segment}{SUFFIX}"


def own_folder() -> Path:
    """Where a user's own library is."""
    return platformdirs.user_data_path("gaitwright", appauthor=False) / "library"


def default_folder() -> Path:
    """Give the folder of the library that opens by itself: the user's, or a station's where a server is named."""
    own = own_folder()
    is_clinic = os.environ.get(DATABASE_VARIABLE) and not (own / STATION).exists()
    return own.with_name("clinic") if is_clinic else own
