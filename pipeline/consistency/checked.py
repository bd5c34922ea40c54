"""What the check of a recording found."""

from dataclasses import dataclass

from simgap.recordings.contradiction import Contradiction

DOUBTED = "a column may not be what it is taken for"
"""How the warning begins that says so."""
_WORTH_SAYING = 0.05
"""Least probability of a suspected cause that is said: twenty to one against it (`decide.CLEAR`)."""


@dataclass(frozen=True)
class Checked:
    """What contradicts itself in a recording, and how sure that is.

    Attributes:
        contradictions: so clear that nothing can be named.
        suspected: the likeliest of the causes that would end a contradiction that is not so clear; None: none would.
        doubt: probability that there is such a cause. What is named holds in the other case only.
    """

    contradictions: tuple[Contradiction, ...] = ()
    suspected: Contradiction | None = None
    doubt: float = 0.0

    @property
    def warnings(self) -> tuple[str, ...]:
        """What to say of a cause that is possible and not certain."""
        if self.suspected is None or self.doubt < _WORTH_SAYING:
            return ()
        unsure = f"{DOUBTED}, with a probability of {self.doubt:.0%}, and no name holds then"
        return (f"{unsure}: {self.suspected.sentence}",)
