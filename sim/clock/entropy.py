"""Randomness of a virtual run: the system's random numbers come from a seed and are the same in every run."""

import os
import random
import sys
import tempfile
import uuid
from typing import Any

from sim.clock.outside_work import OutsideWork
from sim.clock.replacing import Replacements

_SEED = 0


def replace_entropy(replacements: Replacements, outside: OutsideWork) -> None:
    """Replace ``os.urandom`` and its users, and seed the generators that the system had seeded."""
    owns = replacements.clock.owns_current_thread
    source = random.Random(_SEED)
    generator: Any = random.Random
    real_seed = generator.seed

    def seed(self: random.Random, a: Any = None, version: int = 2) -> None:
        real_seed(self, source.getrandbits(256) if a is None and owns() else a, version)

    def drawn(size: int) -> bytes:
        if size < 0:
            raise ValueError("negative argument not allowed")
        return source.randbytes(size)

    class Unpredictable(random.Random):
        """Draws from the system: predictable file names would be a security risk."""

        seed = real_seed

    class TemporaryNames(tempfile._RandomNameSequence):  # type: ignore[name-defined,misc]
        """Reports that temporary files get new names in each run."""

        def __next__(self) -> str:
            if owns():
                outside.tell("temporary files get new names in each run")
            name: str = super().__next__()
            return name

    temporary: Any = tempfile
    temporary._Random = Unpredictable
    temporary._RandomNameSequence = TemporaryNames
    replacements.put(os, "urandom", drawn)
    replacements.put(os, "getrandom", lambda size, _flags=0: drawn(size))
    generator.seed = seed
    functions: Any = random
    functions.seed = functions._inst.seed
    random.seed(_SEED)
    numpy_random: Any = sys.modules.get("numpy.random")
    if numpy_random is not None:
        numpy_random.seed(_SEED)  # if it is imported later, it is seeded from os.urandom
    uuids: Any = uuid
    uuids._generate_time_safe = None  # uuid1 then asks time.time_ns, random and getnode
    node = source.getrandbits(48) | 1 << 40  # the multicast bit of a random node, as in RFC 4122
    replacements.put(uuid, "getnode", lambda: node)
