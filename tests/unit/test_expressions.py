"""Expressions: NumPy's values for what is allowed, one message for everything else."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from matpoint.errors import InputError
from matpoint.expressions import Expression, vector_field

X = np.linspace(-1.0, 2.0, 7)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("1", lambda x, t: 1.0),
        ("-x + 2*t - 1/4", lambda x, t: -x + 2 * t - 0.25),
        ("x**2 - 2**-1", lambda x, t: x**2 - 0.5),
        ("(-2)**3", lambda x, t: -8.0),
        ("sin(2*pi*x)*cos(t)", lambda x, t: np.sin(2 * np.pi * x) * np.cos(t)),
        ("exp(-x) + sqrt(abs(x)) + log(3)", lambda x, t: np.exp(-x) + np.sqrt(abs(x)) + np.log(3)),
        ("where(x > 0, x, 0)", lambda x, t: np.where(x > 0, x, 0)),
        ("min(x, t) + max(x, t)", lambda x, t: np.minimum(x, t) + np.maximum(x, t)),
        (
            "tan(x) + tanh(x) + sinh(x) + cosh(x)",
            lambda x, t: np.tan(x) + np.tanh(x) + np.sinh(x) + np.cosh(x),
        ),
        ("atan2(x, 1 + t)", lambda x, t: np.arctan2(x, 1 + t)),
        (
            "where(x <= t, 1, where(x >= 1.5, 2, 3))",
            lambda x, t: np.where(x <= t, 1, np.where(x >= 1.5, 2, 3)),
        ),
        ("  1e3 * x  ", lambda x, t: 1e3 * x),
    ],
)
def test_values(text, expected):
    np.testing.assert_allclose(Expression(text, ("x", "t"), "here")(x=X, t=0.3), expected(X, 0.3))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("__import__('os')", "calls"),
        ("x.real", "Attribute"),
        ("x[0]", "Subscript"),
        ("lambda: 1", "Lambda"),
        ("'text'", "only numbers"),
        ("True", "only numbers"),
        ("1j", "only numbers"),
        ("y", "'y'"),
        ("sine(x)", "calls 'sine'"),
        ("sin(x, x)", "takes 1"),
        ("sin(v=x)", "calls"),
        ("x and t", "BoolOp"),
        ("1 < x < 2", "Compare"),
        ("x // 2", "BinOp"),
        ("x ** t", "power"),
        ("x ** 65", "power"),
        ("9 ** 9 ** 9", "power"),
        ("x +", "not a formula"),
        ("", "not a formula"),
        ("x; t", "not a formula"),
        ("1" * 400, "too large"),
        ("x" + "+x" * 300, "characters long"),
        ("-" * 60 + "x", "deep"),
        ("(" * 60 + "x", "not a formula"),
        ("[x for x in t]", "ListComp"),
        ("\x00", "not a formula"),
    ],
)
def test_refusals(text, message):
    with pytest.raises(InputError, match="loads.0") as caught:
        Expression(text, ("x", "t"), "loads.0")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


@given(st.text(max_size=60))
def test_any_text_is_a_formula_or_an_input_error(text):
    try:
        value = Expression(text, ("x", "t"), "here")(x=X, t=0.5)
    except InputError:
        return
    np.broadcast_to(np.asarray(value, dtype=float), X.shape)


def test_vector_fields():
    points = np.random.default_rng(1).normal(size=(5, 3))
    field = vector_field(["X - x", 2.0, "t*z"], 3, "here")
    expected = np.stack([points[:, 0] - 3.0, np.full(5, 2.0), 0.5 * (points[:, 2] * 0 + 3.0)], axis=1)
    np.testing.assert_allclose(field(points, np.full((5, 3), 3.0), 0.5), expected)
    with pytest.raises(InputError, match="2 axes"):
        vector_field([1.0, 2.0, 3.0], 2, "here")
    with pytest.raises(InputError, match="'t'"):
        vector_field(["t"], 2, "here", time=False)
