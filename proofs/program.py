"""The experiment as a program that needs nothing but Python: `python proofs/program.py` prints its seven lines.

It imports nothing but `math`, so that the proofs can compare the library with an independent program digit by digit. If
the lesson lies beside the checkout, the proofs also run its own listing and compare that output.
"""

from math import cos, hypot, sin

METHODS = ("Euler", "Symplectic", "RK4")


def rates(state: tuple[float, float]) -> tuple[float, float]:
    """The right-hand side F(q, v) = (v, -q)."""
    position, velocity = state
    return velocity, -position


def moved(state: tuple[float, float], rate: tuple[float, float], h: float) -> tuple[float, float]:
    """The state after moving at a constant rate for a time h."""
    return state[0] + h * rate[0], state[1] + h * rate[1]


def step(method: str, state: tuple[float, float], h: float) -> tuple[float, float]:
    """One step of one of METHODS. Raises ValueError for any other name."""
    if method == "Euler":
        return moved(state, rates(state), h)
    if method == "Symplectic":
        velocity = state[1] - h * state[0]
        return state[0] + h * velocity, velocity
    if method == "RK4":
        first = rates(state)
        second = rates(moved(state, first, h / 2))
        third = rates(moved(state, second, h / 2))
        fourth = rates(moved(state, third, h))
        total = tuple(a + 2 * b + 2 * c + d for a, b, c, d in zip(first, second, third, fourth, strict=True))
        return moved(state, (total[0] / 6, total[1] / 6), h)
    raise ValueError("Unknown method")


def final_state(method: str, h: float, steps: int) -> tuple[float, float]:
    """The state after a number of steps from (1, 0); no sum of times is formed."""
    state = (1.0, 0.0)
    for _ in range(steps):
        state = step(method, state, h)
    return state


def energy(state: tuple[float, float]) -> float:
    """The energy ½(q² + v²)."""
    return (state[0] ** 2 + state[1] ** 2) / 2


def lines() -> list[tuple[float, ...]]:
    """Per method the first step with its energy; the exact final state; per method the error and energy at t = 10."""
    firsts = [step(method, (1.0, 0.0), 0.5) for method in METHODS]
    exact = (cos(10), -sin(10))
    ends = [final_state(method, 0.25, 40) for method in METHODS]
    return [
        *((*state, energy(state)) for state in firsts),
        exact,
        *((hypot(state[0] - exact[0], state[1] - exact[1]), energy(state)) for state in ends),
    ]


if __name__ == "__main__":
    for line in lines():
        print(*(f"{number:.6f}" for number in line))
