"""What is switched on of the live output, why it is not on, and its status, as it leaves and as the screen has it."""

from dataclasses import dataclass

RUNNING, NONE = "running", "none"


@dataclass(frozen=True, slots=True)
class OutputSettings:
    """What is switched on."""

    has_lsl: bool = False
    has_websocket: bool = False
    port: int = 0


class OutputRefusedError(Exception):
    """An outlet cannot be opened. `extra`: what is to be installed; `other`: the network that is searched instead."""

    def __init__(self, extra: str = "", other: str = "", is_port_taken: bool = False) -> None:
        super().__init__(extra or other or "port")
        self.extra, self.other, self.is_port_taken = extra, other, is_port_taken


@dataclass(frozen=True, slots=True)
class Status:
    """What is counted since the walk began. `clients`, `closed` and `latest_closed` are the WebSocket's."""

    walk: str
    simulated: bool
    samples: int
    events: int
    dropped: int
    missing: tuple[str, ...]
    doubtful_feet: tuple[str, ...]
    clients: int = 0
    closed: int = 0
    latest_closed: str = ""


NO_WALK = Status(NONE, False, 0, 0, 0, (), ())
