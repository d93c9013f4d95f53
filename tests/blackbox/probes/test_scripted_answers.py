"""Answers are scripted one by one, steps of too many calls end, and rounding is allowed for."""

from contextlib import nullcontext

import pytest

from driftproof.blackbox.probes import scripted_answers as scripted
from driftproof.blackbox.probes.scripted_answers import FarFromPrediction, NotReadable, Rounding
from driftproof.symbolic.rounding.formats import BINARY64

ROUNDING = Rounding(BINARY64, 4)


@pytest.mark.parametrize(("limit", "found"), [(1.0, 1.0), (0.5, 2.0**-5), (0.01, 2.0**-10)])
def test_a_limit_leads_to_smaller_numbers_and_a_remark(limit, found):
    def read(size):
        if size > limit:
            raise FarFromPrediction("far off")
        return size

    remark = () if found == 1 else (f"read with numbers of size {found:.1e}; of size 1, far off",)
    assert scripted.read_at_some_size(read) == (found, remark)
    with pytest.raises(FarFromPrediction, match="far off"):
        scripted.read_at_some_size(lambda size: read(2.0))


def test_what_differs_by_more_than_rounding_is_refused():
    scripted.require_calls(4, 4)
    allowed = 24 * 2 * 2.0**-53
    for within in (2.0 + allowed, 2.0 - allowed):
        scripted.require_same(ROUNDING, [1.0, -2.0], [1.0, -within])
    for seen in ([1.0], [1.0, -2.0001], [1.0, -2.0 - allowed - 2.0**-51], [1.0, -2.0 + allowed + 2.0**-52]):
        with pytest.raises(NotReadable, match="the same step of 4 calls taken twice is not the same"):
            scripted.require_same(ROUNDING, [1.0, -2.0], seen)
    with pytest.raises(NotReadable, match="of 1 call taken"):
        scripted.require_same(Rounding(BINARY64, 1), [], [1.0])
    with pytest.raises(NotReadable, match="4, then 5"):
        scripted.require_calls(4, 5)


# More than a thousandth, 2**-10, of the larger number is what a limit takes away.
@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(("off", "kind"), [(0.0, None), (0.5, None), (1.0, NotReadable), (1.5, FarFromPrediction)])
def test_a_number_that_is_off_is_told_from_one_that_is_far_off(off, kind, sign):
    control = scripted.CONTROLS[0]._replace(name="care", broken="broken")
    far, near = -1024.0 * sign, (off - 1024.0) * sign
    for pair in ((near, far), (far, near)):
        words = f"care, a number is {pair[0]:.6g} where .* {pair[1]:.6g}: broken"
        with pytest.raises(NotReadable, match=words) if kind else nullcontext() as seen:
            scripted.require_predicted(control, "a number", *pair, 0.5)
        assert kind is None or seen.type is kind
