"""The front door: exact facts and float runs of one-step integrators, from Python and from the command line.

Everything heavy is imported when it is first asked for, so `import driftproof` costs next to nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

__version__ = "0.1.0"

# Public name -> where it lives. Names resolve on first use (PEP 562).
_PUBLIC = {
    "METHODS": "methods.catalogue",
    "FAMILIES": "methods.families",
    "read_method": "methods.tableau_file",
    "RungeKutta": "methods.schemes",
    "Splitting": "methods.schemes",
    "stepper": "methods.stepping",
    "OscillatorRun": "symbolic.oscillator_run",
    "one_step_matrix": "symbolic.one_step",
    "energy_multiplier": "symbolic.energy",
    "invariant_quadratic": "symbolic.energy",
    "stability_limit": "symbolic.stability",
    "facts_of": "symbolic.facts",
    "system_facts": "symbolic.facts",
    "order_within": "symbolic.facts",
    "family_facts": "symbolic.family_facts",
    "stability_function_of": "symbolic.linear.oscillator",
    "boundary_points": "symbolic.linear.region",
    "significant": "symbolic.certified",
    "fixed": "symbolic.certified",
    "Scene": "numeric.scenes",
    "PRESETS": "numeric.scenes",
    "read_scene": "numeric.scenes",
    "run": "numeric.run",
    "published_values": "driftproof.values",
    "value": "driftproof.language.ask",
    "QuestionError": "driftproof.language.errors",
    "Style": "driftproof.language.style",
    "PRINTED": "driftproof.language.style",
    "PROBLEMS": "numeric.problems.catalogue",
    "sweep": "numeric.sweep",
    "identify": "driftproof.blackbox.identify",
    "stepper_of": "driftproof.blackbox.stepper.objects",
    "field_stepper_of": "driftproof.blackbox.stepper.objects",
    "verify": "driftproof.blackbox.verify",
    "assert_verified": "driftproof.blackbox.verify",
    "Domain": "driftproof.blackbox.judging.agreement",
    "Allowance": "driftproof.blackbox.judging.tolerance",
}

__all__ = sorted(_PUBLIC)


def __getattr__(name: str) -> Any:
    """The public object `name`, imported now. Raises AttributeError for any other name."""
    if name not in _PUBLIC:
        raise AttributeError(f"module 'driftproof' has no attribute {name!r}")
    return getattr(import_module(_PUBLIC[name]), name)


def __dir__() -> list[str]:
    """The public names."""
    return [*__all__, "__version__"]
