"""Correct steppers in different styles, those of docs/steppers.md: opened, and named."""

import inspect
import re
import sys
from types import SimpleNamespace

import numpy as np
import pytest

from driftproof.blackbox.findings import Misbehaviour, StaleSlope, WrongShape
from driftproof.blackbox.stepper.call_text import call_text
from driftproof.blackbox.stepper.calling_conventions import FIELD, FORCE, MAP, CallingConvention
from driftproof.blackbox.stepper.opening import opened
from driftproof.blackbox.stepper.states.state_forms import IN_PLANE, VECTORS, CompiledCallback, forms_of
from tests.blackbox.stepper.styles import STYLES, defined, keys_of, namespace
from tests.blackbox.transcripts import Asked


@pytest.mark.slow(keep=2)
@pytest.mark.parametrize("style", [s for s in STYLES if not s.wrapper], ids=lambda style: style.title)
def test_a_style_is_opened_as_it_is_written_and_named(style, as_before):
    for package in style.needs:
        pytest.skip(f"{package} is not installed")
    step = defined(style.code)
    assert style.key in keys_of(step)
    asked = Asked(step)
    subject = opened(asked.code if inspect.isfunction(step) else step)
    call = call_text(subject, 1.0, 0.75, 0.25)
    as_before((subject.adapter.name, subject.convention.kind, *subject.convention.order), call, asked)


@pytest.mark.parametrize("title", ["A dataclass", "A named tuple", "A dict", "A complex number", "Bodies in space"])
def test_the_call_that_a_report_shows_works(title):
    style = next(style for style in STYLES if style.title == title)
    step = defined(style.code)
    text = call_text(opened(step), 1.0, 0.75, 0.25)
    assert eval(text, namespace(style.code) | {"numpy": np}) is not None


def test_bodies_in_the_plane_alone_are_opened():
    def step(force, x, v, dt):
        if x.ndim != 2 or x.shape[1] != 2:
            raise ValueError("positions have two columns")
        v = v + dt / 2 * force(x)
        x = x + dt * v
        return x, v + dt / 2 * force(x)

    assert opened(step).adapter is IN_PLANE
    assert keys_of(step) == ("velocity_verlet",)


def test_a_vector_holds_no_more_numbers_than_it_has():
    for vector, size in zip(VECTORS, (2, 3), strict=True):
        assert vector.write([0.25] * (size - 1)).tolist() == [*[0.25] * (size - 1), 0.0]
        with pytest.raises(WrongShape, match=f"a vector of {size} numbers holds no {size + 1}"):
            vector.write([0.25] * (size + 1))


def verlet_beside(acceleration=None):
    """Beside a function a is a slope; where none comes back, the caller asks for it."""

    def step(x, v, a, dt, acc):
        x1 = x + dt * v + dt**2 / 2 * a
        moved = x1, v + dt / 2 * (a + acc(x1))
        return (*moved, acceleration(acc, x, x1)) if acceleration else moved

    return step


def verlet_handing_on(acceleration):
    return lambda force, x, v, a, dt: verlet_beside(acceleration)(x, v, a, dt, force)


def timed_verlet_handing_on(later):
    def step(force, t, x, v, a, dt):
        handed_on = lambda acc, x, x1: force(t + later * dt, x1)
        return verlet_beside(handed_on)(x, v, a, dt, lambda x: force(t + dt, x))

    return step


def heun_handing_on(later):
    def step(f, t, y, k1, h):
        y1 = y + h / 2 * (k1 + f(t + h, y + h * k1))
        return y1, f(t + later * h, y1)

    return step


@pytest.mark.parametrize(("right", "wrong", "key", "said"), [
    *(
        (right, kind(lambda f, x, x1: f(x)), "velocity_verlet", "-1 as the slope at its end, not -1.15625")
        for kind in (verlet_handing_on, verlet_beside)
        for right in (kind(lambda f, x, x1: f(x1)), verlet_beside())
    ),
    *(
        (kind(1.0), kind(later), key, f"passes on the slope at t + {later / 4:g} as that at its end, t + 0.25")
        for kind, key in ((timed_verlet_handing_on, "velocity_verlet"), (heun_handing_on, "heun2"))
        for later in (0.0, 0.5)
    ),
], ids=range(8))  # fmt: skip
def test_a_slope_handed_on_that_is_not_that_at_the_end_is_a_fault(right, wrong, key, said):
    assert key in keys_of(right)
    with pytest.raises(StaleSlope, match=re.escape(said)):
        opened(wrong)


