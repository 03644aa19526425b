"""What a diagnosis found, sentence by sentence, as terminal and page say it."""

from frictioncli.diagnosis.documents.document import OTHER_JOINT, CauseRecord, DiagnosisDocument
from frictioncli.diagnosis.documents.empirical_record import EmpiricalGainRecord
from frictioncli.diagnosis.search.effect_size import TAKEN_BY_BASE
from frictioncli.diagnosis.search.margin import LEAST_MARGIN
from frictioncli.effects import BY_NAME
from frictioncli.wording import count_text, in_words, list_text, number_text, quantity_text

_STANDING = {
    "named": "named",
    "visible": "detectable, but not named",
    "negligible": "too small to name",
    "undetermined": "not determined",
}

_LEAST_SHARE = 0.1
"""Share of the mean square of an empirical term from which on a part of it is told."""

_LEFT_BY_BASE = 0.95
"""Share of its size from which on it is not worth saying what the base model leaves of a cause."""


def alternatives_text(cause: CauseRecord) -> str:
    """Return the credible set of a cause in words.

    Parameters
    ----------
    cause : CauseRecord
        A cause.
    """
    return " or ".join(in_words(name) for name in cause.effects)


def finding_text(cause: CauseRecord) -> str:
    """Return a cause in a sentence with values; a property of the log is said to be corrected.

    Of several possible effects the values are those of the first.

    Parameters
    ----------
    cause : CauseRecord
        A cause.
    """
    said = cause.statement or cause.claim
    if cause.is_measurement and cause.standing == "named" and OTHER_JOINT not in cause.effects:
        said = f"{said.removesuffix('.')}; corrected."
    return f"If {in_words(cause.effects[0])}: {said}" if len(cause.effects) > 1 else said


def size_text(cause: CauseRecord, document: DiagnosisDocument) -> str:
    """Return the size of a cause with its interval, where it shows and what the base leaves of it.

    Of some effects, such as those with several coefficients, only what the base leaves is known. Of
    one that is not determined nothing else is worth saying: the base takes the rest of it, whatever
    its size.

    Parameters
    ----------
    cause : CauseRecord
        A cause.
    document : DiagnosisDocument
        The joint's diagnosis.
    """
    unit = document.unit_of(cause.channel)
    if cause.size is None:
        return "of unknown size"
    if OTHER_JOINT in cause.effects:
        return f"{quantity_text(cause.size, cause.size_ci95, unit)} RMS while they move"
    left = cause.visible_size
    if cause.standing == "undetermined" and left is not None:
        remaining = quantity_text(left, cause.visible_ci95, unit)
        return f"{remaining} RMS in the {cause.channel} beyond what the base model absorbs"
    text = f"{quantity_text(cause.size, cause.size_ci95, unit)} RMS in the {cause.channel}"
    if left is None or left >= _LEFT_BY_BASE * cause.size:
        only_that = cause.effects and left == cause.size
        return f"{text} beyond what the base model absorbs" if only_that else text
    remaining = quantity_text(left, cause.visible_ci95, unit)
    return f"{text}, of which {remaining} would remain after refitting the base model"


def lasting_text(cause: CauseRecord, document: DiagnosisDocument) -> str:
    """Return whether a cause is there on the held-out run; empty where that cannot be tested.

    Parameters
    ----------
    cause : CauseRecord
        A cause.
    document : DiagnosisDocument
        The joint's diagnosis.
    """
    held_out = f"the held-out run ({document.held_out})"
    if cause.holds_on_new_run is None or document.held_out is None:
        return f"Present {cause.when}." if cause.when else ""
    if cause.only_on_new_run:
        return f"Present {cause.when} only: found and fitted on {held_out}."
    if cause.holds_on_new_run:
        when = f"Present {cause.when}, and also" if cause.when else "Also present"
        return f"{when} on {held_out}."
    when = cause.when or f"in {_runs_text(document.runs)}"
    return f"A change that did not last: present {when}, absent on {held_out}."


def standing_text(cause: CauseRecord) -> str:
    """Return why a cause is not named.

    Parameters
    ----------
    cause : CauseRecord
        A cause.
    """
    return f"{_STANDING[cause.standing]}{': ' if cause.reason else ''}{cause.reason}"


def note_text(cause: CauseRecord) -> str:
    """Return what is worth saying of a cause though it is not named; empty for most.

    What was left out of the log is said, whatever it would have added.

    Parameters
    ----------
    cause : CauseRecord
        A cause.
    """
    return cause.statement if OTHER_JOINT in cause.effects else ""


def left_out_text(document: DiagnosisDocument) -> str:
    """Return what the diagnosis has not used; empty if it has used everything.

    Parameters
    ----------
    document : DiagnosisDocument
        The joint's diagnosis.
    """
    parts = []
    if document.without_temperature:
        parts.append(f"{count_text(document.without_temperature, 'pair')} without temperature")
    if document.stuck_temperature:
        parts.append(
            f"{count_text(document.stuck_temperature, 'pair')} whose temperature stood still and"
            " then jumped, as where a sensor is no longer read"
        )
    if settling := document.settling:
        whole = count_text(settling.pairs, "pair")
        pairs = f", among them all of {whole}" if settling.pairs else ""
        parts.append(
            f"{settling.bins} angle bins{pairs} in the first {settling.seconds:.2g} s of a move at"
            " constant speed, where the delayed or filtered torque still contains the acceleration"
        )
    return f"left out: {'; '.join(parts)}" if parts else ""


