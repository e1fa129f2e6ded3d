"""Contrast of two colours: the ratio of WCAG 2.2, from 1 to 21, and what lies under see-through paint."""

LINEAR_UP_TO = 0.04045  # of sRGB, IEC 61966-2-1


def _channels(colour: str) -> tuple[int, int, int]:
    red, green, blue = (int(colour[k : k + 2], 16) for k in (1, 3, 5))
    return red, green, blue


def _luminance(colour: str) -> float:
    """Relative luminance, as WCAG 2.2 defines it."""
    shares = [channel / 255 for channel in _channels(colour)]
    linear = [share / 12.92 if share <= LINEAR_UP_TO else ((share + 0.055) / 1.055) ** 2.4 for share in shares]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: str, other: str) -> float:
    """Give the ratio of two colours, as "#14202B"; which of them lies above does not matter."""
    darker, lighter = sorted((_luminance(one), _luminance(other)))
    return (lighter + 0.05) / (darker + 0.05)


def over(colour: str, ground: str, alpha: float) -> str:
    """Give what a colour is that covers `alpha` of a ground."""
    mixed = (
        round(alpha * above + (1 - alpha) * below)
        for above, below in zip(_channels(colour), _channels(ground), strict=True)
    )
    return "#" + "".join(f"{channel:02X}" for channel in mixed)