def test_a_force_that_is_not_divided_by_its_mass_is_seen():
    def step(force, x, v, mass, dt):
        return x + dt * v, v + dt * force(x)

    assert "forward_euler" not in keys_of(step)
    assert "forward_euler" in keys_of(lambda force, x, v, mass, dt: (x + dt * v, v + dt * force(x) / mass))


def test_a_complex_number_is_read_the_way_it_turns():
    assert opened(lambda z, h: z - 1j * h * z).step(1.0, 0.75, 0.25) == (1.1875, 0.5)
    assert opened(lambda z, h: z + 1j * h * z).step(1.0, 0.75, 0.25) == (1.1875, 0.5)


@pytest.mark.parametrize("answer", [None, [1.0, 2.0, 3.0], {"a": 1.0}, "a", [[1.0], [2.0, 3.0]], 10**400], ids=range(6))
def test_an_answer_that_holds_no_state_is_its_own_mistake(answer):
    with pytest.raises(Misbehaviour):
        opened(lambda y, h: answer)


@pytest.mark.slow
def test_code_compiled_by_numba_calls_what_it_is_given_each_time():
    pytest.importorskip("numba")
    style = next(style for style in STYLES if style.title == "Compiled Numba code")
    subject = opened(defined(style.code))
    for slope in (1.0, -2.0):
        assert subject.step_field(lambda t, y, slope=slope: [slope * t for _ in y], 2.0, [0.0], 1.0) == [2.5 * slope]
    forced = opened(namespace("@numba.njit\ndef step(force, q, v, h): return q + h * v, v + h * force(q)")["step"])
    assert forced.step_forced(lambda t, q: [3 * x for x in q], 0.0, [1.0], [0.5], 0.25) == [1.125, 1.25]


@pytest.fixture
def numpy_for_jax(monkeypatch):
    """JAX with NumPy's arrays, which calls back at once."""
    fake = SimpleNamespace(numpy=np, ShapeDtypeStruct=lambda shape, dtype: SimpleNamespace(shape=shape, dtype=dtype))
    called = SimpleNamespace(io_callback=lambda function, shape, *given, ordered: function(*given) if ordered else 0)
    monkeypatch.setitem(sys.modules, "jax", fake)
    monkeypatch.setitem(sys.modules, "jax.experimental", called)


@pytest.mark.usefixtures("numpy_for_jax")
def test_it_answers_in_the_shape_and_type_of_the_state_wherever_that_stands():
    callback = CompiledCallback()
    field = callback.calling(lambda *given: [2 * x for x in max(given, key=np.size)])
    assert field is callback
    for arguments in ((0.5, np.array([1.0, 2.0])), (np.array([1.0, 2.0]), 0.5)):
        assert field(*arguments).tolist() == [2.0, 4.0]
    assert field(np.array([1.0], np.float32)).dtype == np.float32
    assert callback.calling(lambda t, y: [y])(0.5, 3.0).shape == ()


@pytest.mark.usefixtures("numpy_for_jax")
def test_arrays_and_scalars_of_jax_are_forms_of_the_state_of_all_but_maps():
    forms = [[*forms_of(lambda: 0, CallingConvention(kind, ()))] for kind in (FIELD, FORCE, MAP)]
    assert [[form.name for form in each][-2:] for each in forms[:2]] == [["JAX arrays", "JAX scalars"]] * 2
    assert [form.name for form in forms[2] if "JAX" in form.name] == []
    array, scalar = forms[0][-2:]
    assert (array.write((1.0, 2.0)).tolist(), scalar.write((3.0,)).shape) == ([1.0, 2.0], ())
