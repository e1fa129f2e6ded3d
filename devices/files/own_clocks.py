"""Files of sensors that each have a clock: they keep the times they report, where these can be of one trial."""

from collections.abc import Sequence
from dataclasses import replace

from core.findings import Finding, Severity
from devices.files.trial import ImportedSensor

LEAST_COMMON = 0.5  # of the shortest recording, during which all of one trial have to be received


def with_own_clocks(sensors: Sequence[ImportedSensor]) -> list[ImportedSensor]:
    """Name each sensor's own clock and begin the trial at 0 s; without common time, recordings begin together."""
    filled = [one for one in sensors if len(one.block)]
    if len(filled) < 2:
        return from_zero(sensors)
    starts_s, ends_s = ([float(one.block.time_s[k]) for one in filled] for k in (0, -1))
    shortest_s = min(end_s - start_s for start_s, end_s in zip(starts_s, ends_s, strict=True))
    is_one_trial = min(ends_s) - max(starts_s) >= LEAST_COMMON * shortest_s
    named = [replace(one, info=replace(one.info, clock=one.block.sensor)) for one in sensors]
    if is_one_trial:
        return from_zero(named)
    reported = Finding("not_synchronised", Severity.WARNING, "")
    return [replace(alone, findings=(*alone.findings, reported)) for one in named for alone in from_zero([one])]


def from_zero(sensors: Sequence[ImportedSensor]) -> list[ImportedSensor]:
    """Let the times of sensors that share a clock begin at 0 s with the first of them."""
    start_s = min((float(one.block.time_s[0]) for one in sensors if len(one.block)), default=0.0)
    return [replace(one, block=replace(one.block, time_s=one.block.time_s - start_s)) for one in sensors]
