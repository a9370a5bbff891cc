"""Expressions of place and time in case files, evaluated by walking a whitelisted syntax tree.

Nothing is ever executed: Python's parser gives a tree, and only the node types and names below are
understood, each by a NumPy function.
"""

from __future__ import annotations

import ast
import difflib
import operator
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from matpoint.errors import InputError

_LONGEST = 500  # characters
_DEEPEST = 100  # nested operations; a sum of n terms is n deep
_LARGEST_POWER = 64.0


def _step(value: Any) -> Any:
    """0 below zero, 1 from zero on."""
    return np.where(np.asarray(value) >= 0.0, 1.0, 0.0)


_FUNCTIONS: dict[str, tuple[Callable[..., Any], int]] = {
    "sin": (np.sin, 1), "cos": (np.cos, 1), "tan": (np.tan, 1), "atan2": (np.arctan2, 2),
    "sinh": (np.sinh, 1), "cosh": (np.cosh, 1), "tanh": (np.tanh, 1), "exp": (np.exp, 1),
    "log": (np.log, 1), "sqrt": (np.sqrt, 1), "abs": (np.abs, 1), "min": (np.minimum, 2),
    "max": (np.maximum, 2), "where": (np.where, 3), "step": (_step, 1),
}  # fmt: skip
_CONSTANTS = {"pi": np.pi}
_BINARY: dict[type, Callable[[Any, Any], Any]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: np.true_divide,
}  # fmt: skip
_COMPARE: dict[type, Callable[[Any, Any], Any]] = {
    ast.Lt: operator.lt, ast.LtE: operator.le, ast.Gt: operator.gt, ast.GtE: operator.ge,
}  # fmt: skip


def _hint(name: str, known: Iterable[str]) -> str:
    near = difflib.get_close_matches(name, list(known), n=1)
    return f" (did you mean {near[0]!r}?)" if near else ""


