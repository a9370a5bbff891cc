"""The engine's bar against a plain NumPy program that shares nothing with it, step by step."""

from __future__ import annotations

import numpy as np
import pytest

from matpoint.interpolation import METHODS
from matpoint.problems import BimaterialBar
from reference.numpy_bar import METHODS as PLAIN
from reference.numpy_bar import run_bar

STEPS = 2000  # 0.1 s: waves have crossed the bar, and particles and corners the grid's lines
PAIRS = [(name, name) for name in PLAIN if name != "cpdi"] + [("cpdi1", "cpdi"), ("cpdi2", "cpdi")]


@pytest.mark.parametrize("stiff", ["above", "below"])
@pytest.mark.parametrize(("method", "plain"), PAIRS)
def test_histories_agree(method, plain, stiff):
    dt = BimaterialBar.step
    expected = run_bar(plain, STEPS, dt, stiff)
    sim = BimaterialBar(stiff).simulation(METHODS[method], threads=1)
    rows = {name: np.zeros((STEPS, 18)) for name in expected}
    for n in range(STEPS):
        sim.advance(dt)
        rows["position"][n] = sim.particles.ordered("position")[:, 0]
        rows["velocity"][n] = sim.particles.ordered("velocity")[:, 0]
        rows["stress"][n] = sim.particles.ordered("stress")[:, 0]
        rows["F"][n] = sim.particles.ordered("deformation_gradient")[:, 0, 0]
    for name, values in rows.items():
        worst = np.abs(values - expected[name]).max() / np.abs(expected[name]).max()
        assert worst < 1e-9, (name, worst)
