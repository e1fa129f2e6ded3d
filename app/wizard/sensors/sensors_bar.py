"""What can be done with the sensors that are open, or why the session cannot go on with them yet."""

from typing import TYPE_CHECKING

from app.theme.icons import Icon
from app.widgets.action_bar import BarAction, BarState
from app.wording.translation import name_of, tr
from core.body import LEG_JOINTS, LEG_SITES, Site

if TYPE_CHECKING:
    from app.wizard.visit import Visit


def sensors_bar(visit: "Visit", silent: Site | None) -> BarState:
    """`silent`: where a sensor is worn that is not heard; None where all are."""
    sensors = visit.sensors
    if sensors.are_in_memory:
        back = BarAction(tr("Return to live"), tr("Enter"), is_wished=False)
        return BarState(primary=back, note=tr("The sensors are ready for walks. They send no live data."))
    if sensors.acquisition is None:
        return BarState(note="" if sensors.is_searching else tr("Choose where to search for sensors."))
    if reason := visit.cannot_record:
        other = BarAction(tr("Choose other sensors"), tr("Enter"), Icon.REPEAT)
        demonstration = BarAction(tr("Start with a demonstration patient"), is_wished=False)
        return BarState(primary=other, others=(demonstration,), note=reason)
    if silent is not None:
        again = BarAction(tr("Reconnect {site}").format(site=name_of(silent)), tr("Enter"), Icon.REPEAT)
        joints = (*LEG_JOINTS, *sensors.hips)
        lost = tr(" and ").join(name_of(one) for one in joints if silent in (one.proximal, one.distal))
        without = BarAction(tr("Continue without {joints}").format(joints=lost), is_wished=False)
        return BarState(primary=again, others=(without,) if sensors.joints else ())
    go_on = tr("Stand still")
    if sensors.is_left_to_motion:
        return BarState(
            primary=BarAction(go_on, tr("Enter")), note=tr("Sensor positions are detected in the free motion.")
        )
    if not sensors.joints:
        note = tr("Two sensors at one joint are needed: thigh and shank, or shank and foot.")
        return BarState(primary=BarAction(go_on, tr("Enter"), is_enabled=False), note=note)
    is_whole = set(LEG_SITES) <= sensors.sensor_at.keys()  # a pelvis is for whoever wants hips
    return BarState(primary=BarAction(go_on, tr("Enter"), is_wished=is_whole), note=sensors.price_of_missing())
