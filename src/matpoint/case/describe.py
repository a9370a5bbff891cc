"""What is wrong with a case, in one line; and the JSON schema of cases."""

from __future__ import annotations

import difflib
import inspect
import types
import typing
from collections.abc import Iterable
from typing import Any

from pydantic import BaseModel, ValidationError

_KINDS = {float: "number", int: "integer", str: "string", bool: "boolean"}


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """Return " (did you mean ...?)" or nothing."""
    near = difflib.get_close_matches(word, list(known), n=1)
    return f" (did you mean {near[0]!r}?)" if near else ""


def material_schemas() -> list[dict[str, Any]]:
    """Return the JSON schemas of the built-in materials, from their constructors."""
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
    return schemas


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


def first_problem(error: ValidationError, model: type[BaseModel]) -> str:
    """Return the first thing wrong: table and key, value, what is allowed."""
    found = error.errors(include_url=False)
    # An unknown key is the likeliest slip, and the message that helps most.
    problem = next((p for p in found if p["type"] == "extra_forbidden"), found[0])
    place, kind = problem["loc"], problem["type"]
    where = ".".join(str(p) for p in place)
    if kind == "extra_forbidden":
        allowed = _fields_at(model, place[:-1])
        key = str(place[-1])
        return f"{where}: unknown key{did_you_mean(key, allowed)}; allowed are {', '.join(allowed)}"
    if kind == "missing":
        return f"{where}: this key is missing"
    context = problem.get("ctx", {})
    if kind == "union_tag_invalid":
        tag = str(context.get("tag", ""))
        expected = [e.strip().strip("'") for e in str(context.get("expected_tags", "")).split(",")]
        return f"{where}.shape = {tag!r}{did_you_mean(tag, expected)}; allowed are {', '.join(expected)}"
    if kind == "literal_error":
        expected = [e.strip("' ") for e in str(context.get("expected", "")).replace(" or ", ",").split(",")]
        hint = did_you_mean(str(problem["input"]), expected)
        return f"{where} = {_shown(problem['input'])}{hint}; allowed are {', '.join(expected)}"
    message = problem["msg"].replace("Input should be", "must be")
    return f"{where} = {_shown(problem['input'])}: {message[0].lower() + message[1:]}"
