"""Explanation of the effects that a diagnosis mentions: equation, parameters and source."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from markupsafe import Markup, escape

from frictioncli.effects import BY_NAME
from frictioncli.effects.base import Effect
from frictioncli.report.results import JointResults
from frictioncli.wording import in_words, list_text

_REFERENCE = re.compile(r"(doi:|arXiv:)([\w./()-]*[\w)])")
_RESOLVERS = {"doi:": "https://doi.org/", "arXiv:": "https://arxiv.org/abs/"}


@dataclass(frozen=True, slots=True, kw_only=True)
class Explanation:
    """One effect of the catalogue, explained.

    Attributes
    ----------
    name : str
        Name in documents, and part of the identifier on the page.
    title : str
        Name in words.
    summary : str
        The effect in a short sentence.
    equation : str
        What it adds to the torque, in symbols.
    parameters : tuple of (str, str, str)
        Symbol, meaning and unit of each parameter.
    source : Markup
        Reference, with links.
    confounders : str
        Effects that are most easily confused with it; empty without any.
    experiment : str
        The experiment that separates it from them.
    """

    name: str
    title: str
    summary: str
    equation: str
    parameters: tuple[tuple[str, str, str], ...]
    source: Markup
    confounders: str
    experiment: str


def explanations(joints: Sequence[JointResults]) -> tuple[Explanation, ...]:
    """Return the effects of all causes that the diagnoses mention, named or not, each once.

    Parameters
    ----------
    joints : sequence of JointResults
        Results of the joints of a page.
    """
    documents = [joint.diagnosis.document for joint in joints if joint.diagnosis]
    mentioned = (
        name
        for document in documents
        for cause in (*document.causes, *document.visible)
        for name in cause.effects
    )
    units = {document.torque_unit for document in documents}
    torque = units.pop() if len(units) == 1 else "torque"
    return tuple(explanation(name, torque) for name in explained(dict.fromkeys(mentioned)))


def explained(names: Iterable[str]) -> tuple[str, ...]:
    """Return those names that are effects of the catalogue, in the same order.

    Parameters
    ----------
    names : iterable of str
        Names of effects.
    """
    return tuple(name for name in names if name in BY_NAME)


def explanation(name: str, torque: str = "N·m") -> Explanation:
    """Return the explanation of an effect.

    Parameters
    ----------
    name : str
        Its name in the catalogue.
    torque : str
        Unit of torque.
    """
    effect: Effect = BY_NAME[name]
    return Explanation(
        name=name,
        title=in_words(name),
        summary=effect.summary,
        equation=effect.equation,
        parameters=tuple(
            (one.symbol, one.description, _unit_text(one.unit, torque))
            for one in (*effect.shape, *effect.coefficients)
        ),
        source=source_markup(effect.source),
        confounders=list_text([in_words(other) for other in effect.confounders]),
        experiment=effect.experiment,
    )


def source_markup(source: str) -> Markup:
    """Return a reference in which identifiers of publications are links.

    Parameters
    ----------
    source : str
        The reference, with identifiers such as ``doi:10.1155/2019/6931563``.

    Examples
    --------
    >>> print(source_markup("Dahl, arXiv:2410.08650."))
    Dahl, <a href="https://arxiv.org/abs/2410.08650" rel="noreferrer">arXiv:2410.08650</a>.
    """
    parts, end = [], 0
    for found in _REFERENCE.finditer(source):
        kind, identifier = found.groups()
        parts += [
            escape(source[end : found.start()]),
            Markup('<a href="{}" rel="noreferrer">{}</a>').format(
                _RESOLVERS[kind] + identifier, found[0]
            ),
        ]
        end = found.end()
    return Markup("").join([*parts, escape(source[end:])])


def _unit_text(unit: str, torque: str) -> str:
    return "" if unit == "1" else unit.replace("torque", torque)
