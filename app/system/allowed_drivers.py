"""Drivers of other packages that somebody allowed on this computer; kept by the package's name and version."""

from dataclasses import dataclass

from app.system.kept_json import keep, read_kept
from devices.other_drivers import OtherDrivers, load_drivers, offered_drivers

FILE = "drivers.json"


@dataclass(frozen=True, slots=True)
class DriverPackage:
    """An installed package with drivers; nothing of it was imported."""

    name: str
    version: str
    drivers: tuple[str, ...]
    is_allowed: bool


def driver_packages() -> list[DriverPackage]:
    """Installed packages with drivers, by name."""
    allowed = _allowed()
    found: dict[tuple[str, str], list[str]] = {}
    for offer in offered_drivers():
        found.setdefault((offer.package, offer.version), []).append(offer.name)
    return [
        DriverPackage(name, version, tuple(drivers), (name, version) in allowed)
        for (name, version), drivers in sorted(found.items())
    ]


def allow_drivers(package: str, version: str, *, is_allowed: bool) -> None:
    """Allow a package's drivers, or no longer; another version is not meant. Raises OSError: cannot be written."""
    kept = _allowed() | {(package, version)} if is_allowed else _allowed() - {(package, version)}
    keep(FILE, sorted(kept))


def other_drivers() -> OtherDrivers:
    """Import the drivers that were allowed; not on the screen's thread."""
    allowed = _allowed()
    return load_drivers(allowed) if allowed else OtherDrivers()


def _allowed() -> set[tuple[str, str]]:
    """What cannot be read is allowed no longer."""
    try:
        kept = read_kept(FILE)
        return {(name, version) for name, version in kept if isinstance(name, str) and isinstance(version, str)}
    except (ValueError, TypeError):
        return set()
