"""What a program that records needs of a source that sends now: a port, a network inlet, a simulated patient."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

from core.samples import ImuBlock, RateKind
from core.session import RecordingKind
from devices.quiet import Quiet
from devices.source import SourceInfo

Keep = Callable[[bytes], None]
"""Takes bytes as they were read, before anybody looks at them."""


class SourceRefusedError(Exception):
    """A source that does not open. States what is wrong and what to do.

    Both are sentences without their full stop, written out where they are raised: so they are gathered for the
    translators, and whoever shows them puts them into the user's language. `values` fill their braces.
    """

    def __init__(self, what: str, remedy: str, **values: object) -> None:
        super().__init__(f"{what}. {remedy}.".format(**values))
        self.what, self.remedy, self.values = what, remedy, values


class SourceLostError(Exception):
    """A source that was open and answers no more: unplugged, out of reach, switched off."""


class SourceRestartedError(SourceLostError):
    """A source that sends again, after it was to send nothing: what lies between was not lost."""


@dataclass(frozen=True, slots=True)
class SensorDetails:
    """What a sensor reports about itself. `rate_hz`, `rate_kind` and `battery` (0 to 1) None: not given.

    `clock` is the same of those that share one; empty: its own. Not `is_loss_seen`: it sends neither time nor number,
    so that nobody sees where single samples are missing.
    """

    model: str = ""
    serial: str = ""
    firmware: str = ""
    rate_hz: float | None = None
    rate_kind: RateKind | None = None
    battery: float | None = None
    clock: str = ""
    quiet: Quiet | None = None
    is_loss_seen: bool = True


class LiveSource(Protocol):
    """One stream of one or several sensors.

    `open`, `read` and `close` are called from one thread at a time, all else from any. After `close` it may be opened
    again; a source that was lost is.
    """

    @property
    def info(self) -> SourceInfo:
        """What decoding needs; the sensors' names, none of them another source's. Known once it is open."""

    @property
    def has_bytes(self) -> bool:
        """Whether it reads bytes: these are recorded and decoded again, by the same `StreamDecoder`. Else samples are.

        Nothing else is asked of such a source than that it calls `keep` before it decodes.
        """

    @property
    def sent(self) -> Sequence[bytes]:
        """What was written to it since it was opened last: its settings, its light. None where it is only read."""

    def open(self) -> None:
        """Begin to listen.

        Raises
        ------
        SourceRefusedError
            It is not there, another program has it, or it is something else.
        """

    def read(self, keep: Keep) -> Sequence[ImuBlock]:
        """What is new, waiting for it some 10 to 20 ms, so that samples come several at a time.

        A source with bytes calls `keep` with each piece it has read, before decoding it. Stamps are seconds of
        `host_time_ns`, made from the sensor's own clock and never from when something arrived. Whatever is raised
        means that the source was lost: it is closed, and opened twice a second until it is back.
        """

    def close(self) -> None:
        """Stop listening; never raises, and may be called of a source that is closed."""

    def details(self) -> Mapping[str, SensorDetails]:
        """What each sensor reports about itself, by name."""

    def identify(self, sensor: str) -> bool:
        """Light the sensor's LED; False where it has none."""

    def ask(self, kind: RecordingKind | None) -> float | None:
        """What the patient is asked to do; None: nothing. Only simulated patients listen.

        Answers how long it will be done, s, 0 by who cannot; None: for as long as it takes, or nobody listens.
        """
