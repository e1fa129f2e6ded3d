"""T16: a whole session calls nobody but this computer."""

import pytest

from tests.safety.no_network import calls_in, lead_session, why_not

LINES = """\
71 connect(3, {sa_family=AF_UNIX, sun_path=@"/tmp/.X11-unix/X1"}, 20) = 0
71 connect(4, {sa_family=AF_INET, sin_port=htons(9876), sin_addr=inet_addr("127.0.0.1")}, 16) = 0
71 connect(4, {sa_family=AF_INET6, sin6_port=htons(1), inet_pton(AF_INET6, "::1", &sin6_addr)}, 28) = 0
72 connect(5, {sa_family=AF_INET, sin_port=htons(53), sin_addr=inet_addr("192.0.2.7")}, 16) = -1 ENETUNREACH
72 sendto(5, "x", 1, 0, {sa_family=AF_INET6, inet_pton(AF_INET6, "2001:db8::1", &sin6_addr)}, 28) = 1
72 sendto(5, "x", 1, 0, NULL, 0) = 1
"""


def test_a_call_to_elsewhere_is_told_from_one_to_this_computer() -> None:
    calls = calls_in(LINES)
    assert calls.outside == tuple(LINES.splitlines()[3:5])
    assert calls.families == {"AF_UNIX": 1, "AF_INET": 2, "AF_INET6": 2}


@pytest.mark.endurance
def test_a_whole_session_calls_nobody_else() -> None:
    if reason := why_not():
        pytest.skip(reason)
    calls = lead_session()
    assert calls.families["AF_UNIX"] > 0  # the display at least: strace has seen what it should
    assert calls.outside == ()
