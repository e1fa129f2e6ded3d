"""Orientation filter VQF (Laidig & Seel 2023): its compiled package where there is one, else our own port.

The package has no wheel for ARM under Linux and Windows, nor for Python 3.14. Both give the same up to rounding:
`tests/core/signal/test_published_filter.py`.
"""

from importlib.metadata import PackageNotFoundError, version

import numpy as np

from core.samples import FloatArray
from core.signal.published_filter import BIAS_SD_DEG_S, TAU_ACC_S, PublishedFilter
from core.signal.published_offline import offline_quaternions

try:
    import vqf
except ImportError:  # not installed, or not made for this computer
    vqf = None


def _name() -> str:
    if vqf is None:
        return "vqf own port"
    try:
        return f"vqf {version('vqf')}"
    except PackageNotFoundError:  # copied without what is stated about it
        return "vqf of unknown version"


FILTER = _name()
"""Which of both computes: they differ in the last digits."""


class PackageFilter:
    """The package's causal filter without magnetometer, with the names of `PublishedFilter`."""

    def __init__(self, step_s: float, tau_acc_s: float = TAU_ACC_S, bias_sd_deg_s: float = BIAS_SD_DEG_S) -> None:
        self._filter = vqf.VQF(step_s, tauAcc=tau_acc_s, biasSigmaInit=bias_sd_deg_s)

    def reset(self) -> None:
        """Begin as with the first sample."""
        self._filter.resetState()

    def bias(self) -> tuple[FloatArray, float]:
        """Give the bias (3,) and an upper bound of its deviation, rad/s."""
        return self._filter.getBiasEstimate()

    def set_bias(self, bias_rad_s: FloatArray, sd_rad_s: float) -> None:
        """Begin with what is known of the bias (3,), whose deviation is the same in all directions."""
        self._filter.setBiasEstimate(bias_rad_s, sd_rad_s)

    def update(self, gyr_rad_s: FloatArray, acc_m_s2: FloatArray) -> FloatArray:
        """Give quaternions (n, 4), earth from sensor, of the next rates and specific forces (n, 3)."""
        return np.asarray(self._filter.updateBatch(_plain(gyr_rad_s), _plain(acc_m_s2))["quat6D"])


def live_filter(step_s: float, tau_acc_s: float, bias_sd_deg_s: float) -> PackageFilter | PublishedFilter:
    """Give a causal filter for samples every `step_s`."""
    return (PublishedFilter if vqf is None else PackageFilter)(step_s, tau_acc_s, bias_sd_deg_s)


def filtered_offline(gyr_rad_s: FloatArray, acc_m_s2: FloatArray, mag: FloatArray | None, step_s: float) -> FloatArray:
    """Give quaternions (n, 4), earth from sensor, of rates over the intervals before samples and of forces (n, 3).

    The earth's y points north with fields (n, 3), and anywhere without.
    """
    gyr, acc, field = _plain(gyr_rad_s), _plain(acc_m_s2), None if mag is None else _plain(mag)
    if vqf is None:
        return offline_quaternions(gyr, acc, field, step_s)
    return np.asarray(vqf.offlineVQF(gyr, acc, field, step_s)["quat6D" if field is None else "quat9D"])


def _plain(values: FloatArray) -> FloatArray:
    """As compiled code takes them."""
    return np.ascontiguousarray(values, dtype=np.float64)
