"""ASE: one step of its molecular dynamics on one atom of mass 1, with a force of ours; thermostats turned off."""

from __future__ import annotations

from examples.gallery.entry import targets


def _dynamics(path, **settings):
    module, _, name = path.partition(".")

    def step(force, q, v, h):
        from importlib import import_module

        import numpy as np
        from ase import Atoms
        from ase.calculators.calculator import Calculator

        class Push(Calculator):
            implemented_properties = ("energy", "forces")

            def calculate(self, atoms=None, properties=(), system_changes=()):
                self.results = {"energy": 0.0, "forces": np.array([[force(atoms.positions[0, 0]), 0.0, 0.0]])}

        atoms = Atoms("H", positions=[[q, 0.0, 0.0]], masses=[1.0], calculator=Push())
        atoms.set_velocities([[v, 0.0, 0.0]])
        getattr(import_module(f"ase.md.{module}"), name)(atoms, h, **settings).run(1)
        return atoms.positions[0, 0], atoms.get_velocities()[0, 0]

    return step


COLD = {"temperature_K": 0.0, "friction": 0.0, "fixcm": False}
TARGETS = targets(
    __name__,
    "ase",
    force={
        "velocity_verlet": (_dynamics("verlet.VelocityVerlet"), "velocity Verlet", 2, "velocity_verlet"),
        "langevin": (_dynamics("langevin.Langevin", **COLD), "Langevin, friction 0", 2, "velocity_verlet"),
        "langevin_baoab": (_dynamics("langevinbaoab.LangevinBAOAB"), "BAOAB, no thermostat", 2, "velocity_verlet"),
    },
)
