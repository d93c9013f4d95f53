"""Verification of numerical integrators: methods, code, runs and texts, from Python and from the command line.

Every public name is imported on first use, so `import driftproof` costs next to nothing.
"""

from __future__ import annotations

__version__ = "0.2.0"

# The public names, each with the module below this one that has it.
_MODULES = {
    "identify": "blackbox.identify", "Allowance": "blackbox.judging.specification",
    "Domain": "blackbox.judging.specification", "identify_solver": "blackbox.solvers.identify_solver",
    "field_stepper_of": "blackbox.stepper.states.objects", "stepper_of": "blackbox.stepper.states.objects",
    "assert_verified": "blackbox.verify", "verify": "blackbox.verify", "assert_accurate": "enclosure.certify",
    "certify": "enclosure.certify", "Refused": "enclosure.arithmetic.evaluations", "METHODS": "methods.catalogue",
    "FAMILIES": "methods.families", "RungeKutta": "methods.schemes", "Splitting": "methods.schemes",
    "stepper": "methods.programs.stepping", "read_method": "methods.tableau_file", "PROBLEMS": "numeric.problems.catalogue",
    "PRESETS": "numeric.scenes", "Scene": "numeric.scenes", "read_scene": "numeric.scenes",
    "facts": "reports.fact_sheet", "run": "reports.oscillator", "step": "reports.oscillator",
    "report": "reports.pages", "roundoff": "reports.rounding", "scene": "reports.scenes",
    "stability": "reports.stability", "work_precision": "reports.studies", "sweep": "reports.sweeps",
    "RemarkWarning": "support.assertions", "fixed": "symbolic.algebra.certified",
    "significant": "symbolic.algebra.certified", "derive": "symbolic.derivation.derive", "Facts": "symbolic.facts",
    "order_within": "symbolic.facts", "stability_function_of": "symbolic.linear.oscillator",
    "boundary_points": "symbolic.linear.region", "OscillatorRun": "symbolic.runs",
    "assert_text": "texts.check", "check": "texts.check", "PRINTED": "texts.questions.decimals",
    "Style": "texts.questions.decimals", "QuestionError": "texts.questions.errors",
    "value": "texts.questions.evaluate", "render": "texts.templates.rendering", "diff": "texts.values.changes",
    "published_values": "texts.values.published",
}  # fmt: skip

TYPE_CHECKING = False  # type checkers know it by its name; importing typing would cost more than this whole module
if TYPE_CHECKING:
    # The public names again, for type checkers, which follow imports only.
    from driftproof.blackbox.identify import identify as identify
    from driftproof.blackbox.judging.specification import Allowance as Allowance
    from driftproof.blackbox.judging.specification import Domain as Domain
    from driftproof.blackbox.solvers.identify_solver import identify_solver as identify_solver
    from driftproof.blackbox.stepper.states.objects import field_stepper_of as field_stepper_of
    from driftproof.blackbox.stepper.states.objects import stepper_of as stepper_of
    from driftproof.blackbox.verify import assert_verified as assert_verified
    from driftproof.blackbox.verify import verify as verify
    from driftproof.enclosure.arithmetic.evaluations import Refused as Refused
    from driftproof.enclosure.certify import assert_accurate as assert_accurate
    from driftproof.enclosure.certify import certify as certify
    from driftproof.methods.catalogue import METHODS as METHODS
    from driftproof.methods.families import FAMILIES as FAMILIES
    from driftproof.methods.programs.stepping import stepper as stepper
    from driftproof.methods.schemes import RungeKutta as RungeKutta
    from driftproof.methods.schemes import Splitting as Splitting
    from driftproof.methods.tableau_file import read_method as read_method
    from driftproof.numeric.problems.catalogue import PROBLEMS as PROBLEMS
    from driftproof.numeric.scenes import PRESETS as PRESETS
    from driftproof.numeric.scenes import Scene as Scene
    from driftproof.numeric.scenes import read_scene as read_scene
    from driftproof.reports.fact_sheet import facts as facts
    from driftproof.reports.oscillator import run as run
    from driftproof.reports.oscillator import step as step
    from driftproof.reports.pages import report as report
    from driftproof.reports.rounding import roundoff as roundoff
    from driftproof.reports.scenes import scene as scene
    from driftproof.reports.stability import stability as stability
    from driftproof.reports.studies import work_precision as work_precision
    from driftproof.reports.sweeps import sweep as sweep
    from driftproof.support.assertions import RemarkWarning as RemarkWarning
    from driftproof.symbolic.algebra.certified import fixed as fixed
    from driftproof.symbolic.algebra.certified import significant as significant
    from driftproof.symbolic.derivation.derive import derive as derive
    from driftproof.symbolic.facts import Facts as Facts
    from driftproof.symbolic.facts import order_within as order_within
    from driftproof.symbolic.linear.oscillator import stability_function_of as stability_function_of
    from driftproof.symbolic.linear.region import boundary_points as boundary_points
    from driftproof.symbolic.runs import OscillatorRun as OscillatorRun
    from driftproof.texts.check import assert_text as assert_text
    from driftproof.texts.check import check as check
    from driftproof.texts.questions.decimals import PRINTED as PRINTED
    from driftproof.texts.questions.decimals import Style as Style
    from driftproof.texts.questions.errors import QuestionError as QuestionError
    from driftproof.texts.questions.evaluate import value as value
    from driftproof.texts.templates.rendering import render as render
    from driftproof.texts.values.changes import diff as diff
    from driftproof.texts.values.published import published_values as published_values

    __all__: list[str]
else:

    def __getattr__(name: str) -> object:
        """The public object `name`, imported now (PEP 562). Raises AttributeError for any other name."""
        from importlib import import_module

        if name == "__all__":
            return sorted(_MODULES)
        if name not in _MODULES:
            raise AttributeError(f"module 'driftproof' has no attribute {name!r}")
        return getattr(import_module(f"driftproof.{_MODULES[name]}"), name)


def __dir__() -> list[str]:
    """The public names."""
    return [*sorted(_MODULES), "__all__", "__version__"]
