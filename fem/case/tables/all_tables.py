"""Every table of a case file by its name, and the keys before the first."""

from typing import Annotated

from pydantic import Field, Strict

from fem.case.tables import quantities as q
from fem.case.tables.contact_tables import ContactTable, JointsTable
from fem.case.tables.container_tables import ContainerTable, SupportTable
from fem.case.tables.floors import FloorTable
from fem.case.tables.motion_tables import MotionTable, VerticalTable
from fem.case.tables.run_tables import (
    DocumentTable,
    InitialTable,
    OutputTable,
    RunLimitsTable,
    SolverTable,
    StaticTable,
    WindTable,
)
from fem.case.tables.table import CaseTable, OneLine, case_key
from fem.case.tables.uncertainty_table import UncertaintyTable

TABLES: dict[str, type[CaseTable]] = {
    "container": ContainerTable,
    "support": SupportTable,
    "contact": ContactTable,
    "floor": FloorTable,
    "joints": JointsTable,
    "motion": MotionTable,
    "vertical": VerticalTable,
    "initial": InitialTable,
    "static": StaticTable,
    "wind": WindTable,
    "limits": RunLimitsTable,
    "solver": SolverTable,
    "output": OutputTable,
    "uncertainty": UncertaintyTable,
    "document": DocumentTable,
}


#: tables that mean something by standing in a case file; the others have their defaults where they do not
OPTIONAL = frozenset({"static", "wind", "limits", "document"})


class CaseHeading(CaseTable):
    """The keys of a case file that stand before its first table."""

    schema_version: Annotated[int, Strict(), q.SCHEMA] = Field(
        default=1, alias="schema", description="of this file's keys"
    )
    title: Annotated[str, Field(max_length=500), OneLine] = case_key("for people", "")
    gravity_m_s2: Annotated[float, q.GRAVITY] = case_key(
        "g; the paper (Knoedel and Hrabowski) takes 10", 9.81
    )
