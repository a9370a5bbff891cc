"""The bi-material bar in 3-D: hexahedra between rollers give the stresses of the 1-D run.

With CPDI2 the two particles at the interface share the strain of their cell, so their stresses differ
as their moduli do; enrichment makes the interface's vertices degrees of freedom and the jump goes.
"""

import numpy as np

import matpoint as mp
from matpoint.problems import BimaterialBar

jumps = {}
for interpolation in (mp.CPDI2(), mp.EnrichedCPDI2()):
    ends = []
    for dim in (1, 3):
        simulation = BimaterialBar(stiff="above", dim=dim).simulation(interpolation)
        simulation.run(until=0.14)
        ends.append(simulation.particles.ordered("stress")[:, 0])
    assert np.allclose(ends[0], ends[1], rtol=1e-9)
    below, above = ends[0][8], ends[0][9]
    jumps[interpolation.name] = abs(above - below) / abs(above + below) * 2
    print(f"{interpolation.name}: {below / 1e3:.1f} kPa below the interface, {above / 1e3:.1f} kPa above")
assert jumps["cpdi2"] > 0.4
assert jumps["enriched-cpdi2"] < 0.1
