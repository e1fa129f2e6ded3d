"""Why a sensor may be silent without being lost; apart from the sources, whose numbers nobody needs to show it."""

from enum import StrEnum


class Quiet(StrEnum):
    """Why a sensor is to send nothing now."""

    IN_MEMORY = "in memory"
    SYNCHRONISING = "synchronising"
