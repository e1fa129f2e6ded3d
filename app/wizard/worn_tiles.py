"""The tiles of the sensors that are worn, as they stand above every step: sending, silent, moving, their batteries."""

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from app.widgets.sensor_tile import SensorTile
from app.wizard.worn_sensors import WornSensors
from core.body import LEG_SITES, Site

if TYPE_CHECKING:
    from app.acquisition.acquisition import SensorStatus

MOVES_RAD_S = 0.1  # a sensor on a standing patient stays below


def worn_tiles(sensors: WornSensors) -> dict[Site, SensorTile]:
    """Give one for each site of the legs, and for the pelvis where a sensor is worn there or may be."""
    status, worn = sensors.status, sensors.sensor_at
    is_awaited = sensors.is_left_to_motion and not worn
    has_pelvis = Site.PELVIS in worn or (is_awaited and Site.PELVIS in sensors.places)
    sites = tuple(Site) if has_pelvis else LEG_SITES
    return {site: _tile(site, worn.get(site), status, is_awaited, sensors.detected.get(site)) for site in sites}


def _tile(
    site: Site, sensor: str | None, status: "Mapping[str, SensorStatus]", is_awaited: bool, moves_like: Site | None
) -> SensorTile:
    if sensor is None or sensor not in status:
        nothing = SensorTile(site, sensor or "", None, 0.0, 0.0, 0.0, is_moving=False, is_worn=False)
        return replace(nothing, is_awaited=is_awaited)
    received = status[sensor]
    return SensorTile(
        site,
        sensor,
        received.details.battery,
        received.received_hz,
        received.lost_share,
        received.silent_s,
        is_moving=received.movement_rad_s > MOVES_RAD_S,
        is_worn=True,
        quiet=received.details.quiet,
        is_loss_seen=received.details.is_loss_seen,
        moves_like=moves_like,
    )
