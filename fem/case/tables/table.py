"""What every table of a case file is: frozen, strict, with rules between its keys, and keys that say what they mean."""

from functools import cache
from typing import Any, ClassVar, Self

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ModelWrapValidatorHandler, model_validator
from pydantic_core import PydanticUndefined

from fem.case.tables.problem import BrokenRulesError, Rule, broken
from fem.runtime.terminal import one_line

#: a text of one line, whatever ends of lines it was given
OneLine = AfterValidator(lambda text: one_line(text) if text else text)


class CaseTable(BaseModel):
    """A frozen table of a case file, with the rules between its keys."""

    model_config = ConfigDict(strict=True, frozen=True, extra="forbid", allow_inf_nan=False)
    rules: ClassVar[tuple[Rule, ...]] = ()

    @model_validator(mode="wrap")
    @classmethod
    def _obey_rules(cls, given: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        """Refuse a table that breaks rules, with every reason at once; one that is made already has obeyed them."""
        table = handler(given)
        if table is not given and (problems := broken(cls.rules, table)):
            raise BrokenRulesError(problems)
        return table

    @classmethod
    def as_meant(cls, given: dict[str, Any]) -> dict[str, Any]:
        """The keys of a file with what they imply, and short names written out."""
        return given

    def __dir__(self) -> list[str]:
        """What a notebook offers: the keys and what is made of them, without the names of pydantic."""
        return sorted(set(super().__dir__()) - (set(dir(BaseModel)) - set(dir(object))))

    def is_idle(self, name: str) -> bool:
        """Whether a key is not used because another option is chosen."""
        chosen = _options(type(self)).get(name)
        return chosen is not None and getattr(self, chosen[0]) not in chosen[1]


@cache
def _options(table: type[CaseTable]) -> dict[str, tuple[str, list[str]]]:
    """Of each key that belongs to some options only: the key that chooses, and those options."""
    extras: dict[str, Any] = {name: field.json_schema_extra for name, field in table.model_fields.items()}
    return {name: next(iter(extra["x-only-for"].items())) for name, extra in extras.items() if extra}


def case_key(
    description: str,
    default: Any = PydanticUndefined,
    *,
    follows: Any = None,
    example: Any = None,
    only: Any = None,
) -> Any:
    """A key of a table.

    Args:
        description: for the template of a case and the JSON schema.
        default: left out where the key must be given or its default follows others.
        follows: function of the keys above it that gives the default.
        example: for the template, where there is no default.
        only: the key that chooses whether this one is used, and the options for which it is.
    """
    given: dict[str, Any] = {"default_factory": follows} if follows else {"default": default}
    if example is not None:
        given["examples"] = [example]
    if only is not None:
        given["json_schema_extra"] = {"x-only-for": {only[0]: list(only[1:])}}
    return Field(description=description, **given)


def optional_key(description: str, example: Any, *, only: Any = None) -> Any:
    """A key that may be left out; arguments as for `case_key`."""
    return case_key(description, None, example=example, only=only)
