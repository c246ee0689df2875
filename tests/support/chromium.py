"""Pages in headless Chromium: a page is opened, a script acts on it, and what it found is returned.

There is no remote control: the script is put into a copy of the page, and its result is read from
the document that Chromium prints.
"""

import html
import json
import re
import shutil
import subprocess

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome")
FOUND = next(filter(None, map(shutil.which, NAMES)), None)
needs_chromium = pytest.mark.skipif(
    FOUND is None, reason="Chromium is not installed: the pages are not opened in a browser"
)
OPTIONS = (
    "--headless=new",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)
# Before the page's own scripts: errors, and requests that its policy refuses, are collected.
WATCH = """<script>
window.troubles = [];
addEventListener("error", (event) => troubles.push("error: " + event.message));
addEventListener("unhandledrejection", (event) => troubles.push("promise: " + event.reason));
addEventListener("securitypolicyviolation", (event) => troubles.push("to " + event.blockedURI));
for (const kind of ["error", "warn"]) {
  const told = console[kind];
  console[kind] = (...words) => { troubles.push(kind + ": " + words.join(" ")); told(...words); };
}
</script>"""
ACT = """<script>
const pause = (ms) => new Promise((done) => setTimeout(done, ms));
addEventListener("load", async () => {
  await pause(1500);
  let found = null;
  try { found = await (async () => { %s })(); }
  catch (problem) { troubles.push("script: " + problem.stack); }
  const text = document.createElement("pre");
  text.id = "found-by-the-test";
  text.textContent = JSON.stringify({found, troubles});
  document.body.appendChild(text);
});
</script>"""


def opened(page, script, folder, width=1280):
    """Return (what a script returned, errors and refused requests) of a page in Chromium.

    page: HTML text.
    script: body of an asynchronous JavaScript function; pause(ms) waits.
    folder: for the copy and for Chromium's own files.
    width: of the window, px.
    """
    copy = folder / "page.html"
    body, end, after = page.replace("<head>", f"<head>{WATCH}", 1).rpartition("</body>")
    copy.write_text(body + ACT % script + end + after, encoding="utf-8")
    run = subprocess.run(
        [
            str(FOUND),
            *OPTIONS,
            f"--user-data-dir={folder / 'profile'}",
            f"--window-size={width},1000",
            "--virtual-time-budget=20000",
            "--dump-dom",
            copy.as_uri(),
        ],
        capture_output=True,
        text=True,
        timeout=120,
    )
    result = re.search(r'<pre id="found-by-the-test">(.*?)</pre>', run.stdout, flags=re.S)
    assert result, f"the script did not finish: {run.stderr[-2000:]}"
    values = json.loads(html.unescape(result.group(1)))
    return values["found"], values["troubles"]
