"""What packages of other authors offer by their entry points. Finding it imports nothing of theirs.

A name of ours stays ours; of two packages that offer the same name the first by the alphabet has it.
"""

from collections.abc import Collection
from contextlib import suppress
from dataclasses import dataclass
from importlib.metadata import EntryPoint, entry_points
from typing import TypeVar

SENSORS, IMPORTERS = "gaitwright.sensors", "gaitwright.importers"  # the groups of entry points
OURS = "gaitwright"
MOST_LETTERS = 100  # of a name: it is shown

T = TypeVar("T")


class BrokenOfferError(Exception):
    """What a package offers cannot be used; its text states why."""


@dataclass(frozen=True, slots=True)
class Offer:
    """One entry point: its name, and the package that has it. `taken_by`: whose the name is, where it is not free."""

    name: str
    package: str
    version: str
    entry: EntryPoint
    taken_by: str = ""

    def load(self, kind: type[T]) -> T:
        """Import what is offered; raises BrokenOfferError where that fails, or where it is of another kind."""
        if self.taken_by:
            raise BrokenOfferError(f"the name {self.name} is already used by {self.taken_by}")
        try:
            found = self.entry.load()
        except (Exception, SystemExit) as error:  # the edge to a stranger's module
            raise BrokenOfferError(f"it cannot be loaded ({type(error).__name__})") from error
        if not isinstance(found, kind):
            raise BrokenOfferError(f"it is no {kind.__name__}")
        return found


def offers(group: str, ours: Collection[str]) -> tuple[Offer, ...]:
    """Find what other packages offer in a group, by name and package; `ours`: names that are not free."""
    known = [offer for entry in entry_points(group=group) if (offer := _offer(entry)) is not None]
    found: list[Offer] = []
    owners = dict.fromkeys(ours, OURS)
    for offer in sorted(known, key=lambda one: (one.name, one.package)):
        taken_by = owners.get(offer.name, "")
        owners.setdefault(offer.name, offer.package)
        found.append(Offer(offer.name, offer.package, offer.version, offer.entry, taken_by))
    return tuple(found)


def _offer(entry: EntryPoint) -> Offer | None:
    """None where the package's own description is damaged."""
    with suppress(Exception):  # files of a stranger, read by the standard library
        if entry.dist is not None:
            texts = entry.name, entry.dist.name, entry.dist.version
            if all(isinstance(text, str) and text.isprintable() and 0 < len(text) <= MOST_LETTERS for text in texts):
                return Offer(*texts, entry)
    return None
