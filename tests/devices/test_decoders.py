"""Journals of every driver that records bytes can be decoded, and the table of decoders loads no driver."""

import subprocess
import sys

from devices.catalogue import DRIVERS
from devices.decoders import BYTE_DRIVERS, DECODERS
from devices.source import SourceInfo


def test_every_driver_that_records_bytes_has_its_decoder() -> None:
    assert set(BYTE_DRIVERS) == {driver.key for driver in DRIVERS if driver.decoder is not None}
    for driver, make in DECODERS.items():
        decoder = make()
        assert decoder is not make(), "each journal has one of its own"
        if driver != "csv":
            decoder.begin(SourceInfo(driver, "1", sensors=("one",)))
            assert len(decoder.finish()["one"].block) == 0


def test_the_table_of_decoders_loads_no_driver() -> None:
    program = "import sys, devices.decoders; print('numpy' in sys.modules, 'devices.catalogue' in sys.modules)"
    ran = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert ran.stdout.split() == ["False", "False"]
