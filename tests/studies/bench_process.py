"""Run one command and write what it took: wall and CPU time [s], peak memory [bytes], exit status.

CPU and peak are those of the command and of the processes that it waited for; of several processes
the peak is that of the largest. This stands apart, and imports next to nothing, because a process's
peak begins with the memory of the one that starts it.

Usage: python -I -S bench_process.py REPORT WORD...
"""

import json
import os
import sys
import time


def main(report: str, words: list[str]) -> None:
    """Run ``words`` as one command and write the measures to the file ``report``."""
    # as installed packages have theirs, let this one keep its compiled modules
    settings = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    began = time.perf_counter()
    child = os.posix_spawnp(words[0], words, settings)
    _, status, used = os.wait4(child, 0)
    measures = {
        "wall": time.perf_counter() - began,
        "cpu": used.ru_utime + used.ru_stime,
        "peak": used.ru_maxrss * 1024,
        "status": os.waitstatus_to_exitcode(status),
    }
    with open(report, "w", encoding="utf-8") as stream:
        json.dump(measures, stream)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
