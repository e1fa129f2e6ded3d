"""Operators who work with a library, their roles, and what was set for all of them."""

from dataclasses import replace
from typing import Any

from sqlalchemy import select
from sqlalchemy.orm import Session as OrmSession

from app.storage.audit import about, note
from app.storage.database.engine import changed_meanwhile
from app.storage.database.models import OperatorRow, SettingRow, folded
from app.storage.database.values import operator_of
from app.storage.stored import Action, LibraryError, Operator, Role
from app.storage.unit_of_work import UnitOfWork


class Operators:
    """Administrators' business. Key slots are made and removed beside it, under the same codes (`app.storage.keys`)."""

    def __init__(self, unit: UnitOfWork) -> None:
        self._unit = unit

    def list(self) -> tuple[Operator, ...]:
        with self._unit.reading() as session:
            return tuple(operator_of(row) for row in session.scalars(select(OperatorRow).order_by(OperatorRow.code)))

    def add(self, operator: Operator) -> Operator:
        """Add an operator; raises LibraryError where the code is taken."""
        with self._unit.writing(Role.ADMINISTRATOR) as session:
            if session.get(OperatorRow, folded(operator.code)) is not None:
                raise LibraryError("Another user has this code", "Choose another code")
            row = add_operator(session, self._unit, operator)
            return operator_of(row)

    def change(self, operator: Operator) -> Operator:
        """Change an operator's name, role or access; ChangedMeanwhileError, LibraryError for the last admin."""
        with self._unit.writing(Role.ADMINISTRATOR) as session:
            row = session.get(OperatorRow, folded(operator.code))
            if row is None or row.version != operator.version:
                raise changed_meanwhile()
            row.name, row.role, row.is_active = operator.name, operator.role, operator.is_active
            session.flush()
            administrators = select(OperatorRow.code).where(
                OperatorRow.role == Role.ADMINISTRATOR, OperatorRow.is_active
            )
            if session.scalars(administrators).first() is None:
                raise LibraryError(
                    "A library needs an administrator", "Give the administrator role to someone else first"
                )
            details = {"role": row.role.value, "is_active": row.is_active}
            note(self._unit, session, Action.EDIT, about("operator", row.code), **details)
            return operator_of(row)


CLINIC = "clinic"  # its name, as reports print it


class OperatorSettings:
    """What holds for the whole clinic. Values are whatever JSON holds."""

    def __init__(self, unit: UnitOfWork) -> None:
        self._unit = unit

    def get(self, name: str, default: Any = None) -> Any:
        with self._unit.reading() as session:
            return SettingRow.of(session, name, default)

    def put(self, name: str, value: Any) -> None:
        with self._unit.writing(Role.ADMINISTRATOR) as session:
            SettingRow.put(session, name, value)
            note(self._unit, session, Action.EDIT, about("setting", name))


def add_operator(session: OrmSession, unit: UnitOfWork, operator: Operator) -> OperatorRow:
    own = replace(operator, code=folded(operator.code))
    row = OperatorRow(code=own.code, name=own.name, role=own.role, is_active=own.is_active, created_at=unit.now())
    session.add(row)
    session.flush()
    note(unit, session, Action.CREATE, about("operator", own.code), role=own.role.value)
    return row
