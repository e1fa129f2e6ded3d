"""Which cited groups does the program bring along? The reference bands, read from its own files once."""

from functools import cache
from importlib.resources import files

from core.norms import ReferenceCurves, ReferenceValues, read_curves, read_time_distance

FOLDER = files("resources") / "reference_bands"


@cache
def reference_curves() -> ReferenceCurves:
    """Knee and ankle over the gait cycle, at one comfortable speed."""
    return read_curves(_text("fukuchi2018_young_treadmill_comfortable_knee_ankle.csv"))


@cache
def time_distance_classes() -> tuple[ReferenceValues, ...]:
    """Time and distance by class of speed, slow to fast."""
    return read_time_distance(_text("fukuchi2018_spatiotemporal_overground_by_froude_class.csv"))


def _text(name: str) -> str:
    return (FOLDER / name).read_text(encoding="utf-8")
