"""A form is called, copied and described as the step that it stands for."""

from driftproof.blackbox.stepper.calling_conventions import required_names
from driftproof.blackbox.stepper.fresh_copies import fresh_copy
from driftproof.blackbox.stepper.states.step_forms import StepForm


def test_a_form_has_the_parameters_of_what_it_calls():
    form = StepForm(lambda q, v, h: (q + h * v, v), others={"k": 2.0})
    assert required_names(form) == form.parameters == ["q", "v", "h"]
    assert form(1.0, 2.0, h=0.5) == (2.0, 2.0)


def test_a_copy_of_a_form_shares_nothing_that_its_function_remembers_but_all_that_is_known():
    seen = []
    form = StepForm(lambda y, h: seen.append(y) or len(seen), "the state: y")
    other = fresh_copy(form)
    assert (form(0.0, 1.0), form(0.0, 1.0), other(0.0, 1.0), other.reading) == (1, 2, 1, "the state: y")


def test_of_a_step_as_it_is_written_nothing_is_known():
    known, plain = StepForm(lambda y, h: y, others={"k": 2.0}), StepForm.of(lambda y, h: y)
    assert StepForm.of(known) is known
    assert (plain.reading, plain.others, plain.state_names, plain.of_size) == ("", {}, ("q", "v"), None)
