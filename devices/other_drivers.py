"""Drivers of other packages: loaded once somebody allowed them, and kept from breaking anything but themselves.

They run in this process. What they raise, or give that is of another shape, leaves that driver out and is named. What
they receive is recorded as samples, so that a recording can be read without the package.
"""

import logging
import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from core.samples import ImuBlock
from devices.catalogue import DRIVERS, Driver
from devices.live import Keep, SensorDetails, SourceLostError, SourceRefusedError
from devices.other_packages import SENSORS, BrokenOfferError, Offer, offers
from devices.source import SourceInfo
from devices.stream import COLUMNS, ByteSource, Framer, Received, SensorProtocol
from devices.transport.channels import Channel

_log = logging.getLogger(__name__)


class BrokenDriverError(SourceRefusedError):
    """A driver of another package that failed while it was used."""


@dataclass(frozen=True, slots=True)
class LeftOut:
    """A driver that was allowed and cannot be used, and why."""

    offer: Offer
    why: str


@dataclass(frozen=True, slots=True)
class OtherDrivers:
    """The drivers of other packages that were allowed: those that can be used, and those that cannot."""

    drivers: tuple[Driver, ...] = ()
    left_out: tuple[LeftOut, ...] = ()


def offered_drivers() -> tuple[Offer, ...]:
    """Find the drivers that installed packages offer, without importing them."""
    return offers(SENSORS, [driver.key for driver in DRIVERS])


def load_drivers(allowed: Collection[tuple[str, str]]) -> OtherDrivers:
    """Import the drivers of the `allowed` packages, by name and version."""
    drivers: list[Driver] = []
    left_out: list[LeftOut] = []
    for offer in offered_drivers():
        if (offer.package, offer.version) in allowed:
            try:
                drivers.append(_usable(offer))
            except BrokenOfferError as problem:
                _log.warning("the driver %s of %s %s was left out", offer.name, offer.package, offer.version)
                left_out.append(LeftOut(offer, str(problem)))
    return OtherDrivers(tuple(drivers), tuple(left_out))


def _usable(offer: Offer) -> Driver:
    driver = offer.load(Driver)
    kinds = {"key": str, "name": str, "proof": str, "bauds": tuple, "hint": str, "knock": bytes, "knocked": bytes}
    if driver.key != offer.name or driver.protocol is None or not driver.bauds:
        raise BrokenOfferError("its key is another one, or it has no protocol or no baud rate")
    wrong = [name for name, kind in kinds.items() if not isinstance(getattr(driver, name), kind)]
    if wrong or not all(type(baud) is int and baud > 0 for baud in driver.bauds):
        raise BrokenOfferError(f"not as a Driver has it: {', '.join(wrong) or 'bauds'}")
    if bool(driver.knock) != bool(driver.knocked):
        raise BrokenOfferError("it has a knock without an answer, or an answer without a knock")
    return replace(driver, decoder=None, protocol=partial(_GuardedProtocol, offer, driver.protocol))


def other_source(protocol: SensorProtocol, channel: Channel) -> ByteSource:
    """Make the source of another package's sensor."""
    return _SampleSource(protocol, channel)


class _SampleSource(ByteSource):
    """A source whose samples are recorded, not its bytes: only the package could read these again."""

    has_bytes = False

    def read(self, keep: Keep) -> Sequence[ImuBlock]:
        return super().read(lambda _data: None)


class _GuardedProtocol:
    """A stranger's `SensorProtocol`, whose faults are all `BrokenDriverError`s."""

    def __init__(self, offer: Offer, make: Any) -> None:
        self._offer, self.driver = offer, offer.name
        self._protocol = self._guarded(make, may_refuse=False)
        self.version = str(getattr(self._protocol, "version", ""))

    def framer(self, info: SourceInfo) -> Framer:
        return _GuardedFramer(self, self._guarded(lambda: self._protocol.framer(info), may_refuse=False))

    def greet(self, channel: Channel) -> tuple[SourceInfo, SensorDetails]:
        return self._guarded(lambda: self._greeted(channel))

    def identifying(self) -> bytes:
        return self._guarded(lambda: _exactly(bytes, self._protocol.identifying()))

    def broken(self, error: Exception) -> BrokenDriverError:
        _log.warning("the driver %s of %s failed", self.driver, self._offer.package, exc_info=error)
        return BrokenDriverError(
            "The driver {driver} of the package {package} {version} stopped with an error ({error})",
            "Install a newer version of {package}, or switch its driver off in the settings",
            driver=self.driver,
            package=self._offer.package,
            version=self._offer.version,
            error=type(error).__name__,
        )

    def _greeted(self, channel: Channel) -> tuple[SourceInfo, SensorDetails]:
        found, details = self._protocol.greet(channel)
        info, details = _exactly(SourceInfo, found), _exactly(SensorDetails, details)
        if not info.sensors or not all(isinstance(name, str) and name.isprintable() for name in info.sensors):
            raise ValueError("a sensor without a name")
        return replace(info, driver=self.driver, version=self.version), details

    def _guarded(self, act: Any, *, may_refuse: bool = True) -> Any:
        try:
            return act()
        except Exception as error:  # the edge to a stranger's driver
            if may_refuse and isinstance(error, SourceRefusedError | SourceLostError):
                raise  # it is not there, or the channel is gone: what a driver may state of a channel that it uses
            raise self.broken(error) from error


class _GuardedFramer:
    """A stranger's `Framer`; what it found is taken from it at once, and is of the right shape."""

    def __init__(self, protocol: _GuardedProtocol, framer: Any) -> None:
        self._protocol, self._framer = protocol, framer
        self.received = Received()

    def feed(self, data: bytes, host_s: float) -> None:
        self._take(lambda: self._framer.feed(data, host_s))

    def flush(self) -> None:
        self._take(self._framer.flush)

    def _take(self, act: Any) -> None:
        try:
            act()
            found = _exactly(Received, self._framer.received)
            self._framer.received = Received(battery=found.battery)
            _check(found)
        except Exception as error:  # the edge to a stranger's driver
            raise self._protocol.broken(error) from error
        mine = self.received
        mine.rows += found.rows
        mine.orientations += found.orientations
        mine.replies += found.replies
        mine.damaged += found.damaged
        mine.skipped += found.skipped
        mine.battery = found.battery


def _exactly(kind: type, value: Any) -> Any:
    if not isinstance(value, kind):
        raise TypeError(f"{type(value).__name__}, expected {kind.__name__}")
    return value


def _check(found: Received) -> None:
    for row in found.rows:
        if len(row) != COLUMNS or not all(isinstance(value, int | float) and math.isfinite(value) for value in row):
            raise ValueError("a sample of another shape")
    for name in ("damaged", "skipped"):
        _exactly(int, getattr(found, name))
    if found.battery is not None and not 0.0 <= found.battery <= 1.0:
        raise ValueError("a battery beyond full or empty")
