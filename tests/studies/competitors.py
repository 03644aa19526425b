"""Public packages set to the task of ``diagnose``: what does the base model miss, and why?

All work on the same base model and its misfit in both channels, and those that choose from a
library on the same one.
"""

import warnings
from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from pysindy import FROLS, STLSQ, EnsembleOptimizer
from pysindy.optimizers import BaseOptimizer
from scipy import stats
from scipy.special import betaln
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel
from sklearn.preprocessing import StandardScaler

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.diagnose import diagnose_joint
from frictioncli.diagnosis.settings import DiagnosisSettings
from tests.studies.joints import (
    NOTHING,
    Entry,
    Finding,
    Joint,
    Outcome,
    base_columns,
    extended,
    library,
    misfit_of,
    off_base,
    predicted,
    visible_columns,
)

Mask = NDArray[np.bool_]

ALPHA = 0.05
THRESHOLDS = np.geomspace(0.02, 2.0, 11)
"""Thresholds from which cross-validation chooses. [N·m]"""

MOST = 5
"""Greatest number of columns in forward selection."""

FOLDS = 5
MODELS = 20
INCLUDED = 0.9
"""Share of the ensemble's models that must keep a column."""

POINTS = 800
"""Rows that the Gaussian process learns from, and as many to try it on."""


def by_diagnose(joint: Joint) -> Outcome:
    """Ask ``frictioncli diagnose``."""
    diagnosis = diagnose_joint(joint.torques, "motor", "N·m", DiagnosisSettings())
    finding = Finding(
        found=diagnosis.verdict != "no_evidence",
        claims=tuple(tuple(cause.effects) for cause in diagnosis.causes),
        gain=diagnosis.gain.reduction if diagnosis.gain else 0.0,
    )
    return Outcome(finding, finding)


def by_f_tests(joint: Joint) -> Outcome:
    """Ask nested F-tests of points taken for independent; the smallest p-value names the cause."""
    misfit = off_base(joint.seen, misfit_of(joint.seen)[:, np.newaxis])[:, 0]
    total, rest = float(misfit @ misfit), len(misfit) - base_columns(joint.seen).shape[1]
    entries = [entry for entry in library(joint.seen) if entry.freedom]
    logs = []
    for entry in entries:
        freedom = entry.freedom + len(entry.effect.shape)
        left = total - entry.explained
        ratio = (entry.explained / freedom) / (left / (rest - freedom))
        logs.append(_log_p_value(ratio, freedom, rest - freedom))
    best = int(np.argmin(logs))
    if logs[best] + np.log(len(logs)) >= np.log(ALPHA):
        return NOTHING
    return extended(joint, [(entries[best], visible_columns(entries[best]))])


def _log_p_value(ratio: float, freedom: int, rest: int) -> float:
    """Return the logarithm of the F-test's p-value, also where that is too small for a float."""
    plain = float(stats.f.logsf(ratio, freedom, rest))
    if np.isfinite(plain):
        return plain
    a, b = rest / 2, freedom / 2
    x = rest / (rest + freedom * ratio)
    node, weight = np.polynomial.laguerre.laggauss(30)
    integral = float(weight @ (1 - x * np.exp(-node / a)) ** (b - 1))
    return float(a * np.log(x) - np.log(a) - betaln(a, b) + np.log(integral))


def by_stlsq(joint: Joint) -> Outcome:
    """Ask PySINDy's STLSQ with its default threshold, 0.1, which is in N·m here."""
    entries, columns, misfit = _sindy_problem(joint)
    return _kept(joint, entries, _fitted(STLSQ(), columns, misfit) != 0)


def by_tuned_stlsq(joint: Joint) -> Outcome:
    """Ask STLSQ with the threshold that cross-validation chooses."""
    entries, columns, misfit = _sindy_problem(joint)
    optimizer = STLSQ(threshold=_tuned_threshold(joint, columns, misfit))
    return _kept(joint, entries, _fitted(optimizer, columns, misfit) != 0)


def by_ensemble(joint: Joint) -> Outcome:
    """Ask PySINDy's bagging ensemble: columns that nearly all models keep."""
    entries, columns, misfit = _sindy_problem(joint)
    inner = STLSQ(threshold=_tuned_threshold(joint, columns, misfit))
    ensemble = EnsembleOptimizer(inner, bagging=True, n_models=MODELS)
    np.random.seed(joint.seed)  # noqa: NPY002 - PySINDy draws from the global generator
    _fitted(ensemble, columns, misfit)
    share = np.mean([one[0] != 0 for one in ensemble.coef_list], axis=0)
    return _kept(joint, entries, share >= INCLUDED)


def by_forward_selection(joint: Joint) -> Outcome:
    """Ask PySINDy's FROLS, the number of columns chosen by cross-validation."""
    entries, columns, misfit = _sindy_problem(joint)

    def errors(known: Mask, asked: Mask) -> list[float]:
        path = _forward_path(columns[known], misfit[known])
        return [_error_of(columns, misfit, one, known, asked) for one in reversed(path)]

    count = MOST - _sparsest(joint, errors)
    return _kept(joint, entries, _forward_path(columns, misfit)[count])


