"""What is wrong with a case, in one line; and the JSON schema of cases."""

from __future__ import annotations

import importlib
import inspect
import types
import typing
from collections.abc import Iterable
from typing import Any

from pydantic import BaseModel, GetJsonSchemaHandler, ValidationError
from pydantic_core import CoreSchema

from matpoint.errors import InputError, did_you_mean

_KINDS = {float: "number", int: "integer", str: "string", bool: "boolean"}
_WANTED = {
    "float_type": "a number", "int_type": "a whole number", "string_type": "a text",
    "bool_type": "true or false", "list_type": "a list", "dict_type": "a table", "model_type": "a table",
    "finite_number": "a finite number", "string_too_long": "a shorter text",
    "string_too_short": "a text that is not empty",
}  # fmt: skip


_MANY = 10  # names, beyond which the nearest says more than all of them


def choose(word: str, known: Iterable[str], where: str) -> None:
    """Refuse a word that is not one of some names, with the nearest of them, or all if none is near.

    Raises
    ------
    InputError
        If it is not among them.
    """
    names = list(known)
    if word in names:
        return
    hint = did_you_mean(word, names)
    allowed = "see matpoint list" if hint and len(names) > _MANY else f"allowed are {', '.join(names)}"
    raise InputError(f"{where} = {word!r}{hint}; {allowed}")


class OneOf:
    """Mark of a text that must be one of some names, listed in the JSON schema for editors.

    The names are looked up only when the schema is printed: their modules are slow to import. The
    check itself is made where the name is used.

    Parameters
    ----------
    module, table
        The registry whose keys, or items, are the names.
    """

    def __init__(self, module: str, table: str) -> None:
        self.module, self.table = module, table

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        names = getattr(importlib.import_module(self.module), self.table)
        return {**handler(core), "enum": list(names)}


def material_schemas() -> list[dict[str, Any]]:
    """Return the JSON schemas of the built-in materials, from their constructors, and of all others."""
    from matpoint.materials import MATERIALS  # noqa: PLC0415 (slow to import)

    schemas = []
    for law, factory in MATERIALS.items():
        properties: dict[str, Any] = {"law": {"const": law}}
        required = ["law"]
        for name, parameter in inspect.signature(factory).parameters.items():
            hint = typing.get_type_hints(factory).get(name, float)
            properties[name] = {"type": _KINDS.get(hint, "number")}
            if parameter.default is inspect.Parameter.empty:
                required.append(name)
            else:
                properties[name]["default"] = parameter.default
        schemas.append(
            {"title": law, "type": "object", "properties": properties, "required": required,
             "additionalProperties": False}
        )  # fmt: skip
    other = {"law": {"type": "string", "not": {"enum": list(MATERIALS)}}}
    return [*schemas, {"title": "a plugin's law", "type": "object", "properties": other, "required": ["law"]}]


def _models(annotation: Any) -> list[type[BaseModel]]:
    """All tables that an annotation may hold."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    if isinstance(annotation, str | type | types.NoneType):
        return []
    return [m for part in typing.get_args(annotation) for m in _models(part)]


def _fields_at(model: type[BaseModel], place: tuple[int | str, ...]) -> list[str]:
    """The keys allowed in the table at a place."""
    candidates = [model]
    for step in place:
        if isinstance(step, int):
            continue
        tagged = [m for m in candidates if _has_tag(m, step)]
        if tagged and step not in candidates[0].model_fields:
            candidates = tagged
            continue
        fields = [m.model_fields[step].annotation for m in candidates if step in m.model_fields]
        found = [m for annotation in fields for m in _models(annotation)]
        candidates = found or candidates
    return sorted({name for m in candidates for name in m.model_fields})


def _has_tag(model: type[BaseModel], tag: str) -> bool:
    field = model.model_fields.get("shape")
    return field is not None and tag in typing.get_args(field.annotation)


def _shown(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 80 else text[:77] + "..."


def _place(location: tuple[int | str, ...], content: Any) -> str:
    """Where in the file it is: pydantic's location without the names of the alternatives it tried."""
    steps: list[str] = []
    here: Any = content
    for step in location:
        try:
            here = here[step]
        except (KeyError, IndexError, TypeError):
            continue
        text = str(step)
        steps.append(text if text.isprintable() else repr(text))  # a message has one line
    return ".".join(steps)


def _join(*steps: str) -> str:
    return ".".join(step for step in steps if step)


def _expected(problem: Any) -> str:
    """What is allowed at the place of a problem, in plain words."""
    kind, context = problem["type"], problem.get("ctx", {})
    if kind in _WANTED:
        return _WANTED[kind]
    if kind in ("too_short", "too_long"):
        bound = (
            f"{context['min_length']} or more" if kind == "too_short" else f"at most {context['max_length']}"
        )
        return f"a list of {bound}"
    return problem["msg"].removeprefix("Input should be ")


def first_problem(error: ValidationError, model: type[BaseModel], content: Any) -> str:
    """Return the first thing wrong: table and key, value, what is allowed.

    Parameters
    ----------
    error
        What pydantic found.
    model
        The table that was checked.
    content
        What was checked, as read from the file.
    """
    found = error.errors(include_url=False)
    # An unknown key is the likeliest slip, and the message that helps most.
    problem = next((p for p in found if p["type"] == "extra_forbidden"), found[0])
    place, kind = problem["loc"], problem["type"]
    where, context = _place(place, content), problem.get("ctx", {})
    if kind == "extra_forbidden":
        allowed = _fields_at(model, place[:-1])
        hint = did_you_mean(str(place[-1]), allowed)
        return f"{where}: unknown key{hint}; allowed are {', '.join(allowed)}"
    if kind == "missing":
        return f"{_join(where, str(place[-1]))}: this key is missing"
    if kind == "union_tag_not_found":
        return f"{where}.shape: this key is missing; it says which shape it is, such as 'box'"
    if kind == "union_tag_invalid":
        tag, expected = str(context["tag"]), _listed(str(context["expected_tags"]))
        return f"{where}.shape = {tag!r}{did_you_mean(tag, expected)}; allowed are {', '.join(expected)}"
    if kind == "literal_error":
        expected = _listed(str(context["expected"]).replace(" or ", ","))
        hint = did_you_mean(str(problem["input"]), expected)
        return f"{where} = {_shown(problem['input'])}{hint}; allowed are {', '.join(expected)}"
    same = [p for p in found if _place(p["loc"], content) == where]
    wanted = " or ".join(dict.fromkeys(_expected(p) for p in same))
    return f"{where} = {_shown(problem['input'])}: must be {wanted}"


def _listed(text: str) -> list[str]:
    return [entry.strip("' ") for entry in text.split(",")]
