"""Whether Rerun is installed: without it every result is there but the log that it shows."""

from collections.abc import Sequence
from importlib.machinery import EXTENSION_SUFFIXES
from importlib.util import find_spec
from pathlib import Path

from core.results import Analysis
from core.session import Session
from core.video.clip import Clip


def has_rerun() -> bool:
    """Whether a session's log can be written; a frozen program has the Python of Rerun in itself, and not the rest."""
    found = find_spec("rerun_bindings")
    folders = map(Path, (found and found.submodule_search_locations) or ())
    return any(one.name.endswith(tuple(EXTENSION_SUFFIXES)) for folder in folders for one in folder.glob("rerun*"))


def write_log(session: Session, analysis: Analysis, path: Path, clips: Sequence[Clip] = ()) -> None:
    """Write what Rerun shows of a session; raises ImportError where it is not installed, OSError for a full disk.

    `clips`: those to show beside it, in which faces can be recognised.
    """
    from app.review.rerun_log import write_log as written  # Rerun takes longer to load than to write

    written(session, analysis, path, clips)
