"""Where a sensor was worn, as its name gives it in the words that programs and people use for legs.

A guess for somebody to look at, never for a place where nobody does: names are given by hand.
"""

import re
from itertools import pairwise

from core.body import LEG_SITES, Segment, Side, Site

SIDES = {
    Side.LEFT: {"left", "l", "lt", "links", "li"},
    Side.RIGHT: {"right", "r", "rt", "rechts", "re"},
}
SEGMENTS = {
    Segment.THIGH: {"thigh", "femur", "upperleg", "upleg", "oberschenkel"},
    Segment.SHANK: {"shank", "tibia", "lowerleg", "lowleg", "unterschenkel", "calf"},
    Segment.FOOT: {"foot", "calcn", "calcaneus", "fuss", "fuß", "shoe"},
}
OF_PELVIS = {"pelvis", "sacrum", "becken", "kreuzbein"}
OF_LEGS = {"upper", "lower", "leg", "imu", "sensor"}
OTHER = {
    "arm",
    "forearm",
    "hand",
    "wrist",
    "knee",
    "ankle",
    "hip",
    "pelvis",
    "lumbar",
    "sternum",
    "chest",
    "head",
    "toe",
}


def site_of_name(name: str) -> Site | None:
    """Give the site of a name such as "Left Upper Leg", "femur_l" or "pelvis_imu"; None for none or two."""
    words = _words(name)
    sides = {side for side, known in SIDES.items() if known & set(words)}
    segments = {segment for segment, known in SEGMENTS.items() if known & set(words)}
    if OF_PELVIS & set(words) and not segments and not (OTHER - OF_PELVIS) & set(words):
        return Site.PELVIS
    if len(sides) != 1 or len(segments) != 1 or OTHER & set(words):
        return None
    (side,), (segment,) = sides, segments
    return next(site for site in LEG_SITES if (site.side, site.segment) == (side, segment))


def without_site(name: str) -> str:
    """Strip the site, and a sensor number of 8 or 12 hex digits at the end, from a name."""
    parts = re.split(r"[_\s-]+", name)
    if site_of_name(name) is not None:
        of_site = {word for group in (SIDES, SEGMENTS) for words in group.values() for word in words}
        of_site |= OF_LEGS | OF_PELVIS
        parts = [part for part in parts if not set(_single_words(part)) <= of_site]
    if parts and re.fullmatch(r"[0-9A-Fa-f]{8}|[0-9A-Fa-f]{12}", parts[-1]):
        parts = parts[:-1]
    return "_".join(parts)


def _words(name: str) -> list[str]:
    """Its words, and any two that stand together as one: "upper leg" is "upperleg" too."""
    words = _single_words(name)
    return words + ["".join(two) for two in pairwise(words)]


def _single_words(name: str) -> list[str]:
    """In small letters; a capital begins another."""
    return [word.casefold() for word in re.findall(r"[A-ZÄÖÜ]?[a-zäöüß]+|[A-ZÄÖÜ]+(?![a-zäöüß])|\d+", name)]
