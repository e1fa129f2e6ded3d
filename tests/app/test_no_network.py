"""T16: a whole session calls nobody but this computer, and so does the search for sensors, unless it is asked to."""

import pytest

from devices.drivers.lsl import GROUP, PORT
from tests.safety.no_network import OWN_ADDRESS, calls_in, lead_session, search_sensors, why_not

LINES = """\
71 connect(3, {sa_family=AF_UNIX, sun_path=@"/tmp/.X11-unix/X1"}, 20) = 0
71 connect(4, {sa_family=AF_INET, sin_port=htons(9876), sin_addr=inet_addr("127.0.0.1")}, 16) = 0
71 connect(4, {sa_family=AF_INET6, sin6_port=htons(1), inet_pton(AF_INET6, "::1", &sin6_addr)}, 28) = 0
71 sendto(6, [{nlmsg_len=20}], 20, 0, {sa_family=AF_NETLINK, nl_pid=0, nl_groups=00000000}, 12) = 20
71 bind(5, {sa_family=AF_INET, sin_port=htons(10000), sin_addr=inet_addr("0.0.0.0")}, 16) = 0
72 connect(5, {sa_family=AF_INET, sin_port=htons(53), sin_addr=inet_addr("192.0.2.7")}, 16) = -1 ENETUNREACH
72 sendto(5, "x", 1, 0, {sa_family=AF_INET6, inet_pton(AF_INET6, "2001:db8::1", &sin6_addr)}, 28) = 1
72 sendto(5, "x", 1, 0, NULL, 0) = 1
"""


@pytest.fixture
def _network() -> None:
    if reason := why_not():
        pytest.skip(reason)


def test_a_call_to_elsewhere_is_reported_from_one_to_this_computer() -> None:
    calls = calls_in(LINES)
    assert calls.outside == tuple(LINES.splitlines()[5:7])
    assert calls.addresses == {"192.0.2.7", "2001:db8::1"}
    assert calls.families == {"AF_UNIX": 1, "AF_NETLINK": 1, "AF_INET": 2, "AF_INET6": 2}


@pytest.mark.endurance
@pytest.mark.usefixtures("_network")
def test_a_whole_session_calls_nobody_else() -> None:
    calls = lead_session()
    assert calls.families["AF_UNIX"] > 0  # the display at least: strace has seen what it should
    assert calls.outside == ()


@pytest.mark.endurance
@pytest.mark.usefixtures("_network")
@pytest.mark.parametrize("streams_in", ["", "127.0.0.1"])
def test_the_search_for_sensors_calls_nobody_else(streams_in: str) -> None:
    calls = search_sensors(streams_in)
    assert "x-IMU3" in calls.reported.partition("How the drivers")[0]  # that at the port was received
    assert ("a stream" in calls.reported) == bool(streams_in)
    assert calls.outside == ()


@pytest.mark.endurance
@pytest.mark.usefixtures("_network")
def test_streams_that_are_asked_for_in_a_network_are_asked_there_and_nowhere_else() -> None:
    pytest.importorskip("pylsl", reason="Lab Streaming Layer is an extra")
    calls = search_sensors(OWN_ADDRESS)
    assert "a stream" in calls.reported
    assert calls.addresses == {GROUP, OWN_ADDRESS}  # the question, and who answered it
    assert all(f"htons({PORT})" in line for line in calls.outside if GROUP in line)
