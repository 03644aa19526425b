"""A model of an arm that robot programs of the tests move, and what it keeps of their moves."""

from dataclasses import dataclass, field
from math import sqrt

ACCELERATION = 200.0


@dataclass(frozen=True)
class Move:
    """One move of one axis [s, deg, deg/s, °C]."""

    axis: int
    start: float
    end: float
    begin: float
    target: float
    speed: float
    traced: bool
    temperature: float


@dataclass
class Arm:
    """Six axes with a clock, a motor that warms while it moves, and a trace that is on or off."""

    positions: list[float]
    temperature: float = 20.0
    warming: float = 0.01
    cooling: float = 0.002
    clock: float = 0.0
    traced: bool = False
    halted: int = 0
    moves: list[Move] = field(default_factory=list)
    traces: list[tuple[float, float]] = field(default_factory=list)

    def move(self, targets, speeds):
        """Move to targets; at most one axis may have another one than before."""
        changed = [i for i in range(6) if abs(targets[i] - self.positions[i]) > 1e-9]
        assert len(changed) <= 1, f"axes {changed} move together"
        for i in changed:
            distance, speed = abs(targets[i] - self.positions[i]), speeds[i]
            ramp = speed / ACCELERATION
            if speed * ramp >= distance:
                seconds = 2 * sqrt(distance / ACCELERATION)
            else:
                seconds = distance / speed + ramp
            self.moves.append(
                Move(
                    axis=i + 1,
                    start=self.clock,
                    end=self.clock + seconds,
                    begin=self.positions[i],
                    target=targets[i],
                    speed=speed,
                    traced=self.traced,
                    temperature=self.temperature,
                )
            )
            self.positions[i] = targets[i]
            self.temperature += self.warming * seconds
            self.clock += seconds

    def wait(self, seconds):
        """Stand still."""
        self.clock += seconds
        self.temperature -= self.cooling * seconds

    def trace(self, on):
        """Switch the trace."""
        if on:
            assert not self.traced, "the trace is on already"
            self.traces.append((self.clock, self.clock))
        elif self.traced:
            self.traces[-1] = (self.traces[-1][0], self.clock)
        self.traced = on
