#!/usr/bin/env python3
"""Opens reports in a browser without a window and looks at them: document, screenshot, telephone, paper.

usage: report_page_test.py SERVOCTL SOURCE_DIR
Exit code 77 where there is no chromium: nothing was looked at.
"""
import json
import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import zlib

SERVOCTL, SOURCE = os.path.abspath(sys.argv[1]), sys.argv[2]
HOSTILE = "<script>document.title=1</script><img src=x onerror=document.title=1>'\"&"
failures = 0


def check(what, good, detail=""):
    global failures
    if not good:
        failures += 1
        print(f"FAILED {what}\n  {detail}")


def browser(*words):
    command = ["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--no-first-run",
               f"--user-data-dir={work}/browser", "--enable-logging=stderr", *words]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    return done.stdout, [line for line in done.stderr.splitlines() if "CONSOLE" in line]


def grey(png):
    """Width, height, and the share of pixels that are dark, of a PNG with 8 bits a channel."""
    width, height, depth, kind = struct.unpack(">IIBB", png[16:26])
    assert depth == 8 and kind in (2, 6), "an RGB or RGBA picture"
    size, at, packed = {2: 3, 6: 4}[kind], 8, b""
    while at < len(png):
        length = struct.unpack(">I", png[at:at + 4])[0]
        if png[at + 4:at + 8] == b"IDAT":
            packed += png[at + 8:at + 8 + length]
        at += 12 + length
    raw, before, dark = zlib.decompress(packed), bytearray(width * size), 0
    for row in range(height):
        start = row * (width * size + 1)
        method, line = raw[start], bytearray(raw[start + 1:start + 1 + width * size])
        for i in range(len(line)):
            left = line[i - size] if i >= size else 0
            corner = before[i - size] if i >= size else 0
            if method == 1:
                line[i] = line[i] + left & 255
            elif method == 2:
                line[i] = line[i] + before[i] & 255
            elif method == 3:
                line[i] = line[i] + (left + before[i]) // 2 & 255
            elif method == 4:
                ends = [(abs(before[i] - corner), left), (abs(left - corner), before[i]),
                        (abs(left + before[i] - 2 * corner), corner)]
                line[i] = line[i] + min(ends, key=lambda end: end[0])[1] & 255
        dark += sum(1 for i in range(0, len(line), size) if line[i] < 128)
        before = line
    return width, height, dark / (width * height)


def servoctl(*words, code=0):
    done = subprocess.run([SERVOCTL, *words], capture_output=True, text=True, timeout=120, env=environment)
    check(f"servoctl {' '.join(words)}: exit code {code}", done.returncode == code, done.stderr)
    return done.stdout


def hostile_family(folder):
    """A drive whose name, and whose family's name, are markup."""
    lab = os.path.join(SOURCE, "tests/cli/data/drives/lab/lab")
    with open(lab + ".eds") as eds, open(os.path.join(folder, "hostile.eds"), "w") as out:
        out.write(eds.read().replace("A laboratory device with a long name", HOSTILE))
    with open(lab + ".toml") as toml, open(os.path.join(folder, "hostile.toml"), "w") as out:
        out.write(toml.read().replace('family = "lab"', 'family = "hostile"')
                  .replace('"Laboratory device"', json.dumps(HOSTILE)))


def earlier_tests(path):
    """What `test jog --json` writes, with samples of three quantities, and a name that is markup."""
    seconds = [i * 0.02 for i in range(200)]
    speed = [min(60, i * 3) for i in range(200)]
    samples = [{"name": "position", "unit": "deg", "seconds": seconds, "values": [i * 7.2 for i in range(200)]},
               {"name": "velocity", "unit": "rpm", "seconds": seconds, "values": speed},
               {"name": HOSTILE, "unit": "%", "seconds": seconds, "values": [None] + [3.5] * 199}]
    criteria = [{"id": "speed_forward", "name": HOSTILE, "verdict": "passed", "figure": 0.4, "relation": "<=",
                 "limit": 10, "unit": "%", "note": None}]
    result = [{"test": "jog", "node": 1, "passed": True, "seconds": 4, "criteria": criteria, "samples": samples}]
    with open(path, "w") as out:
        json.dump({"servoctl": 1, "command": "test jog", "ok": True, "bus": None, "result": result, "notices": []}, out)


def many_criteria(path):
    """A test of 60 criteria with long names and notes: a table of several sheets that is wider than one."""
    note = "what was seen, told at such length that it takes a second line, and on paper a third one; "
    criteria = [{"id": f"c{i}", "name": f"criterion {i} with a name that says what was looked at", "verdict": "passed", "figure": i,
                 "relation": "<=", "limit": 100, "unit": "%", "note": note + "W" * (90 if i == 5 else 0)} for i in range(60)]
    result = [{"test": "jog", "node": 1, "passed": True, "seconds": 4, "criteria": criteria, "samples": []}]
    with open(path, "w") as out:
        json.dump({"servoctl": 1, "command": "test jog", "ok": True, "bus": None, "result": result, "notices": []}, out)


