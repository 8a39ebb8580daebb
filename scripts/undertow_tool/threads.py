"""How many threads a run gets, and how they wait for each other.

Between two loops of a step threads wait for some ten microseconds. A thread that goes to sleep for that needs
fifty to wake up again: 27,000 particles on two cores make 7.8 instead of 9.4 million particle-steps a second,
1,000 are five times slower on two threads than on one. A thread that keeps looking (it spins) takes time from whoever
could use the core: two such runs at once on two cores take 19 % longer. So threads spin, for a tenth of a
millisecond at most, when the cores are free as a run starts, and sleep at once otherwise.
"""
import os
import time

from .estimate import particles

SPIN = 3000                 # looks of a waiting thread before it sleeps: 0.14 ms
# fewer particles than that for each thread, and one thread less is faster
WORTH_A_THREAD = {True: 400, False: 4000}


def cores():
    return len(os.sched_getaffinity(0))


def busy_threads():
    """How many threads of others run on this machine just now; None where nobody can tell."""
    try:
        seen = []
        for _ in range(9):
            with open("/proc/loadavg", encoding="ascii") as file:
                seen.append(int(file.read().split()[3].split("/")[0]) - 1)    # we run as well
            time.sleep(0.005)
    except (OSError, ValueError, IndexError):
        return None
    return sorted(seen)[len(seen) // 2]


def may_spin(threads):
    busy = busy_threads()
    return busy is not None and threads > 1 and threads + busy <= cores()


def sensible_threads(case, spin):
    """Every core that is worth a thread."""
    if not case["sph"]:
        return cores()
    return max(1, min(cores(), particles(case) // WORTH_A_THREAD[spin]))

