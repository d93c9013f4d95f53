"""What people call readouts, facts and settings in a question, beside the names that they have; as data.

A head or a readout of several words is one name, with "_" between: "phase error" is phase_error.
"""

from __future__ import annotations

# A local error is that of one step: as the head of a question it asks for a step, the others for a run.
LOCAL = ("local_error",)
_ERRORS = ("error", "global_error", *LOCAL)
_LARGEST = ("max_error", "maximum_error", "maximal_error")
_NAMES = (
    "state_error",
    "phase_error",
    "largest_error",
    "relative_error",
    "energy",
    "energy_change",
    "steps",
    "evaluations",
)

# Name or other name of a readout -> its name. Before "of METHOD" it is what a run is asked for.
READOUT_WORDS = {
    **{name: name for name in _NAMES},
    **dict.fromkeys(_ERRORS, "state_error"),
    **dict.fromkeys(_LARGEST, "largest_error"),
    **dict.fromkeys(("energy_error", "energy_drift"), "energy_change"),
    "function_evaluations": "evaluations",
    "position": "q",
    "velocity": "v",
    "exact.position": "exact.q",
    "exact.velocity": "exact.v",
}

# Other name of a fact -> its name.
FACT_WORDS = {
    **dict.fromkeys(("amplification_factor", "growth_factor", "stability_polynomial", "R"), "stability_function"),
    "real_stability_limit": "real_limit",
    "imaginary_stability_limit": "imaginary_limit",
    "energy_factor": "energy_multiplier",
    **dict.fromkeys(("order_of_convergence", "convergence_order", "order_of_accuracy"), "order"),
}

# Word -> the facts that it may mean.
AMBIGUOUS_FACTS = {
    "stability_limit": "real_limit (y' = -λy, hλ at most) or imaginary_limit (y' = iωy, hω at most)",
    "limit": "real_limit (y' = -λy, hλ at most) or imaginary_limit (y' = iωy, hω at most)",
}

# Other name of a setting -> its name.
OTHER_SETTINGS = {"steps": "N", "n": "N", "dt": "h", "T": "t", "λ": "lambda"}

# Words that may stand between the parts of a question, and say nothing there.
SAY_NOTHING = {"of", "with", "on", "after", "to", "for", "and", "until", "by", "using"}
