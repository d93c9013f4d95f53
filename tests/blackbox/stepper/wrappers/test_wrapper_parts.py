"""The arguments of a wrapper are those that the names mean; what cannot be known is left in capitals."""

import pytest

from driftproof.blackbox.findings import BadInput
from driftproof.blackbox.stepper.opening import opened
from driftproof.blackbox.stepper.wrappers.wrappers import wrapper_line
from tests.blackbox.stepper.styles import namespace


def test_a_state_called_x_is_no_position_where_a_right_hand_side_is_taken():
    line = wrapper_line(lambda f, iv, x, h, args: x)
    assert line.endswith("(f, IV, y, h, ())  # write values for IV, t for the time")
    assert "force, MESH, q, h)" in wrapper_line(lambda acc, mesh, x, h: x)
    assert "force, MESH, q, h)" in wrapper_line(lambda force, mesh, x, h: x)
    assert "lambda x: -force(x), MESH, q, h)" in wrapper_line(lambda grad_u, mesh, x, h: x)
    assert wrapper_line(lambda f, x0, iv: x0).endswith("(f, y, IV)  # write values for IV, t for the time")


def test_beside_a_likelier_name_h_and_epsilon_are_no_step_sizes():
    assert "return step(f, y, H, h)  # write values for H" in wrapper_line(lambda f, y, h, dt: y)
    assert opened(lambda q, p, grad_U, epsilon: (q + epsilon * p, p - epsilon * grad_U(q))).step(1.0, 0.0, 0.5)[1] < 0


@pytest.mark.parametrize(
    ("step", "said"),
    [
        (lambda P, A, B, Q, R, dt: P, r"its right-hand side, which no argument is: def step\(f, P, dt\): ..."),
        (lambda P, A, Q, dt: P, r"\(f, P, dt\): ..."),
        (lambda M, C, K, F, u0, v0, dt: u0, r"\(f, u0, dt\): ..."),
        (lambda u, alpha, dx, dt, nt: u, r"\(f, u, dt\): ..."),
        (lambda V, m, h, n, current, dt: V, r"\(f, V, dt\): ..."),
        (lambda x0, y0, x, h: y0, r"\(f, x0, h\): ..."),
        (
            lambda v0, angle, dt: v0,
            r"write one step of it, step\(q, v, h\): it takes no state, but is a run from a launch",
        ),
    ],
)
def test_matrices_coefficients_and_launches_are_no_states_and_no_functions(step, said):
    with pytest.raises(BadInput, match=said):
        opened(step)


def test_of_a_step_whose_h_is_built_in_the_wrapper_says_what_to_do():
    names = namespace("def made(h):\n    return lambda q, v: (q + h * v, v - h * q)\n")
    with pytest.raises(
        ValueError, match=r"of your own: its h is built in: let it be an argument, or make the step anew"
    ):
        opened(names["made"](0.25))