def percent_text(share: float) -> str:
    """Return a share in per cent without its sign %, as of the ends of an interval.

    Parameters
    ----------
    share : float
        Share of 1; below 0 where it got worse.
    """
    return f"{100 * share:.0f}".replace("-", "−")


def margin_text(document: DiagnosisDocument) -> str:
    """Return the smallest size worth a name; empty where the document does not say it.

    Parameters
    ----------
    document : DiagnosisDocument
        The joint's diagnosis.
    """
    if document.margin is None:
        return ""
    margin = f"{number_text(document.margin, 2)} {document.torque_unit}"
    if document.load_margin is not None:
        least = f"{number_text(document.load_margin, 2)} {document.unit_of('load')}"
        return f"Effects below {margin} (--margin), and {least} in the load, are not named."
    if document.torque_unit == "N·m" and document.margin == LEAST_MARGIN:
        # that may be all friction of a small drive
        how = "the least margin; 'frictioncli diagnose --margin' sets another"
        return f"Effects below {margin} are not named ({how})."
    return f"Effects below {margin} are not named (--margin)."


def detectable_text(document: DiagnosisDocument) -> str:
    """Return from which size on effects would have been named.

    Parameters
    ----------
    document : DiagnosisDocument
        The joint's diagnosis.
    """
    by_unit: dict[str, list[tuple[float, str]]] = {}
    for name, size in document.detectable.items():
        if size is not None:
            by_unit.setdefault(document.unit_of(BY_NAME[name].channel), []).append((size, name))
    taken = [
        in_words(name)
        for name, why in document.undetectable.items()
        if why == TAKEN_BY_BASE and name not in document.found
    ]
    hidden = f" {TAKEN_BY_BASE[0].upper()}{TAKEN_BY_BASE[1:]}: {list_text(taken)}." if taken else ""
    if not by_unit:
        return f"The smallest size that would be named is not known for any effect.{hidden}"
    ranges = []
    for unit, sizes in by_unit.items():
        (least, easiest), (most, hardest) = min(sizes), max(sizes)
        text = f"{number_text(least, 2)} {unit} RMS ({in_words(easiest)})"
        if len(sizes) > 1:
            text += f" to {number_text(most, 2)} {unit} ({in_words(hardest)})"
        ranges.append(text)
    noun = "Smallest effects" if sum(map(len, by_unit.values())) > 1 else "Smallest effect"
    return f"{noun} that would be named in 80 % of cases: {list_text(ranges)}.{hidden}"


def empirical_text(document: DiagnosisDocument) -> str:
    """Return what an empirical term gains and where it is valid; empty without one.

    Parameters
    ----------
    document : DiagnosisDocument
        The joint's diagnosis.
    """
    found, unit = document.empirical or document.discrepancy, document.torque_unit
    if found is None:
        return ""
    on = "on pairs not used for fitting"
    if found.basis == "new_run":
        on = f"on run {document.held_out}, not used for fitting,"
    low, high = map(percent_text, found.ci95)
    what = ""
    # structure that a form describes is said already
    if found.forms and (document.structure is None or document.structure.formula is None):
        what = f" It describes {', and '.join(one.description or '' for one in found.forms)}."
    stands_for = "the unexplained part"
    if document.empirical is None:
        stands_for = "the smooth error that any model has"
    elif not found.forms:
        what = f" It varies with {list_text(_parts(found, unit))}."
    return (
        f"An empirical term for {stands_for} reduces the misfit {on} from"
        f" {number_text(found.rmse_before, 2)} to {number_text(found.rmse_after, 2)} {unit} (RMS):"
        f" {100 * found.reduction:.0f} % less ({low} to {high}).{what} It names no cause and is"
        f" valid only {_within_text(found, document.unit_of('load'))}."
    )


def _parts(found: EmpiricalGainRecord, unit: str) -> list[str]:
    """Return the larger parts of an empirical term, with sizes and intervals."""
    large = [one for one in found.parts if one.share >= _LEAST_SHARE]
    return [
        f"{list_text(one.axes).replace('position', 'angle')} in the {one.channel}"
        f" ({number_text(one.size, 2)} {unit} RMS, {number_text(one.ci95[0], 2)} to"
        f" {number_text(one.ci95[1], 2)})"
        for one in large or found.parts[:1]
    ]


def _within_text(found: EmpiricalGainRecord, load_unit: str) -> str:
    """Return the ranges of an empirical term."""
    load = f"{load_unit} of load"
    words = {"position": "deg", "speed": "deg/s", "temperature": "°C", "load": load}
    ranges = [
        f"{number_text(low, 3)} to {number_text(high, 3)} {words[axis]}"
        for axis, (low, high) in found.ranges.items()
        if axis in words and low < high
    ]
    return f"within {list_text(ranges)}"


def chance_text(cause: CauseRecord) -> str:
    """Return the p-value of a cause as text; of what could not be measured it is not known.

    Parameters
    ----------
    cause : CauseRecord
        A cause.
    """
    return "not known" if cause.size is None else p_value_text(cause.p_value)


def p_value_text(p_value: float) -> str:
    """Return a p-value as text.

    Parameters
    ----------
    p_value : float
        A probability. [1]

    Examples
    --------
    >>> p_value_text(0.031), p_value_text(2e-9), p_value_text(0.0)
    ('0.031', '2e−09', 'below 1e−300')
    """
    if p_value < 1e-300:
        return "below 1e−300"
    return f"{p_value:.0e}".replace("-", "−") if p_value < 1e-3 else number_text(p_value, 2)


def _runs_text(runs: tuple[str, ...]) -> str:
    return f"run {runs[0]}" if len(runs) == 1 else f"runs {list_text(runs)}"
