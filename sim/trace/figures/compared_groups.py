"""The letters of callback groups in two runs: the same group has the same letter in both."""

from collections import Counter
from copy import copy
from dataclasses import replace
from itertools import count

from sim.trace.events import GroupId
from sim.trace.figures.comparison import matched
from sim.trace.incremental import Incremental
from sim.trace.model import GroupInfo
from sim.trace.timeline import Timeline


class _Lettered(dict[GroupId, GroupInfo]):
    """Groups of a run in the order of new letters; those that appear later keep their own."""

    def __init__(self, groups: dict[GroupId, GroupInfo], places: dict[GroupId, int]) -> None:
        lettered = {group: replace(groups[group], place=place) for group, place in places.items()}
        super().__init__(sorted(lettered.items(), key=lambda each: each[1].place))
        self._all = groups

    def __missing__(self, group: GroupId) -> GroupInfo:
        return self._all[group]


def lettered_alike(first: Timeline, second: Timeline, before: Timeline) -> Incremental[Timeline]:
    """Return the second run, which may go on, with the letters of the groups that it shares with the first.

    Those with the most callbacks in common are the same, first among groups that the program made, or a
    change in both runs; others get letters that the first run does not use. ``before`` is what was returned
    before, or the second run: it is returned again if nothing has changed.
    """
    common: Counter[tuple[GroupId, GroupId]] = Counter()
    for one, other in matched(first, second):
        if other is not None:
            common[first.entities[one].group, second.entities[other].group] += 1
    yield
    places: dict[GroupId, int] = {}
    taken: set[int] = set()

    def rank(pair: tuple[GroupId, GroupId]) -> tuple[bool, int, GroupId]:
        one, other = pair
        return first.groups[one].is_own != second.groups[other].is_own, -common[pair], other

    for group, alike in sorted(common, key=rank):
        place = first.groups[group].place
        if alike not in places and place not in taken:
            places[alike] = place
            taken.add(place)
    yield
    used = taken.union(each.place for each in first.groups.values() if first.group_members(each.id))
    free = (place for place in count() if place not in used)
    places |= {group: next(free) for group in second.groups if group not in places}
    if {group: each.place for group, each in before.groups.items()} == places:
        return before
    view = copy(second)
    view.groups = _Lettered(second.groups, places)
    return view
