"""The command: runs the checks, prints the table."""
import re
import tempfile
import time
from pathlib import Path

from ..errors import CHECKS_FAILED, DONE, UserError
from ..paths import TOP

GOLDEN = TOP / "tests" / "golden" / "protocol_v1"


def chosen(checks, pattern):
    picked = [one for one in checks if not pattern or re.search(pattern, f"{one.name} {one.what}")]
    if not picked:
        raise UserError(f"--only {pattern}: no check has this in its name.")
    return picked


def conform(arguments):
    from .checks import ALL, Check, Skipped, golden_check
    from .coupler import Broken, Meeting, NeverCame
    from .recording import play

    command = arguments.participant
    if command and not any("{endpoint}" in word for word in command):
        raise UserError("the command must say {endpoint} where the participant takes it.")
    if arguments.shm and not arguments.endpoint.startswith("ipc://"):
        raise UserError("--shm is for ipc:// endpoints.")
    patience = 20.0 if command else 120.0

    def meet(**options):
        if not command:
            print(f"... waiting for the participant at {arguments.endpoint}", flush=True)
        return Meeting(arguments.endpoint, command, arguments.shm, patience=patience, **options)

    checks = [*ALL, *(golden_check(path) for path in sorted(GOLDEN.glob("fault_*.hex")))]
    if arguments.recording:
        def replayed(meet_again):
            with meet_again() as meeting:
                return play(meeting, arguments.recording)
        checks.append(Check("recording", f"plays {Path(arguments.recording).name}", replayed))
    counts = {"ok": 0, "FAILED": 0, "-": 0}
    start = time.monotonic()
    for one in chosen(checks, arguments.only):
        try:
            verdict, remark = "ok", one.run(meet) or ""
        except Skipped as why:
            verdict, remark = "-", str(why)
        except NeverCame as why:
            raise UserError(str(why)) from None
        except Broken as sentence:
            verdict, remark = "FAILED", str(sentence)
        counts[verdict] += 1
        print(f"{verdict:7}{one.what}" + (f"  [{remark}]" if remark else ""), flush=True)
    print(f"{counts['ok']} passed, {counts['FAILED']} failed, {counts['-']} do not apply, "
          f"in {time.monotonic() - start:.1f} s")
    return CHECKS_FAILED if counts["FAILED"] else DONE


def split(arguments):
    """The tool's own arguments, and the command behind "--"."""
    if arguments[:1] != ["conform"] or "--" not in arguments:
        return arguments, []
    at = arguments.index("--")
    return arguments[:at], arguments[at + 1:]


def with_endpoint(arguments):
    """"ipc" and "tcp" alone stand for an endpoint of this run's own."""
    if arguments.endpoint == "tcp":
        arguments.endpoint = "tcp://127.0.0.1:*"
    if arguments.endpoint != "ipc":
        return conform(arguments)
    with tempfile.TemporaryDirectory(prefix="undertow-") as folder:
        arguments.endpoint = f"ipc://{folder}/coupler.sock"
        return conform(arguments)


def add_command(commands):
    sub = commands.add_parser("conform", help="check a participant against the protocol",
                              description="Plays the coupler, right and wrong, and prints what the participant made "
                                          "of it. Every check is a connection of its own: give the command that starts "
                                          "the participant, or start it anew whenever this program waits for it.",
                              usage="undertow conform ENDPOINT [options] [-- COMMAND ...]",
                              epilog="COMMAND starts the participant; in it, {endpoint} is replaced.")
    sub.add_argument("endpoint", metavar="ENDPOINT", help="where to listen: ipc:///folder/coupler.sock, "
                     "tcp://127.0.0.1:PORT, or ipc or tcp alone")
    sub.add_argument("--shm", action="store_true", help="offer the shared-memory plane")
    sub.add_argument("--recording", metavar="FILE", help="play this recorded session as well")
    sub.add_argument("--only", metavar="PATTERN", help="only checks with this in their name")
    sub.set_defaults(do=with_endpoint)
