"""Alembic's way in. It runs inside of the transaction that `schema` has opened: a step is taken whole or not at all."""

from alembic import context

from app.storage.database.models import Base

context.configure(
    connection=context.config.attributes["connection"],
    target_metadata=Base.metadata,
    transactional_ddl=True,
    render_as_batch=True,  # SQLite alters little in place
)
with context.begin_transaction():
    context.run_migrations()