def printed(page):
    """The text of each sheet of paper, and the place of its rightmost word in points."""
    paper = page + ".pdf"
    browser("--no-pdf-header-footer", f"--print-to-pdf={paper}", "file://" + page)
    text = subprocess.run(["pdftotext", "-layout", paper, "-"], capture_output=True, text=True).stdout
    words = subprocess.run(["pdftotext", "-bbox", paper, "-"], capture_output=True, text=True).stdout
    return text.split("\f")[:-1], max(float(x) for x in re.findall(r'xMax="([\d.]+)"', words))


def look_at_sheets(page, titles, signed_by, foot):
    """Each drive begins a sheet, is named on all that follow, and the lines to be signed stand together."""
    sheets, right = printed(page)
    check("no word is cut off at the right", right < 595 - 30, right)
    begun = [i for i, sheet in enumerate(sheets) for title in titles
             if any(line.strip() == title for line in sheet.splitlines()[1:])]
    check("each drive begins a sheet of its own, the first behind the title block", len(set(begun)) == len(titles) and min(begun) == 1,
          begun)
    named = [next((title for title in titles if sheet.splitlines()[0].endswith(title)), None) for sheet in sheets]
    wanted = [None] + [titles[sum(at <= i for at in begun) - 1] for i in range(1, len(sheets))]
    check("each sheet carries the name of its drive", named == wanted, named)
    for i, sheet in enumerate(sheets):
        check("each sheet is numbered, and says whose it is", re.search(rf"{i + 1} ?/ ?{len(sheets)}$", sheet, re.M) and foot in sheet, sheet[-200:])
    signed = [i for i, sheet in enumerate(sheets) if any(re.search(rf"^\s*{who}$", sheet, re.M) for who in signed_by)]
    check("the signatures stand on the last sheet, together", set(signed) == ({len(sheets) - 1} if signed_by else set()), signed)
    return sheets


def look_at(page, sections, plots):
    with open(page, encoding="utf-8") as file:
        html = file.read()
    url = "file://" + page
    tags = re.sub(r'"[^"]*"', '""', html)
    pictures = re.findall(r'<img class="picture" alt="" src="data:image/[a-z+]+;base64,[A-Za-z0-9+/=]+">', html)
    check("one picture at most", len(pictures) <= 1, len(pictures))
    if not pictures:
        check("it loads nothing", not re.search(r"<[^>]*\b(src|href)\s*=|@import|url\(", tags))
    dom, console = browser("--dump-dom", url)
    check("no errors in the browser's console", console == [], console)
    check("no markup came out of a value", not re.search(r"<script|<img(?! class=\"picture\")", dom) and "<title>1<" not in dom)
    headings = re.findall(r"<h[1-4][^>]*>(.*?)</h[1-4]>", dom)
    for section in sections:
        check(f"there is a section {section}", section in headings, headings)
    check(f"{plots} plots", dom.count("<svg") == plots, dom.count("<svg"))

    picture = page + ".png"
    browser(f"--screenshot={picture}", "--window-size=1000,1400", url)
    with open(picture, "rb") as file:
        width, height, dark = grey(file.read())
    check("a screenshot of that size", (width, height) == (1000, 1400), (width, height))
    check("dark text on white", 0.005 < dark < 0.3, dark)

    wrapper = page + ".telephone.html"
    with open(wrapper, "w") as file:
        file.write(f"""<iframe id=f width=360 height=640 src="{url}"></iframe><p id=p></p><script>
f.onload = () => p.textContent = 'width ' + f.contentDocument.documentElement.scrollWidth;</script>""")
    narrow, _ = browser("--allow-file-access-from-files", "--dump-dom", "--virtual-time-budget=5000", "file://" + wrapper)
    found = re.search(r"width (\d+)", narrow)
    check("a telephone need not scroll sideways", found and int(found[1]) <= 360, found and found[0])

    paper = page + ".pdf"
    browser("--no-pdf-header-footer", f"--print-to-pdf={paper}", url)
    info = subprocess.run(["pdfinfo", paper], capture_output=True, text=True).stdout
    check("it is printed on A4", "A4" in info, info)
    pages = int(re.search(r"Pages:\s+(\d+)", info)[1])
    check("on a few pages", 1 < pages < 8, pages)
    text = subprocess.run(["pdftotext", "-layout", paper, "-"], capture_output=True, text=True).stdout
    check("no page is empty", all(len(sheet.split()) > 2 for sheet in text.split("\f")[:-1]), text)
    return dom, text


if not shutil.which("chromium") or not shutil.which("pdfinfo"):
    print("skipped: there is no chromium (./dev test installs it), so no page was looked at")
    sys.exit(77)