class Expression:
    """A formula of some variables.

    Parameters
    ----------
    text
        For instance ``"0.1 * sin(2 * pi * x) * t"``.
    variables
        The names that it may use.
    where
        Its place in the case file, for messages.

    Raises
    ------
    InputError
        If it can't be parsed, is too long or deep, or uses anything but numbers, the variables,
        ``pi``, + - * / **, comparisons (1 if true, 0 if not) and the functions sin cos tan atan2
        sinh cosh tanh exp log sqrt abs min max, where(condition, then, else) and step (0 below
        zero, 1 from zero on). A power must be a number.
    """

    def __init__(self, text: str, variables: tuple[str, ...], where: str) -> None:
        self.text, self.variables, self.where = text, variables, where
        if len(text) > _LONGEST:
            raise self._error(f"is {len(text)} characters long; {_LONGEST} is the most")
        try:
            self._tree = ast.parse(text.strip(), mode="eval").body
        except (SyntaxError, ValueError, MemoryError, RecursionError) as error:
            raise self._error(f"is not a formula ({getattr(error, 'msg', error)})") from None
        self._check(self._tree, 0)

    def __call__(self, **values: Any) -> Any:
        """Return the value for arrays or numbers given by name."""
        with np.errstate(all="ignore"):  # what is not finite is refused by whoever asked
            return self._value(self._tree, values)

    def _error(self, what: str) -> InputError:
        shown = self.text if len(self.text) <= 60 else self.text[:57] + "..."
        return InputError(f"{self.where}: expression {shown!r} {what}")

    def _check(self, node: ast.AST, depth: int) -> None:
        if depth > _DEEPEST:
            raise self._error(f"is nested more than {_DEEPEST} deep")
        if isinstance(node, ast.Constant):
            if isinstance(node.value, bool) or not isinstance(node.value, int | float):
                raise self._error(f"holds {node.value!r}; only numbers are allowed")
            if isinstance(node.value, int) and abs(node.value) > 1e300:
                raise self._error("holds a number that is too large")
        elif isinstance(node, ast.Name):
            self._check_name(node.id)
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.UAdd | ast.USub):
            self._check(node.operand, depth + 1)
        elif isinstance(node, ast.BinOp) and isinstance(node.op, (*_BINARY, ast.Pow)):
            self._check(node.left, depth + 1)
            self._check(node.right, depth + 1)
            if isinstance(node.op, ast.Pow):
                self._check_power(node.right)
        elif isinstance(node, ast.Compare) and len(node.ops) == 1 and type(node.ops[0]) in _COMPARE:
            self._check(node.left, depth + 1)
            self._check(node.comparators[0], depth + 1)
        elif isinstance(node, ast.Call):
            self._check_call(node, depth)
        else:
            raise self._error(f"uses {type(node).__name__}, which is not allowed")

    @staticmethod
    def _number(node: ast.Constant) -> float:
        assert isinstance(node.value, int | float)  # _check has seen to it
        return float(node.value)

    def _check_name(self, name: str) -> None:
        known = (*self.variables, *_CONSTANTS)
        if name not in known:
            raise self._error(f"uses {name!r}{_hint(name, known)}; {', '.join(known)} are allowed")

    def _check_power(self, node: ast.AST) -> None:
        while isinstance(node, ast.UnaryOp):
            node = node.operand
        if not isinstance(node, ast.Constant) or abs(self._number(node)) > _LARGEST_POWER:
            raise self._error(f"has a power that is not a number up to {_LARGEST_POWER:g}")

    def _check_call(self, node: ast.Call, depth: int) -> None:
        name = node.func.id if isinstance(node.func, ast.Name) else ""
        if name not in _FUNCTIONS or node.keywords:
            called = f"{name!r}{_hint(name, _FUNCTIONS)}" if name else "what has no plain name"
            raise self._error(f"calls {called}; {', '.join(_FUNCTIONS)} are allowed, without keywords")
        if len(node.args) != _FUNCTIONS[name][1]:
            raise self._error(f"gives {name} {len(node.args)} arguments; it takes {_FUNCTIONS[name][1]}")
        for argument in node.args:
            self._check(argument, depth + 1)

    def _value(self, node: Any, values: dict[str, Any]) -> Any:
        if isinstance(node, ast.Constant):
            return self._number(node)
        if isinstance(node, ast.Name):
            return values[node.id] if node.id in values else _CONSTANTS[node.id]
        if isinstance(node, ast.UnaryOp):
            operand = self._value(node.operand, values)
            return -operand if isinstance(node.op, ast.USub) else operand
        if isinstance(node, ast.Compare):
            left, right = self._value(node.left, values), self._value(node.comparators[0], values)
            # A number, not a bool: NumPy refuses - and unary - on those.
            return np.where(_COMPARE[type(node.ops[0])](left, right), 1.0, 0.0)
        if isinstance(node, ast.Call):
            return _FUNCTIONS[node.func.id][0](*(self._value(a, values) for a in node.args))  # type: ignore[attr-defined]
        left, right = self._value(node.left, values), self._value(node.right, values)
        if isinstance(node.op, ast.Pow):
            return np.power(np.asarray(left, dtype=float), right)
        return _BINARY[type(node.op)](left, right)


def vector_field(
    parts: list[float | str], dim: int, where: str, *, time: bool = True
) -> Callable[[np.ndarray, np.ndarray, float], np.ndarray]:
    """Return a function (X, x, t) -> (n, 3) of components given as numbers or expressions.

    ``X`` and ``x`` are initial and current positions (n, 3) [m], named X, Y, Z and x, y, z in the
    expressions; ``t`` is the time [s], unless ``time`` is False.
    """
    if len(parts) > dim:
        raise InputError(f"{where}: {len(parts)} components given; the grid has {dim} axes")
    names = ("x", "y", "z", "X", "Y", "Z") + (("t",) if time else ())
    terms = [Expression(str(part), names, f"{where}[{k}]") for k, part in enumerate(parts)]

    def field(X: np.ndarray, x: np.ndarray, t: float) -> np.ndarray:
        values = np.zeros_like(x)
        arrays = {n: x[:, k] for k, n in enumerate("xyz")} | {n: X[:, k] for k, n in enumerate("XYZ")}
        for k, term in enumerate(terms):
            values[:, k] = term(**arrays, t=t)
        return values

    return field
