"""A drive is taken out while its process is killed, another from the factory put in: `cabinet swap` over a bus between processes.
usage: swap_test.py SERVOCTL"""
import json
import os
import subprocess
import sys
import tempfile
import time

from checks import check, finish

servoctl = os.path.abspath(sys.argv[1])
folder = tempfile.mkdtemp(prefix="swap")
bus = f"local:swap-{os.getpid()}"
env = {k: v for k, v in os.environ.items() if not k.startswith("SERVOCTL_")} | {
    "SERVOCTL_DRIVES": os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../eds"),
    "XDG_STATE_HOME": folder,
}


def run(*words, **more):
    return subprocess.run([servoctl, *words], cwd=folder, env=env, capture_output=True, text=True, timeout=60, **more)


def put_in(*drives):
    """Drives on the bus; returns when the last one answers."""
    sim = subprocess.Popen([servoctl, "sim", ",".join(drives), "--bus", bus], env=env, stdout=subprocess.DEVNULL)
    last = drives[-1].split("@")[1].split("?")[0]
    for _ in range(100):
        if run("read", "0x1000", "-n", last, "-b", bus).returncode == 0:
            return sim
        time.sleep(0.05)
    raise SystemExit("the simulated drives do not answer")


def plan():
    answer = run("cabinet", "plan", "--json")
    return answer.returncode, json.loads(answer.stdout)


with open(os.path.join(folder, "cabinet.toml"), "w") as file:
    file.write(f"""format = 1
[bus.main]
url = "{bus}"
[axis.lift]
bus = "main"
node = 3
family = "gsd600"
[axis.lift.parameters]
Pn0214 = "45 Hz"
[axis.feeder]
bus = "main"
node = 4
family = "gsd600"
""")

sim = put_in("gsd600@3", "gsd600@4")
check("the file is one", run("cabinet", "check").returncode == 0)
answer = run("cabinet", "apply", "--yes")
check(f"applied\n{answer.stdout}{answer.stderr}", answer.returncode == 0)
check("and as it should be", plan()[0] == 0)
answer = run("param", "set", "Pn0220=7", "-n", "lift", "--keep", "--yes")
check(f"something that is not in the file\n{answer.stdout}{answer.stderr}", answer.returncode == 0)
backup = run("cabinet", "backup", "--json")
check(f"saved\n{backup.stderr}", backup.returncode == 0)
saved = next(name for name in os.listdir(folder) if name.startswith("backup"))
sim.kill()
sim.wait()

# The drive is out, its connector free.
answer = run("cabinet", "swap", "lift", "--from", "1", "--yes")
check(f"a bus without the new drive\n{answer.stderr}", answer.returncode in (3, 4) and answer.stderr.startswith("error:"))

# From the factory all are node 1.
sim = put_in("gsd600@4", "gsd600@1")
answer = run("cabinet", "swap", "lift", "--from", "1")
check(f"nobody was asked\n{answer.stderr}", answer.returncode == 8)
check("and nothing moved", run("read", "0x1000", "-n", "1", "-b", bus).returncode == 0 and run("read", "0x1000", "-n", "3", "-b", bus).returncode == 4)
answer = run("cabinet", "swap", "lift", "--from", "4", "--yes")
check(f"the place of another axis\n{answer.stderr}", answer.returncode != 0 and run("read", "0x1000", "-n", "4", "-b", bus).returncode == 0)
answer = run("cabinet", "swap", "lift", "--from", "1", "--yes")
check(f"swapped\n{answer.stdout}{answer.stderr}", answer.returncode == 0)
code, left = plan()
check(f"nothing is left to do\n{left}", code == 0)
answer = run("param", "get", "Pn0214", "-n", "lift", "--json")
check(f"the parameter of the file\n{answer.stdout}", json.loads(answer.stdout)["result"][0]["value"] == 45)
check("node 1 is free again", run("read", "0x1000", "-n", "1", "-b", bus).returncode == 4)
again = run("cabinet", "swap", "lift", "--yes")
check(f"a second time does nothing\n{again.stdout}{again.stderr}", again.returncode == 0)
sim.kill()
sim.wait()

# All that was saved, not only what stands in the file.
sim = put_in("gsd600@4", "gsd600@1")
answer = run("cabinet", "swap", "lift", "--from", "1", "--backup", saved, "--yes")
check(f"by the backup\n{answer.stdout}{answer.stderr}", answer.returncode == 0)
check("nothing is left to do", plan()[0] == 0)
answer = run("param", "get", "Pn0220", "-n", "lift", "--json")
check(f"what the file does not have\n{answer.stdout}", json.loads(answer.stdout)["result"][0]["raw"] == 7)
sim.kill()
sim.wait()
finish()