with tempfile.TemporaryDirectory() as work:
    hostile_family(work)
    environment = {**os.environ, "SERVOCTL_DRIVES": f"{work}:{SOURCE}/eds", "LANG": "C"}
    for name in ("SERVOCTL_BUS", "SERVOCTL_NODE", "SERVOCTL_DRIVE", "SERVOCTL_LANG"):
        environment.pop(name, None)
    earlier_tests(f"{work}/jog.json")

    servoctl("report", f"{work}/en.html", "-n", "1,2", "-b", "sim:gsd600@1,gsd600@2?fault=0xFF00@1ms", "-d", "gsd600",
             "--title", "Press 3 <b>", "--tests", f"{work}/jog.json")
    dom, text = look_at(f"{work}/en.html", ["Press 3 &lt;b&gt;", "Summary", "Bus", "Node 1", "Node 2", "Identity", "State",
                                            "Faults", "Settings that differ from factory values",
                                            "Process data (PDO)", "Tests"], 1)
    check("the paper carries the title", "Press 3 <b>" in text)
    for value in ("0x00020192", "Servo alarm", "servoctl 0.", "Controlword"):
        check(f"{value} is in the page", value in dom)

    servoctl("report", f"{work}/zh.html", "-n", "1", "-b", "sim:ts@1?fault=ERR_oc@1ms", "-d", "ts", "--lang", "zh")
    dom, _ = look_at(f"{work}/zh.html", ["调试报告", "概要", "总线", "节点 1", "身份信息", "状态", "故障", "与出厂值不同的设置",
                                         "过程数据（PDO）", "测试"], 0)
    check("the page says that it is Chinese", '<html lang="zh-CN">' in dom)
    words = re.findall(r"<th[^>]*>([^<]+)</th>", dom)
    names = re.compile(r"[RT]PDO\d+|95 %|Dn_12")  # What has no other name in Chinese.
    english = [word for word in words if word.isascii() and not names.match(word)]
    check("every heading of the Chinese page is Chinese", english == [], english)

    logo = f"{work}/logo.svg"
    with open(logo, "w") as file:
        file.write('<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 90 30" onload="document.title=1">'
                   '<script>document.title=1</script><rect width="90" height="30"/></svg>')
    many_criteria(f"{work}/many.json")
    servoctl("report", f"{work}/customer.html", "-n", "1-5", "-b", ",".join(f"{'sim:' * (i == 1)}gsd600@{i}" for i in range(1, 6)),
             "-d", "gsd600", "--customer", HOSTILE, "--machine", "Press 3 三号", "--operator", "A. Fitter", "--logo", logo,
             "--tests", f"{work}/many.json", "--signatures", "Fitter,Customer")
    dom, console = browser("--dump-dom", f"file://{work}/customer.html")
    check("no script of the picture runs, nothing is refused", console == [] and "<title>1<" not in dom, console)
    check("what the customer is called is text", "<td>&lt;script&gt;document.title=1" in dom)
    sheets = look_at_sheets(f"{work}/customer.html", [f"Node {i}" for i in range(1, 6)], ["Fitter", "Customer"], "Press 3")
    heads = [i for i, sheet in enumerate(sheets) if re.search(r"verdict +criterion +figure +limit", sheet)]
    check("a long table has its headings on every sheet", len([i for i in heads if i < 8]) > 4, heads)
    rows = re.findall(r"criterion (\d+)", "".join(sheets))
    check("all rows are on paper", sorted(set(map(int, rows))) == list(range(60)), rows)
    browser(f"--screenshot={work}/customer.png", "--window-size=400,120", f"file://{work}/customer.html")
    with open(f"{work}/customer.png", "rb") as file:
        check("the picture is drawn", grey(file.read())[2] > 0.05)

    servoctl("report", f"{work}/plain.html", "-n", "1", "-b", "coe:sim:sv2@1", "-d", "sv2", "--title", "Lift \"7\" </style>")
    look_at_sheets(f"{work}/plain.html", ["Node 1"], [], "20")

    servoctl("report", f"{work}/hostile.html", "-n", "1", "-b", "sim:hostile@1", "-d", "hostile")
    dom, _ = look_at(f"{work}/hostile.html", ["Identity"], 0)
    check("the hostile name stands there as text", "&lt;script&gt;document.title=1&lt;/script&gt;" in dom)

    servoctl("report", f"{work}/one.json", "-n", "1", "-b", "sim:gsd600@1", "-d", "gsd600", "--tests", f"{work}/jog.json")
    with open(f"{work}/one.json") as file:
        document = json.load(file)
    check("the JSON has every part", set(document["nodes"][0]) >= {"identity", "state", "faults", "settings", "pdos", "tests"},
          document["nodes"][0].keys())
    check("the JSON has the samples", len(document["nodes"][0]["tests"][1]["samples"]) == 3)
print(f"{failures} failed")
sys.exit(failures != 0)
