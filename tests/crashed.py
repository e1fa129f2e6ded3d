"""Note for `packaging/test.py` a test that ended its process: that is no matter of a busy computer."""

from typing import Any

import pytest


@pytest.hookimpl(optionalhook=True)  # of pytest-xdist, which tries the test again in another process
def pytest_handlecrashitem(crashitem: str, sched: Any) -> None:
    sched.config.cache.set("gaitwright/crashed", crashitem)
