"""The pseudonyms of sessions that are in no library: the same in every export made on this computer.

They come from a key of this computer, which never leaves it, and from what the sensors measured, not from what was
typed: a corrected code changes none, and whoever has the export alone gets neither a code nor a date back.
"""

import hashlib
import logging
import secrets
from pathlib import Path
from uuid import UUID

import numpy as np
import platformdirs

from app.storage.files import replace_file
from app.storage.pseudonyms import Pseudonyms
from core.session import Session

KEY_BYTES = 32
_log = logging.getLogger(__name__)


def key_file() -> Path:
    return platformdirs.user_data_path("gaitwright", appauthor=False) / "pseudonyms.key"


def pseudonyms_of_folder(session: Session) -> tuple[Pseudonyms, UUID]:
    """Give the pseudonyms of this computer, and what identifies the patient of a session with its samples."""
    return Pseudonyms(_key(key_file())), identity_of(session)


def identity_of(session: Session) -> UUID:
    """What its sensors measured, in a name: the same for the same samples."""
    digest = hashlib.sha256()
    for recording in session.recordings:
        for site, block in sorted(recording.imu.items()):
            digest.update(f"{recording.folder}/{site}/{len(block)}".encode())
            for samples in (block.time_s, block.gyr_rad_s, block.acc_m_s2):
                digest.update(np.ascontiguousarray(samples, dtype="<f8").tobytes())
    return UUID(bytes=digest.digest()[:16])


def _key(path: Path) -> bytes:
    """The key, made at the first export; where it can be neither read nor kept, one that nothing else will have."""
    try:
        if path.exists() and len(kept := path.read_bytes()) == KEY_BYTES:
            return kept
        path.parent.mkdir(parents=True, exist_ok=True)
        replace_file(path, secrets.token_bytes(KEY_BYTES))
        return path.read_bytes()  # that of another export, if one was made at this moment
    except OSError as problem:
        _log.warning("the key of pseudonyms cannot be kept, so these are for one export", exc_info=problem)
        return secrets.token_bytes(KEY_BYTES)
