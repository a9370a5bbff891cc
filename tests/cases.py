"""A small case, as text, that tests run and spoil."""

from __future__ import annotations

SMALL = """
title = "A block that falls"

[grid]
lower = [0.0, 0.0]
upper = [1.0, 1.0]
cell = 0.25

[materials.rubber]
law = "neo-hookean"
E = 1e5
nu = 0.3
density = 1000.0

[[bodies]]
name = "block"
material = "rubber"
region = { shape = "box", lower = [0.25, 0.5], upper = [0.75, 1.0] }
per_cell = 2

[interpolation]
method = "cpdi2"

[[boundaries]]
kind = "fixed"
plane = { axis = "y", at = 1.0, side = "upper" }

[[loads]]
kind = "gravity"
value = [0.0, -10.0]

[time]
end = 0.05
step = 1e-3

[output.vtk]
every_steps = 10

[output.history]
every_steps = 5
quantities = ["kinetic_energy"]
probes = [{ name = "foot", at = [0.5, 0.5], field = "displacement", component = "y" }]
"""
