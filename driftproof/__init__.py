"""The front door: exact facts and float runs of one-step integrators, from Python and from the command line.

Everything heavy is imported when it is first asked for, so `import driftproof` costs next to nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

__version__ = "0.1.0"

# Public name -> where it lives. Names resolve on first use (PEP 562).
_PUBLIC = {
    "METHODS": "driftproof.methods.catalogue",
    "FAMILIES": "driftproof.methods.families",
    "read_method": "driftproof.methods.tableau_file",
    "RungeKutta": "driftproof.methods.schemes",
    "Splitting": "driftproof.methods.schemes",
    "stepper": "driftproof.methods.stepping",
    "OscillatorRun": "driftproof.symbolic.runs",
    "one_step_matrix": "driftproof.symbolic.derivation.one_step",
    "energy_multiplier": "driftproof.symbolic.derivation.energy",
    "invariant_quadratic": "driftproof.symbolic.derivation.energy",
    "stability_limit": "driftproof.symbolic.derivation.stability",
    "facts_of": "driftproof.symbolic.facts",
    "system_facts": "driftproof.symbolic.facts",
    "order_within": "driftproof.symbolic.facts",
    "family_facts": "driftproof.symbolic.family_facts",
    "stability_function_of": "driftproof.symbolic.linear.oscillator",
    "boundary_points": "driftproof.symbolic.linear.region",
    "significant": "driftproof.symbolic.algebra.certified",
    "fixed": "driftproof.symbolic.algebra.certified",
    "Scene": "driftproof.numeric.scenes",
    "PRESETS": "driftproof.numeric.scenes",
    "read_scene": "driftproof.numeric.scenes",
    "run": "driftproof.numeric.run",
    "published_values": "driftproof.texts.values.published",
    "value": "driftproof.texts.questions.ask",
    "QuestionError": "driftproof.texts.questions.errors",
    "Style": "driftproof.texts.questions.style",
    "PRINTED": "driftproof.texts.questions.style",
    "PROBLEMS": "driftproof.numeric.problems.catalogue",
    "sweep": "driftproof.numeric.sweep",
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
