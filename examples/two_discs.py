"""Two elastic discs that meet, bounce off and part, from Python, with results for ParaView.

Run it with a folder for the results:  python examples/two_discs.py results/discs
"""

import sys

import matpoint as mp

rubber = mp.NeoHookean(E=1000.0, nu=0.3, density=1000.0)
simulation = mp.Simulation(
    grid=mp.Grid((0, 0), (1, 1), 0.05),
    bodies=[
        mp.Body(mp.Ball((0.25, 0.25), 0.2), rubber, per_cell=2, velocity=(0.1, 0.1), name="lower left"),
        mp.Body(mp.Ball((0.75, 0.75), 0.2), rubber, per_cell=2, velocity=(-0.1, -0.1), name="upper right"),
    ],
    interpolation=mp.CPDI2(),
    timestep=mp.CFL(0.3),
)
writers = []
if len(sys.argv) > 1:
    folder = mp.prepare_folder(sys.argv[1], force=True)
    writers = [mp.VTKHDF(folder / "results.vtkhdf", mp.EveryTime(0.1)), mp.ParticleFigure(folder, "discs")]
simulation.run(until=3.0, writers=writers)

# They have turned round, and total momentum is still zero.
left = simulation.particles.body == 0
speed = simulation.particles.velocity[left].mean(axis=0)
print(f"velocity of the first disc: ({speed[0]:.4f}, {speed[1]:.4f}) m/s, it came with (0.1, 0.1)")
assert speed[0] < -0.08
assert speed[1] < -0.08
assert simulation.ledger.worst["momentum"] < 1e-10
