"""The error figures that a library's differences are judged by: its own study's where that was chosen."""

import logging
from typing import TYPE_CHECKING

from core.verdicts.own_figures import OwnFigures, figures_from_json, figures_in_json
from core.verdicts.sigmas import PUBLISHED, ErrorFigures

if TYPE_CHECKING:  # the database takes long to load
    from app.storage.library import Library

SETTING = "error_figures"
_log = logging.getLogger(__name__)


def chosen_study(library: "Library") -> OwnFigures | None:
    """Give the chosen study; None (also if damaged): published figures hold. Raises LibraryError."""
    kept = library.settings.get(SETTING)
    try:
        return figures_from_json(kept) if kept is not None else None
    except ValueError:
        _log.warning("the error figures of an own study cannot be read; the published ones are used")
        return None


def choose_study(library: "Library", own: OwnFigures | None) -> None:
    """Judge by a study, None: the published figures; audited, administrators only; raises LibraryError."""
    library.settings.put(SETTING, figures_in_json(own) if own is not None else None)


def figures_of(library: "Library") -> ErrorFigures:
    """What the library's differences are judged by; raises as `chosen_study`."""
    own = chosen_study(library)
    return own.figures if own is not None else PUBLISHED
