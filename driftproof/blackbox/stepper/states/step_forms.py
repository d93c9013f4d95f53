"""Steps of numbers or arrays that stand for steps written otherwise, with what reading these has shown."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from driftproof.blackbox.stepper.fresh_copies import copied
from driftproof.blackbox.stepper.states.array_adapters import Foreign


@dataclass(eq=False)
class StepForm:
    """A step that stands for one written otherwise: it is called as `call` is, a function of ours.

    `reading` says how the arguments of the step were read. Its state has `state_names`, where two numbers are asked
    about; `later` are the places of its parts behind the first, by name, and `speeds` those of velocities, which are
    called `speed_names`. `others` are the parameters of its system, and `of_others`, `of_size` and `in_rows` make the
    form with other ones, of another number of numbers, and of bodies in rows. The bodies that attract each other have
    these `masses`, the others may be `unequal_masses`; a complex state is given `by_parts`, its real ones first.

    >>> form = StepForm(lambda y, h: y + h, "the state: m; the step size: dt")
    >>> form(1.0, 0.5), form.parameters
    (1.5, ['y', 'h'])
    """

    call: Callable[..., Foreign]
    reading: str = ""
    step: Callable[..., Any] | None = None
    state_names: Sequence[str] = ("q", "v")
    others: Mapping[str, float] = field(default_factory=dict)
    of_others: Callable[[Mapping[str, float]], StepForm] | None = None
    of_size: Callable[[int], StepForm] | None = None
    in_rows: Callable[[], Sequence[StepForm]] = list
    later: Mapping[str, int | slice] = field(default_factory=dict)
    speeds: Sequence[int] = ()
    speed_names: Sequence[str] = ()
    masses: NDArray[np.float64] | None = None
    unequal_masses: bool = False
    by_parts: bool = False

    @classmethod
    def of(cls, step: Callable[..., Any]) -> StepForm:
        """The form itself; of a step that is called as it is written, one of which nothing is known."""
        return step if isinstance(step, StepForm) else cls(lambda: None)

    def __post_init__(self) -> None:
        """Have the parameters of the function that is called."""
        self.__signature__ = inspect.signature(self.call)

    @property
    def parameters(self) -> list[str]:
        """The names of what it takes, in order."""
        return [*self.__signature__.parameters]

    def __call__(self, *arguments: Foreign, **named: Foreign) -> Foreign:
        """Make one step."""
        return self.call(*arguments, **named)

    def __deepcopy__(self, memo: dict[int, Any]) -> StepForm:
        return replace(self, call=copied(self.call, memo))
