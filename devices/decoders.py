"""The decoder of every driver whose journals hold bytes, by the driver's key.

Drivers are imported when the first decoder is made, not with this module: the command line reads the keys at every
start. The walker, files and network inlets record samples, which need no decoder.
"""

from collections.abc import Callable, Mapping
from functools import partial
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from devices.source import StreamDecoder

BYTE_DRIVERS = (
    "ximu3",
    "witmotion",
    "csv",
    "xsens-mti",
    "shimmer3",
    "movella-dot",
    "witmotion-ble",
)  # those of `devices.catalogue.DRIVERS` with bytes


def _new_decoder(driver: str) -> "StreamDecoder":
    from devices.catalogue import DRIVERS  # numpy, and every driver

    decoder = next(one for one in DRIVERS if one.key == driver).decoder
    assert decoder is not None  # BYTE_DRIVERS are those that have one
    return decoder()


DECODERS: Mapping[str, Callable[[], "StreamDecoder"]] = {
    driver: partial(_new_decoder, driver) for driver in BYTE_DRIVERS
}
