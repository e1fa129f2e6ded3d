"""State of one worn sensor in a word, and of all of them in a sentence."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum, auto

from app.widgets.battery import LOW
from app.widgets.body_figure import SensorMark
from app.wording.body import name_of
from app.wording.translation import capitalised, tr
from core.body import Site
from devices.quiet import Quiet

LOST_SHARE = 0.01
SILENT_FROM_S = 1.0  # shorter is the radio's hiccup, and counts as loss


class TileState(Enum):
    FINE = auto()
    LOW_BATTERY = auto()
    MISPLACED = auto()
    LOSS = auto()
    SILENT = auto()
    QUIET = auto()
    NOT_WORN = auto()


@dataclass(frozen=True, slots=True)
class SensorTile:
    """What is known of the sensor at one site. `name` is the sensor's own; `battery` and `lost_share` 0 to 1.

    `is_awaited`: none is known to be worn here, the free motion is still to show it. `quiet`: why it is to send
    nothing; not `is_loss_seen`: nobody can see what is lost of it. `moves_like`: the place whose sensor it moves like,
    where that is another one's.
    """

    site: Site
    name: str
    battery: float | None
    rate_hz: float
    lost_share: float
    silent_s: float
    is_moving: bool
    is_worn: bool
    is_awaited: bool = False
    quiet: Quiet | None = None
    is_loss_seen: bool = True
    moves_like: Site | None = None

    @property
    def state(self) -> TileState:
        """The gravest thing that is true of it."""
        if not self.is_worn:
            return TileState.NOT_WORN
        if self.silent_s >= SILENT_FROM_S:
            return TileState.SILENT
        if self.quiet is not None:
            return TileState.QUIET
        if self.moves_like is not None:
            return TileState.MISPLACED
        if self.lost_share > LOST_SHARE:
            return TileState.LOSS
        if self.battery is not None and self.battery < LOW:
            return TileState.LOW_BATTERY
        return TileState.FINE

    @property
    def is_bad(self) -> bool:
        return self.state not in (TileState.FINE, TileState.QUIET, TileState.NOT_WORN)

    @property
    def words(self) -> str:
        """What its tile shows under the name."""
        match self.state:
            case TileState.NOT_WORN:
                return tr("detected later") if self.is_awaited else tr("not used")
            case TileState.SILENT:
                return tr("no signal {seconds} s").format(seconds=int(self.silent_s))
            case TileState.QUIET:
                return quiet_words(self.quiet)
            case TileState.MISPLACED if self.moves_like is not None:
                return tr("moves like {site}").format(site=name_of(self.moves_like))
            case TileState.LOSS:
                return _loss(self.lost_share)
            case TileState.LOW_BATTERY:
                return tr("charge soon · {percent} %").format(percent=round((self.battery or 0.0) * 100))
            case _ if not self.is_loss_seen:
                return tr("{rate} Hz").format(rate=round(self.rate_hz))
            case _:
                return rate_and_loss(self.rate_hz, self.lost_share)


def sentence(tiles: Mapping[Site, SensorTile]) -> str:
    """Say in one sentence how the sensors are: what is wrong with the first bad one, or that all of them send."""
    worn = [tile for tile in tiles.values() if tile.is_worn]
    bad = [tile for tile in worn if tile.is_bad]
    if len(bad) == 1:
        return tr("{site}: {words}").format(site=capitalised(name_of(bad[0].site)), words=bad[0].words)
    if bad:
        return tr("Check {bad} of {count} sensors").format(bad=len(bad), count=len(worn))
    if not worn:
        return tr("No sensors yet")
    if all(tile.state is TileState.QUIET for tile in worn):
        return tr("{count} sensors, {state}").format(count=len(worn), state=worn[0].words)
    return tr("{count} sensors, all connected").format(count=len(worn))


_MARKS = {TileState.SILENT: SensorMark.SILENT, TileState.MISPLACED: SensorMark.SWAPPED}


def marks(tiles: Mapping[Site, SensorTile]) -> dict[Site, SensorMark]:
    """Give how the sensors look on the legs."""
    found = {}
    for site, tile in tiles.items():
        if tile.is_worn:
            look = SensorMark.LOOK if tile.is_bad else SensorMark.WORN
            found[site] = _MARKS.get(tile.state, look)
    return found


def quiet_words(quiet: Quiet | None) -> str:
    """Why a sensor is to send nothing now."""
    return tr("in memory") if quiet is Quiet.IN_MEMORY else tr("syncing")


def _loss(share: float) -> str:
    return tr("{percent:.1f} % lost").format(percent=share * 100)


def rate_and_loss(rate_hz: float, lost_share: float) -> str:
    return f"{rate_hz:.0f} Hz · {_loss(lost_share)}"
