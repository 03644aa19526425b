"""Samples at even times, as the filters need them, and the middles of their rows."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Flags, Indices, Numbers
from frictioncli.pairs.chunks import SampleChunk
from frictioncli.pairs.moves import SMOOTHING, samples_in
from frictioncli.pairs.slices import slice_indices

STEPS = ("pose", "payload")
"""Channels of numbers without anything between them."""

_UNEVEN = 0.02
"""Share of the period by which time steps of an evenly sampled log may differ."""

_JUMP_FACTOR = 5.0
"""A position that changes by so many times velocity and period, and a degree, has jumped."""


@dataclass(frozen=True, slots=True)
class EvenSamples:
    """Evenly sampled channels of a chunk, and its moves.

    Attributes
    ----------
    channels : mapping of str to ndarray, shape (samples,)
        Channels by name.
    number : ndarray of int, shape (samples,)
        Number of each sample in its recording.
    period : float
        Sampling period. [s]
    start, stop : ndarray of int, shape (moves,)
        First and past-the-end sample of each move.
    logged : ndarray or None
        Times of the log where these samples are interpolated. [s]
    """

    channels: Mapping[str, Array]
    number: Numbers
    period: float
    start: Numbers
    stop: Numbers
    logged: Array | None = None

    def samples(self, centre: Indices, spacing: int) -> Numbers:
        """Return how many logged samples lie about the middle of each row, within the spacing."""
        if self.logged is None:
            return np.full(len(centre), spacing, dtype=np.int64)
        # the bounds lie between samples of the grid, as the rows of a move follow each other
        first = (self.number[centre] - spacing / 2) * self.period
        bounds = np.searchsorted(self.logged, np.stack([first, first + spacing * self.period]))
        return np.asarray(bounds[1] - bounds[0], dtype=np.int64)


def even_samples(chunk: SampleChunk) -> EvenSamples:
    """Return the samples of a chunk at even times; those of uneven logs are interpolated.

    Parameters
    ----------
    chunk : SampleChunk
        Samples of one recording and joint.
    """
    time = chunk.channels["time"]
    start, stop = chunk.move_start, chunk.move_stop
    inner = slice_indices(start, stop - 1)
    steps = time[inner + 1] - time[inner]
    period = float(np.median(steps)) if len(steps) else chunk.period
    if not len(steps) or np.max(np.abs(steps - period)) <= _UNEVEN * period:
        number = chunk.offset + np.arange(len(time))
        return EvenSamples(chunk.channels, number, max(period, 1e-6), start, stop)
    # the grid lies on multiples of the period, wherever a chunk begins
    period = chunk.period
    number = np.arange(int(np.ceil(time[0] / period)), int(time[-1] / period) + 1)
    grid = number * period
    before = np.clip(np.searchsorted(time, grid, side="right") - 1, 0, len(time) - 1)
    channels = {
        name: values[before] if name in STEPS else np.interp(grid, time, values)
        for name, values in chunk.channels.items()
    }
    first = np.searchsorted(grid, time[start], side="left")
    last = np.searchsorted(grid, time[stop - 1], side="right")
    last = np.maximum(last, first)
    return EvenSamples(channels | {"time": grid}, number, period, first, last, time)


def row_centres(grid: EvenSamples, half: int, spacing: int) -> tuple[Indices, Numbers]:
    """Return the middle sample of every row, and its move.

    Parameters
    ----------
    grid : EvenSamples
        The samples.
    half, spacing : int
        Neighbours that a row needs in its move, and distance of rows. [samples]
    """
    # the moving mean of the velocity, which makes the moves, starts before the joint does
    margin = half + samples_in(SMOOTHING, grid.period)
    first, last = grid.start + margin, grid.stop - margin
    # the first multiple of the spacing in each move
    begin = first + (-grid.number[np.minimum(first, len(grid.number) - 1)]) % spacing
    count = np.maximum(-((begin - last) // spacing), 0)
    count = np.where(last > begin, count, 0)
    move = np.repeat(np.arange(len(first)), count)
    place = slice_indices(np.zeros_like(count), count)
    return begin[move] + spacing * place, move


def later(values: Array, shift: float) -> Array:
    """Return what an evenly sampled signal is some samples later; at its ends it stays.

    Parameters
    ----------
    values : ndarray, shape (samples,)
        The signal.
    shift : float
        By how much later; between samples lies the cubic through the four about it. [samples]

    Examples
    --------
    >>> later(np.arange(8.0) ** 3, 0.5)[2:5] - np.array([2.5, 3.5, 4.5]) ** 3
    array([0., 0., 0.])
    """
    whole = int(np.floor(shift))
    part = shift - whole
    weights = (
        -part * (part - 1) * (part - 2) / 6,
        (part + 1) * (part - 1) * (part - 2) / 2,
        -(part + 1) * part * (part - 2) / 2,
        (part + 1) * part * (part - 1) / 6,
    )
    place = np.arange(len(values)) + whole
    return np.asarray(
        sum(
            weight * values[np.clip(place + offset, 0, len(values) - 1)]
            for offset, weight in zip((-1, 0, 1, 2), weights, strict=True)
            if weight
        )
    )


def position_jumps(grid: EvenSamples, centre: Indices, half: int) -> Flags:
    """Return whether the position jumps among the neighbours of each row.

    Parameters
    ----------
    grid : EvenSamples
        The samples.
    centre : ndarray of int, shape (rows,)
        Middle samples.
    half : int
        Neighbours on either side.
    """
    position, velocity = grid.channels["position"], grid.channels["velocity"]
    change = np.abs(np.diff(position))
    expected = np.maximum(np.abs(velocity[1:]), np.abs(velocity[:-1])) * grid.period
    total = np.append(0, np.cumsum(change > _JUMP_FACTOR * expected + 1.0))
    return np.asarray(total[centre + half] > total[centre - half])
