"""Any engine follows the schedule of the compiled rollout."""

from support.restless_grids import CONDITIONS, FAULTS, PlainEngine, same, simulator
from tilenca.simulator.engine import FastEngine


def test_any_engine_follows_the_same_schedule_round_by_round() -> None:
    for conditions in CONDITIONS:
        for fault in (None, FAULTS[1], FAULTS[3], FAULTS[5]):
            if conditions.dead == 0 or fault is None:
                fast, plain = (
                    simulator(conditions, fault, engine=engine) for engine in (FastEngine, PlainEngine)
                )
                assert same(fast, plain, 25), (conditions, fault)
