"""Print the gait events of a foot while it walks, from a sensor that sends lines of numbers to a serial port.

    python -m tests.examples.live_from_a_port PORT SECONDS

The sensor sends one line per sample: milliseconds, rates in deg/s, forces in g, separated by commas. Printed is one
line per event when it is known, at most a tenth of a second after it happened unless it states late, and the cadence at
the end. `LiveEvents` wants rates without the gyroscope's bias; where it is not small, take off what `rest_of` finds in
some seconds of standing.
"""

import sys
from collections.abc import Callable
from contextlib import closing

from core import LiveEvents
from devices import ByteSource, Columns, CsvSerial, PortInfo, SerialPort, host_time_ns

COLUMNS = Columns(time=0, rate=(1, 2, 3), force=(4, 5, 6), count=7)


def main(port: str, seconds: float, now_ns: Callable[[], int] = host_time_ns) -> None:
    """`now_ns` is the host's clock; another one lets a recorded sensor run faster than time."""
    source = ByteSource(CsvSerial(COLUMNS), SerialPort(PortInfo(port)), now_ns)
    foot = LiveEvents()
    end_ns = now_ns() + round(1e9 * seconds)
    kept: list[bytes] = []  # what was read, before anything decodes it: `Decoder` reads it again
    with closing(source):
        source.open()
        while now_ns() < end_ns:
            for block in source.read(kept.append):
                for event in foot.update(block.time_s, block.gyr_rad_s, block.acc_m_s2):
                    print(f"{event.event}{' (late)' if event.is_late else ''}")
    print(f"cadence {foot.cadence_steps_min:.0f} steps/min")


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]))
