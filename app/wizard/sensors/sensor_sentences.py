"""Sentences on the page of the sensors: the one sentence that matters most, and what to do."""

from collections.abc import Collection, Mapping, Sequence

from app.theme.icons import Icon
from app.wizard.sensors.sensor_row import SensorRow
from app.wording.body import name_of, spelled_out
from app.wording.translation import capitalised, figure_text, tr
from core.body import LEG_SITES, Segment, Side, Site

NEARLY_EMPTY = 0.05  # of a battery: minutes

Stated = tuple[Icon | None, str, str, bool]
"""Icon, what is so, what to do, and whether it wants a look."""


def stated_of_dragged(sensor: str, site: Site, worn: Mapping[Site, SensorRow]) -> Stated:
    """What happens to a sensor that is dropped here."""
    other = worn.get(site)
    if other is not None and other.name != sensor:
        what = tr("{site} already has sensor {sensor}.").format(site=name_of(site), sensor=other.name)
        return Icon.INFO, capitalised(what), tr("Drop here to swap the two sensors."), False
    return Icon.INFO, capitalised(name_of(site)), tr("Drop {sensor} here.").format(sensor=sensor), False


def stated_of_shaken_together(sensors: Sequence[str]) -> Stated:
    """Several were shaken at once, which shows nothing."""
    first, *_, last = sensors
    what = (
        tr("{first} and {last} were both shaken.").format(first=first, last=last)
        if len(sensors) == 2
        else tr("{count} sensors were shaken.").format(count=len(sensors))
    )
    return Icon.WARNING, what, tr("Shake one sensor at a time."), True


def stated_of_sensors(
    sensors: Sequence[SensorRow],
    worn: Mapping[Site, SensorRow],
    bared: Collection[Site],
    next_place: Site | None,
    is_left_to_motion: bool,
    places: Sequence[Site] = LEG_SITES,
) -> Stated:
    """State in a sentence how the sensors are, or what is missing; `next_place` None: no shaking."""
    has_pelvis = Site.PELVIS in places
    if silent := [sensor for sensor in sensors if sensor.silent_s > 0]:
        return Icon.WARNING, *_stated_of_silent(silent[0], has_hips=Site.PELVIS in worn), True
    if (foot := _missing_foot(sensors, worn, bared, is_left_to_motion)) is not None:
        return Icon.WARNING, *_stated_of_missing_foot(foot), True
    if low := [sensor for sensor in sensors if sensor.is_low]:
        what = tr("{name}: battery at {charge}.").format(name=_called(low[0]), charge=low[0].charge)
        ends_soon = low[0].battery is not None and low[0].battery <= NEARLY_EMPTY
        soon, later = (
            tr("The sensor may stop during a walk. Charge it first."),
            tr("Charge the sensor after this patient."),
        )
        return Icon.WARNING, what, soon if ends_soon else later, True
    if lossy := [sensor for sensor in sensors if sensor.is_lossy]:
        what = tr("{name}: {share} % of the samples were lost.").format(
            name=_called(lossy[0]), share=figure_text(100 * lossy[0].lost_share, ".1f")
        )
        nearer = tr("Move the receiver closer to the patient.")
        if lossy[0].has_memory:
            nearer = tr(
                "Move this computer closer to the patient. Or choose the source again, with walks in sensor "
                "memory, or live at 30 Hz."
            )
        return Icon.WARNING, what, nearer, True
    if is_left_to_motion and not worn:
        what = tr("Sensor positions are detected in the free motion.")
        legs = tr("Attach one sensor to each thigh, shank and foot, in any order.")
        pelvis = tr("Attach one sensor to each thigh, shank and foot, and to the sacrum, in any order.")
        return Icon.INFO, what, pelvis if has_pelvis else legs, False
    if len(worn) == len(places):
        all_worn = (
            tr("All seven sensors are assigned and connected.")
            if has_pelvis
            else tr("All six sensors are assigned and connected.")
        )
        return Icon.CHECK, all_worn, "", False
    if Site.PELVIS in bared and has_pelvis and len(worn) == len(LEG_SITES):
        what = tr("No sensor on the pelvis: no hip angles.")
        return Icon.INFO, what, tr("Knees, ankles and steps are not affected."), False
    if sensors and len(worn) == len(sensors):
        return Icon.INFO, tr("All sensors have a position."), "", False
    if next_place is not None:
        what = tr("Shake the {site} sensor.").format(site=spelled_out(next_place))
        return Icon.NEXT, what, tr("Its position turns dark once the sensor is detected."), False
    return (
        Icon.NEXT,
        tr("Drag each sensor to its position."),
        tr("Or select a sensor and press 1 to {count}.").format(count=len(places)),
        False,
    )


def _missing_foot(
    sensors: Sequence[SensorRow], worn: Mapping[Site, SensorRow], bared: Collection[Site], is_left_to_motion: bool
) -> Site | None:
    """A foot that goes without a sensor: it was taken off, or none is left for it, while its shank has one."""
    if is_left_to_motion and not worn:
        return None
    is_any_left = any(sensor.site is None for sensor in sensors)
    for side in Side:
        foot, shank = Site(f"{side}_{Segment.FOOT}"), Site(f"{side}_{Segment.SHANK}")
        if foot not in worn and shank in worn and (foot in bared or not is_any_left):
            return foot
    return None


def _called(sensor: SensorRow) -> str:
    """A sensor by its place, or by its name while it has none."""
    return capitalised(name_of(sensor.site)) if sensor.site is not None else sensor.name


def _stated_of_silent(sensor: SensorRow, has_hips: bool) -> tuple[str, str]:
    seconds = max(round(sensor.silent_s), 1)
    what = tr("{name}: no signal for {seconds} s.").format(name=_called(sensor), seconds=seconds)
    if sensor.site is None:
        return what, tr("Switch the sensor off and on.")
    lost = {
        Site.LEFT_THIGH: tr("left knee angles"),
        Site.LEFT_SHANK: tr("left knee and ankle angles"),
        Site.LEFT_FOOT: tr("left ankle angles"),
        Site.RIGHT_THIGH: tr("right knee angles"),
        Site.RIGHT_SHANK: tr("right knee and ankle angles"),
        Site.RIGHT_FOOT: tr("right ankle angles"),
        Site.PELVIS: tr("hip angles; knees and ankles are not affected"),
    }
    if has_hips:
        lost |= {
            Site.LEFT_THIGH: tr("left knee and hip angles"),
            Site.RIGHT_THIGH: tr("right knee and hip angles"),
        }
    return what, tr("Switch the sensor off and on, or continue without {angles}.").format(angles=lost[sensor.site])


def _stated_of_missing_foot(foot: Site) -> tuple[str, str]:
    if foot.side is Side.LEFT:
        what = tr("No left foot sensor: no left ankle angles.")
    else:
        what = tr("No right foot sensor: no right ankle angles.")
    return what, tr("Steps are detected from the shank. The report states this.")
