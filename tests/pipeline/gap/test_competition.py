"""The course of a competition, where its parts play no role."""

from pipeline.gap.competition import Competition


class Crowded(Competition):
    """A competition with room for so many effects, some of which are disowned; x may stay only beside b."""

    def __init__(self, room: int, contestants: str, doubtful: str) -> None:
        self.room, self.catalogue, self.doubtful = room, contestants, set(doubtful)
        self.inside: list[str] = []
        self.dropped: set[str] = set()
        self.run(contestants)

    def run(self, contestants: str) -> None:
        fresh = [each for each in contestants if each not in self.dropped | set(self.inside)]
        self.inside += fresh[: self.room - len(self.inside)]

    def has_room(self) -> bool:
        return len(self.inside) < self.room

    def disown(self) -> None:
        self.dropped |= self.doubtful & set(self.inside)
        self.inside = [each for each in self.inside if each not in self.dropped]

    def prune(self) -> None:
        if "b" not in self.inside and "x" in self.inside:
            self.dropped.add("x")
            self.inside.remove("x")


def test_what_cannot_stay_without_the_disowned_goes_too():
    competition = Crowded(3, "bx", "b")
    competition.catalogue = "bx"
    competition.conclude()
    assert competition.inside == []


def test_what_is_disowned_makes_room_for_what_it_kept_out():
    competition = Crowded(3, "abcdef", "bd")
    competition.conclude()
    assert competition.inside == ["a", "c", "e"]


def test_where_there_was_room_nothing_enters_again():
    competition = Crowded(4, "abc", "b")
    competition.catalogue = "abcz"
    competition.conclude()
    assert competition.inside == ["a", "c"]


def test_it_ends_where_all_are_disowned():
    competition = Crowded(1, "abc", "abc")
    competition.conclude()
    assert competition.inside == []
