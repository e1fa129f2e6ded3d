"""A WebSocket on the loopback addresses alone, for as many clients as are bounded here.

A web page of another origin is refused, so that no site that somebody looks at can read along. `null` is another one:
browsers state it for a page that was opened from the disk, and for any frame that a site shuts off.
"""

import asyncio
import errno
import logging
import re
import socket
from collections.abc import Callable
from contextlib import suppress
from http import HTTPStatus
from typing import Any

import websockets.asyncio.server as library  # an extra: this module is imported once it is required
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response

ADDRESSES = ("127.0.0.1", "::1")
ORIGINS = (
    None,  # no web page
    re.compile(r"https?://(localhost|127\.0\.0\.1|\[::1\])(:\d{1,5})?"),
)
MOST_CLIENTS = 8
MOST_CONNECTIONS = 32  # with those that have not introduced themselves yet
BACKLOG = 16  # of those not accepted yet; as many are accepted at once, before any of them can be refused
MOST_BEHIND = 256 * 1024  # bytes that a client has not fetched, five seconds of six sensors
SEND_BUFFER = 64 * 1024  # bytes that the system holds besides
MOST_RECEIVED = 1024  # bytes of a message; none is read
OPEN_S, CLOSE_S = 5.0, 1.0
NO_IPV6 = (errno.EADDRNOTAVAIL, errno.EAFNOSUPPORT)

_log = logging.getLogger(__name__)
_quiet = logging.getLogger(f"{__name__}.library")
_quiet.setLevel(logging.CRITICAL)  # whoever knocks ten thousand times would fill the log


def listening_sockets(port: int) -> list[socket.socket]:
    """Give sockets that listen to this computer alone; OSError where the port is another program's."""
    found: list[socket.socket] = []
    try:
        for address in ADDRESSES:
            family = socket.AF_INET6 if ":" in address else socket.AF_INET
            try:
                one = socket.create_server((address, port), family=family, backlog=BACKLOG)
            except OSError as problem:
                if family is socket.AF_INET6 and problem.errno in NO_IPV6:
                    continue
                raise
            one.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BUFFER)
            found.append(one)
            port = one.getsockname()[1]  # 0 was any: the same for both
    except OSError:
        for one in found:
            one.close()
        raise
    return found


class WebSocketServer:
    """Sends lines to all clients. Works on one loop; `welcome` gives the lines that a new client gets first.

    Attributes
    ----------
    clients
        How many receive.
    closed, latest_closed
        How many were too slow and were closed, and which was the latest.
    """

    def __init__(self, sockets: list[socket.socket], welcome: Callable[[], list[str]]) -> None:
        self._sockets, self._welcome = sockets, welcome
        self._servers: list[library.Server] = []
        self._open: set[_Connection] = set()
        self._clients: dict[library.ServerConnection, str] = {}
        self._numbers = 0
        self.closed, self.latest_closed = 0, ""

    @property
    def clients(self) -> int:
        return len(self._clients)

    async def open(self) -> None:
        for one in self._sockets:
            server = await library.serve(
                self._serve,
                sock=one,
                backlog=BACKLOG,
                origins=ORIGINS,
                compression=None,
                server_header=None,
                process_request=self._refuse_crowd,
                open_timeout=OPEN_S,
                close_timeout=CLOSE_S,
                max_size=MOST_RECEIVED,
                max_queue=1,
                logger=_quiet,
                create_connection=self._connection,  # type: ignore[arg-type]  # a wrapper is taken too, as its manual states
            )
            self._servers.append(server)

    async def close(self) -> None:
        for server in self._servers:
            server.close()
        for connection in tuple(self._open):
            connection.transport.abort()
        for server in self._servers:
            await server.wait_closed()
        for one in self._sockets:  # also of a server that was stopped before it served
            one.close()

    def send(self, line: str) -> None:
        """Hand a line to every client, waiting for none; one that is too far behind is closed."""
        behind = [one for one in self._clients if one.transport.get_write_buffer_size() > MOST_BEHIND]
        for one in behind:
            self.closed += 1
            self.latest_closed = f"{self._clients.pop(one)}: too slow"
            _log.warning("live output: %s", self.latest_closed)
            one.transport.abort()
        library.broadcast(self._clients, line)

    async def _serve(self, connection: library.ServerConnection) -> None:
        self._numbers += 1
        try:
            self._clients[connection] = f"client {self._numbers}"
            for line in self._welcome():
                library.broadcast([connection], line)
            with suppress(ConnectionClosed):
                await connection.recv()  # until it goes; who sends anything is shown out
                await connection.close(1003, "nothing is received here")
        finally:
            self._clients.pop(connection, None)

    def _refuse_crowd(self, connection: library.ServerConnection, _request: Request) -> Response | None:
        if len(self._clients) < MOST_CLIENTS:
            return None
        return connection.respond(HTTPStatus.SERVICE_UNAVAILABLE, "Too many programs are connected.\n")

    def _connection(self, *args: Any, **kwargs: Any) -> "_Connection":
        return _Connection(self._open, *args, **kwargs)


class _Connection(library.ServerConnection):
    """Goes at once where too many are there, so that no program takes the files that the recording needs."""

    def __init__(self, others: "set[_Connection]", *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._others = others

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        super().connection_made(transport)
        if len(self._others) >= MOST_CONNECTIONS:
            self.transport.abort()
        else:
            self._others.add(self)

    def connection_lost(self, exc: Exception | None) -> None:
        self._others.discard(self)
        super().connection_lost(exc)