def _forward_path(columns: Array, misfit: Array) -> list[Mask]:
    """Return which columns forward selection has after 0, 1, ... ``MOST`` steps."""
    optimizer = FROLS(max_iter=MOST)
    _fitted(optimizer, columns, misfit)
    return [step[0] != 0 for step in optimizer.history_]


def _error_of(columns: Array, misfit: Array, one: Mask, known: Mask, asked: Mask) -> float:
    """Return the mean squared error at the rows asked, refitted to those known."""
    fitted = np.linalg.lstsq(columns[known][:, one], misfit[known], rcond=None)[0]
    return _mean_square(misfit[asked] - columns[asked][:, one] @ fitted)


def _mean_square(values: Array) -> float:
    return float(np.mean(np.square(values)))


def _sindy_problem(joint: Joint) -> tuple[list[Entry], Array, Array]:
    """Return the library, its visible columns of 1 N·m RMS over both channels, and the target."""
    entries = library(joint.seen)
    columns = np.hstack([entry.columns for entry in entries])
    size = np.linalg.norm(columns, axis=0) / np.sqrt(len(columns) / 2)
    misfit = off_base(joint.seen, misfit_of(joint.seen)[:, np.newaxis])[:, 0]
    return entries, columns[:, size > 0] / size[size > 0], misfit


def _fitted(optimizer: BaseOptimizer, columns: Array, misfit: Array) -> Array:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return np.asarray(optimizer.fit(columns, misfit).coef_)[0]


def _tuned_threshold(joint: Joint, columns: Array, misfit: Array) -> float:
    def errors(known: Mask, asked: Mask) -> list[float]:
        fits = [_fitted(STLSQ(threshold=one), columns[known], misfit[known]) for one in THRESHOLDS]
        return [_mean_square(misfit[asked] - columns[asked] @ fitted) for fitted in fits]

    return float(THRESHOLDS[_sparsest(joint, errors)])


def _sparsest(joint: Joint, errors: Callable[[Mask, Mask], list[float]]) -> int:
    """Return the last setting within one standard error of the best, over blocks of time.

    Parameters
    ----------
    joint : Joint
        The joint; its pairs are in order of time.
    errors : callable
        Mean squared errors at the rows asked by setting, the sparsest last, fitted to those known.
    """
    pair = joint.seen.layout.row_pair
    fold = np.tile(pair * FOLDS // (int(pair.max()) + 1), 2)
    found = np.array([errors(fold != k, fold == k) for k in range(FOLDS)])
    mean = found.mean(axis=0)
    best = int(np.argmin(mean))
    reach = mean[best] + found[:, best].std(ddof=1) / np.sqrt(FOLDS)
    return int(np.flatnonzero(mean <= reach)[-1])


def _kept(joint: Joint, entries: Sequence[Entry], chosen: Mask) -> Outcome:
    """Return the outcome of choosing some of the library's visible columns."""
    picked, start = [], 0
    for entry in entries:
        mask = visible_columns(entry)
        end = start + int(mask.sum())
        mask[mask] = chosen[start:end]
        start = end
        if mask.any():
            picked.append((entry, mask))
    return extended(joint, picked)


def by_gaussian_process(joint: Joint) -> Outcome:
    """Ask a Gaussian process: does it predict rows of the run that it was not given?

    It has found something if the squared misfit of those rows falls in the mean, at 5 %.
    """
    drawn = np.random.default_rng(joint.seed).permutation(len(joint.seen.friction))
    learned, tried = drawn[:POINTS], drawn[POINTS : 2 * POINTS]
    inputs = [_inputs(problem) for problem in (joint.seen, joint.new)]
    scaler = StandardScaler().fit(inputs[0])
    seen, new = (scaler.transform(values) for values in inputs)
    fall, after, added = np.zeros(len(tried)), [], []
    for target, ahead in (
        (joint.seen.friction_misfit, joint.new.friction_misfit),
        (joint.seen.load_misfit, joint.new.load_misfit),
    ):
        process = _process(seen[learned], target[learned], joint.seed)
        added.append(process.predict(seen[tried]))
        fall += np.square(target[tried]) - np.square(target[tried] - added[-1])
        after.append(ahead - process.predict(new))
    if stats.ttest_1samp(fall, 0.0, alternative="greater").pvalue >= ALPHA:
        return NOTHING
    return predicted(joint, np.concatenate(added), np.concatenate(after))


def _inputs(problem: Problem) -> Array:
    table = problem.table
    return np.column_stack([table.speed, table.temperature, table.position, table.time, table.load])


def _process(inputs: Array, target: Array, seed: int) -> GaussianProcessRegressor:
    smooth = ConstantKernel() * RBF(np.ones(inputs.shape[1]), (1e-2, 1e3))
    process = GaussianProcessRegressor(smooth + WhiteKernel(), normalize_y=True, random_state=seed)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return process.fit(inputs, target)


METHODS: Mapping[str, Callable[[Joint], Outcome]] = {
    "diagnose": by_diagnose,
    "STLSQ": by_stlsq,
    "STLSQ, tuned": by_tuned_stlsq,
    "E-SINDy": by_ensemble,
    "FROLS": by_forward_selection,
    "Gaussian process": by_gaussian_process,
    "F-tests": by_f_tests,
}
