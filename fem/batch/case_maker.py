"""Many cases that differ from a base case in a few keys, made without validating all of it again."""

from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

from fem.case.case import Case
from fem.case.overrides import keys_in_effect, with_overrides
from fem.case.tables.all_tables import TABLES
from fem.case.tables.links import ROWS


class CaseMaker:
    """Makes `base.with_values(values)`, at a tenth of the cost.

    Only the tables that change and the rules of the whole case are checked again; a case that breaks one is made the
    long way, which names the error.
    """

    def __init__(self, base: Case) -> None:
        self.base = base
        self._kinds = base.kinds
        #: by the keys that are set: what does not change, and the content of the tables that do
        self._templates: dict[tuple[str, ...], tuple[dict[str, Any], dict[str, dict[str, Any]]]] = {}

    def __call__(self, values: Mapping[str, Any]) -> Case:
        """The base with dotted keys set; alternatives are replaced.

        Raises:
            CaseError: as for a case file.
        """
        given = values
        values = keys_in_effect(values, self._kinds)
        keys = tuple(values)
        if any(key.rpartition(".")[0] in ROWS for key in keys):  # all rows of a table change
            return self.base.with_values(given)
        if keys not in self._templates:
            self._templates[keys] = self._template(values)
        fixed, touched = self._templates[keys]
        heading: dict[str, Any] = {}
        content = {name: dict(given) for name, given in touched.items()}
        for dotted, value in values.items():
            table, _, key = dotted.rpartition(".")
            (content[table] if table else heading)[key] = value
        try:
            tables = {name: TABLES[name].model_validate(given) for name, given in content.items()}
            return Case.model_validate(fixed | heading | tables).from_origin(self.base.origin_with(given))
        except ValidationError:
            return self.base.with_values(given)

    def _template(self, values: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, dict[str, Any]]]:
        data = with_overrides(self.base.given(), values)
        names = {key.rpartition(".")[0] for key in values} - {""}
        fixed = {key: value for key, value in data.items() if key not in TABLES and key not in ROWS}
        fixed |= {name: rows for name in ROWS if (rows := getattr(self.base, name))}
        fixed |= {name: getattr(self.base, name) for name in TABLES if name not in names}
        return fixed, {name: data[name] for name in names}
