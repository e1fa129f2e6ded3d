"""The drivers, one line each, and how each was proved; `devices/search.py` finds their sensors."""

from collections.abc import Callable
from dataclasses import dataclass

from devices.dot.decoder import DotDecoder
from devices.dot.samples import DRIVER as MOVELLA_DOT
from devices.drivers.csv_serial import DRIVER as CSV
from devices.drivers.csv_serial import CsvSerial
from devices.drivers.lsl import DRIVER as LSL
from devices.drivers.shimmer3 import DRIVER as SHIMMER3
from devices.drivers.shimmer3 import KNOCK as KNOCK_SHIMMER3
from devices.drivers.shimmer3 import Shimmer3
from devices.drivers.witmotion import DRIVER as WITMOTION
from devices.drivers.witmotion import WitMotion
from devices.drivers.witmotion_ble import DRIVER as WITMOTION_BLE
from devices.drivers.witmotion_ble import WitBle
from devices.drivers.ximu3 import DRIVER as XIMU3
from devices.drivers.ximu3 import Ximu3
from devices.drivers.xsens_mti import DRIVER as XSENS_MTI
from devices.drivers.xsens_mti import KNOCK as KNOCK_XSENS_MTI
from devices.drivers.xsens_mti import XsensMti
from devices.source import StreamDecoder
from devices.stream import Decoder, SensorProtocol


@dataclass(frozen=True, slots=True)
class Driver:
    """One maker's sensors.

    `protocol`: a new one as a search uses it; None: settings are needed before one can be made.
    `hint`: what a port's description gives where one of these is plugged in, so that it is spoken to although it is
    silent.
    """

    key: str  # as journals name it
    name: str
    proof: str  # against what it was tried, and against what not
    decoder: Callable[[], StreamDecoder] | None  # of the bytes in a journal; None: samples are kept, and need none
    protocol: Callable[[], SensorProtocol] | None = None
    bauds: tuple[int, ...] = ()  # of its serial ports, the likeliest first
    hint: str = ""
    knock: bytes = b""  # harmless to anything else; what is silent until it is asked to send answers with `knocked`
    knocked: bytes = b""


DRIVERS = (
    Driver(
        XIMU3,
        "x-io x-IMU3",
        "The maker's package (ximu3 1.9) and ours decode the same bytes to the same floats, and it speaks with our "
        "emulator. Six emulated ones led to right results. No hardware was at hand.",
        lambda: Decoder(Ximu3()),
        Ximu3,
        (115200,),
        "x-IMU3",
    ),
    Driver(
        WITMOTION,
        "WitMotion, standard protocol",
        "By the published protocol and damaged streams; six emulated ones on pseudo-terminals led to right results. No "
        "recorded stream and no hardware was at hand.",
        lambda: Decoder(WitMotion()),
        WitMotion,
        (115200, 9600, 230400),
    ),
    Driver(
        CSV,
        "text lines (CSV) over a serial port",
        "By damaged streams; six emulated ones on pseudo-terminals led to right results. What the columns mean has to "
        "be stated.",
        lambda: Decoder(CsvSerial()),
    ),
    Driver(
        LSL,
        "Lab Streaming Layer",
        "By real streams on this machine whose clock was off by 3 s and 200 ppm: stamps right to 2 ms. Streams of "
        "other makers' programs were not at hand.",
        None,
    ),
    Driver(
        XSENS_MTI,
        "Xsens MTi",
        "Five recorded streams are read to the last digit as another program read them, and it speaks with our "
        "emulator; six on pseudo-terminals led to right results. No hardware was at hand.",
        lambda: Decoder(XsensMti()),
        XsensMti,
        (115200, 921600),
        "MTi",
        *KNOCK_XSENS_MTI,
    ),
    Driver(
        SHIMMER3,
        "Shimmer3, LogAndStream",
        "By the published protocol, the checksums that the firmware tests itself with and damaged streams; six "
        "emulated ones on pseudo-terminals led to right results. No recorded stream and no hardware was at hand.",
        lambda: Decoder(Shimmer3()),
        Shimmer3,
        (115200,),
        "Shimmer3",
        *KNOCK_SHIMMER3,
    ),
    Driver(
        MOVELLA_DOT,
        "Movella DOT, Bluetooth LE",
        "Not tried on hardware. By the published bytes, and emulated ones behind the Bluetooth library's interface, "
        "also through a whole virtual radio: six were synchronised, streamed at 60 Hz, recorded at 120 Hz in their "
        "memory and fetched with lost links. No sensor and no radio link was at hand.",
        DotDecoder,
    ),
    Driver(
        WITMOTION_BLE,
        "WitMotion, Bluetooth LE",
        "Not tried on hardware. By the published frames, and emulated ones behind the Bluetooth library's interface, "
        "also through a whole virtual radio. Samples that are lost singly are not seen: they have no time or number.",
        lambda: Decoder(WitBle()),
    ),
)
