"""The third-order scheme over ten periods of the manufactured wave, with particles crossing cells."""

from __future__ import annotations

import numpy as np
import pytest

from matpoint.interpolation import METHODS
from matpoint.problems import PROBLEMS

PERIODS = 10


@pytest.mark.slow
def test_the_third_order_scheme_is_bounded_over_ten_periods():
    """FLIP, staggered, no damping of any kind; 32 cells in four times the usual step.

    Measured at the ends of the periods: velocity from 0.034 to 0.16 m/s, displacement below 1e-4 m, without
    a trend. The wave's own are 31 m/s and 0.1 m.
    """
    problem = PROBLEMS["mms-1d"](cells=32, staggered=True, dt=4e-5)
    sim = problem.simulation(METHODS["spline-imls"], threads=1)
    found = []
    for period in range(1, PERIODS + 1):
        sim.run(period * problem.end)
        found.append(problem.errors(sim))
    displacement, velocity, _ = np.array(found).T
    assert velocity.max() < 0.25
    assert velocity[5:].max() < 1.5 * velocity[:5].max()
    assert displacement.max() < 1.5e-4
    assert displacement[5:].max() < 1.5 * displacement[:5].max()
