"""Summary at the top of a page of several joints: one row per joint, with links."""

from collections.abc import Sequence
from dataclasses import dataclass

from frictioncli.report.joint_section import JointSection
from frictioncli.report.quality_ratings import FAIR, POOR, worst_level
from frictioncli.wording import count_text


@dataclass(frozen=True, slots=True, kw_only=True)
class JointLine:
    """A joint in the summary.

    Attributes
    ----------
    number : int
        Joint number, from 1.
    answers : tuple of (str, str)
        Answers of its first screen: the emphasised value, and the text to read it by.
    level : {"good", "fair", "poor"}
        Its worst rating of data quality.
    quality : str
        How many aspects are rated less than good.
    """

    number: int
    answers: tuple[tuple[str, str], ...]
    level: str
    quality: str


@dataclass(frozen=True, slots=True, kw_only=True)
class JointsSummary:
    """Summary of several joints: the questions, and a line per joint."""

    questions: tuple[str, ...]
    lines: tuple[JointLine, ...]


def joints_summary(sections: Sequence[JointSection]) -> JointsSummary | None:
    """Return the summary of several joints; None for a single one, which needs none.

    Parameters
    ----------
    sections : sequence of JointSection
        The joints, in the order of the page.
    """
    if len(sections) < 2:
        return None
    return JointsSummary(
        questions=tuple(answer.question for answer in sections[0].answers),
        lines=tuple(_line(section) for section in sections),
    )


def _line(section: JointSection) -> JointLine:
    levels = [rating.level for rating in section.ratings]
    counts = [count_text(levels.count(level), level, level) for level in (POOR, FAIR)]
    return JointLine(
        number=section.number,
        answers=tuple((answer.value, answer.text) for answer in section.answers),
        level=worst_level(*levels),
        quality=", ".join(text for text in counts if not text.startswith("0 ")) or "all good",
    )
