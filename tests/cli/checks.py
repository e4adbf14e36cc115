"""What the tests of the program on terminals and pipes have in common."""
import json
import subprocess
import sys

failures = 0


def check(what, condition):
    global failures
    if not condition:
        failures += 1
        print("FAILED", what)


def status(servoctl, env):
    """What `status` says of the drive; None while nobody answers."""
    answer = subprocess.run([servoctl, "status", "--json"], env=env, capture_output=True)
    return json.loads(answer.stdout)["result"][0] if answer.returncode == 0 else None


def finish():
    print("failures:", failures)
    sys.exit(1 if failures else 0)
