"""What can sensors be heard through? The simulated patient and stored sessions; ports come with their drivers."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from app.wizard.worn_sensors import SourceChoice
from app.wording import tr

if TYPE_CHECKING:
    from devices.live import LiveSource

DEMONSTRATION = "demonstration"


def choices() -> tuple[SourceChoice, ...]:
    """All sources of this machine."""
    return (SourceChoice(DEMONSTRATION, tr("Simulated patient"), _demonstration, is_simulated=True),)


def replay_of(folder: Path) -> SourceChoice:
    """A session folder, played as if it were measured now."""

    def make() -> "Sequence[LiveSource]":
        from devices.files.session_folder import read_session
        from devices.replay import ReplaySource

        return [ReplaySource(read_session(folder))]

    return SourceChoice(f"replay {folder}", tr("Replay of {name}").format(name=folder.name), make, is_simulated=True)


def _demonstration() -> "Sequence[LiveSource]":
    from devices.replay import demonstration

    return [demonstration()]
