"""Why may a sensor be silent without being lost? Apart from the sources, whose numbers nobody needs to show it."""

from enum import StrEnum


class Quiet(StrEnum):
    """Why a sensor is to send nothing now."""

    IN_MEMORY = "in memory"
    SYNCHRONISING = "synchronising"
