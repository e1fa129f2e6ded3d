"""The examples in the docstrings of the entry points run as they stand, on public names and a simulated session."""

import doctest
from pathlib import Path

import pytest

import core
import devices
from devices.simulation.walker import SimulatedSession

ENTRY_POINTS = (devices.read_session, core.analyse, core.follow, core.identify, core.LiveWalk)


@pytest.mark.endurance
@pytest.mark.parametrize("entry", ENTRY_POINTS, ids=lambda entry: entry.__name__)
def test_the_example_of_an_entry_point_runs(entry: object, simulated: SimulatedSession, folder: Path) -> None:
    names = {name: getattr(package, name) for package in (core, devices) for name in package.__all__}
    standing, _, walk = simulated.session.recordings
    names |= {"folder": folder, "session": simulated.session, "standing": standing, "walk": walk}
    (found,) = doctest.DocTestFinder(recurse=False).find(entry, globs=names)
    assert found.examples
    stated: list[str] = []
    failed, _ = doctest.DocTestRunner().run(found, out=stated.append)
    assert failed == 0, "".join(stated)
