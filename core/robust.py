"""How far do values scatter, whatever a few of them do?"""

import numpy as np

from core.samples import FloatArray


def robust_sd(values: FloatArray) -> float:
    """Standard deviation by the median of the absolute values."""
    return float(1.4826 * np.median(np.abs(values))) if values.size else float("nan")
