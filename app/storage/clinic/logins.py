"""Make a station a login of its own on the clinic's server: the owner's password stays with the owner."""

import secrets
from dataclasses import replace

from sqlalchemy import make_url, text

from app.storage.clinic.station import Station, driver_url
from app.storage.database.engine import Database
from app.storage.stored import LibraryError

ROLE = "gaitwright_app"
PASSWORD_BYTES = 24


def station_login(station: Station) -> Station:
    """Give a station an address with its own login, which `let_in` makes; raises LibraryError."""
    url = make_url(driver_url(station.database)).set(
        drivername="postgresql",
        username=f"gaitwright_{station.id.partition('-')[0]}",
        password=secrets.token_urlsafe(PASSWORD_BYTES),
    )
    return replace(station, database=url.render_as_string(hide_password=False))


def let_in(server: Database, own: Station) -> None:
    """Make a station's login on a server open with the rights to; raises LibraryError without them."""
    from psycopg import sql  # an extra, of clinics

    url = make_url(own.database)
    with server.reading() as session:
        query = text("SELECT rolcreaterole OR rolsuper FROM pg_roles WHERE rolname = current_user")
        if not session.scalar(query):
            raise LibraryError(
                "This database login is not permitted to create a login for the workstation",
                "Move the library with the login of the server's owner, or give this login CREATEROLE",
            )
    with server.writing() as session:
        connection = session.connection().connection.driver_connection
        assert connection is not None
        name, password = str(url.username).encode(), str(url.password).encode()
        sealed = connection.pgconn.encrypt_password(password, name, b"scram-sha-256")  # the server logs statements
        role, sealed_password = sql.Identifier(name.decode()), sql.Literal(sealed.decode())
        # a move that was broken off had made it already
        is_known = session.scalar(text("SELECT true FROM pg_roles WHERE rolname = :name"), {"name": url.username})
        made = "ALTER ROLE {} LOGIN PASSWORD {}" if is_known else "CREATE ROLE {} LOGIN PASSWORD {} IN ROLE {}"
        connection.execute(sql.SQL(made).format(role, sealed_password, sql.Identifier(ROLE)))
