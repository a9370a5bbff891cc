"""A material of one's own: a plain Python function, compiled when it is used.

The law here is a Mooney-Rivlin rubber. It sees 3 x 3 tensors as nested tuples and returns the Cauchy
stress; a bar of it is pulled quasi-statically and compared with its closed form in uniaxial strain.
"""

import numpy as np

import matpoint as mp
from matpoint.tensor import add, det, dot, identity, left_cauchy_green, scale, trace


def mooney_rivlin(F, F_new, L, dt, state, params):
    """sigma = (2/J)((c1 + c2 tr b) b - c2 b^2) + (k ln J - 2 c1 - 4 c2) I / J."""
    J = det(F_new)
    b = left_cauchy_green(F_new)
    linear = scale(2.0 * (params.c1 + params.c2 * trace(b)), b)
    square = scale(-2.0 * params.c2, dot(b, b))
    volume = scale(params.k * np.log(J) - 2.0 * params.c1 - 4.0 * params.c2, identity())
    return scale(1.0 / J, add(add(linear, square), volume))


c1, c2, k, density = 1.5e5, 0.5e5, 1e6, 1000.0
material = mp.UserMaterial(mooney_rivlin, {"c1": c1, "c2": c2, "k": k}, density, modulus=k + 8.0 * (c1 + c2))
bar = mp.Body(mp.mesh_box((0.0,), (1.0,), (20,)), material)
simulation = mp.Simulation(
    grid=mp.Grid(0.0, 1.3, 0.1),
    bodies=[bar],
    interpolation=mp.CPDI2(),
    timestep=mp.CFL(0.3),
    boundaries=[mp.Fixed(mp.Plane("x", 0.0))],
    loads=[mp.Gravity((200.0,), ramp=1.0)],
    damping=mp.LocalDamping(0.7),
)
simulation.run(until=1.5)

# At rest the first particle carries the weight of all the others: rho g (L - X).
p = simulation.particles
first = int(np.argmin(p.position0[:, 0]))
stress, stretch = p.stress[first, 0], p.deformation_gradient[first, 0, 0]
square = stretch**2
closed = (
    2 * (c1 + c2 * (square + 2)) * square - 2 * c2 * square**2 + k * np.log(stretch) - 2 * c1 - 4 * c2
) / stretch
print(f"stretch {stretch:.4f}: stress {stress:.1f} Pa, closed form {closed:.1f} Pa")
assert abs(stress - closed) < 1e-6 * closed
weight = density * 200.0 * (1.0 - p.position0[first, 0])
print(f"weight above it: {weight:.1f} Pa")
assert abs(stress - weight) < 0.03 * weight
