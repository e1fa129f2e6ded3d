"""What can sensors be heard through? The simulated patient and stored sessions; ports come with their drivers."""

from pathlib import Path
from typing import TYPE_CHECKING

from app.wizard.worn_sensors import SourceChoice
from app.wording import tr

if TYPE_CHECKING:
    from app.acquisition.acquisition import Acquisition

DEMONSTRATION = "demonstration"


def choices() -> tuple[SourceChoice, ...]:
    """All sources of this machine."""
    return (SourceChoice(DEMONSTRATION, tr("Simulated patient"), _demonstration, is_simulated=True),)


def replay_of(folder: Path) -> SourceChoice:
    """A session folder, played as if it were measured now."""

    def make() -> "Acquisition":
        from app.acquisition.acquisition import Acquisition
        from devices.files.session_folder import read_session
        from devices.replay import ReplaySource

        return Acquisition([ReplaySource(read_session(folder), name=folder.name)])

    return SourceChoice(f"replay {folder}", tr("Replay of {name}").format(name=folder.name), make, is_simulated=True)


def _demonstration() -> "Acquisition":
    from app.acquisition.acquisition import Acquisition
    from devices.replay import demonstration

    return Acquisition([demonstration()])
