"""Blocks stay within any limits."""

from hypothesis import given
from hypothesis import strategies as st

from frictioncli.design.blocks import all_blocks
from frictioncli.design.limits import Limits
from frictioncli.design.steps import (
    HeatStep,
    RestStep,
    SeriesStep,
)


@given(
    low=st.floats(-180.0, 0.0),
    stroke=st.floats(15.0, 180.0),
    fastest=st.floats(5.0, 300.0),
    share=st.floats(0.01, 1.0),
    rated=st.one_of(st.none(), st.floats(100.0, 400.0)),
)
def test_no_block_ever_leaves_its_limits(low, stroke, fastest, share, rated):
    step = None if rated is None else rated / 100
    if step is not None and fastest < step:
        return
    limits = Limits(
        low=low,
        high=low + stroke,
        slowest=fastest * share,
        fastest=fastest,
        hottest=60.0,
        payloads=(3.0,),
        speed_step=step,
    )
    for block in all_blocks(limits, 0):
        for one in block.steps:
            if isinstance(one, RestStep):
                continue
            assert limits.low - 1e-9 <= one.low < one.high <= limits.high + 1e-9
            speeds = one.speeds if isinstance(one, SeriesStep) else (one.speed,)
            assert all(0 < speed <= fastest * (1 + 1e-9) for speed in speeds)
            if isinstance(one, HeatStep):
                assert one.until == 60.0
