"""The example runs as it stands, and says what it says it does."""

import re
import subprocess
import sys
import unittest
from pathlib import Path

import fieldwalk
from walk import LOG, MAP

BINDINGS = Path(__file__).resolve().parent.parent


class Example(unittest.TestCase):
    def test_the_notebook_runs_as_a_script(self):
        script = BINDINGS / "examples" / "replay_a_walk.py"
        run = subprocess.run([sys.executable, script, MAP, LOG], capture_output=True, text=True, check=False)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertRegex(run.stdout, r"^office: \d+ fixes in \d+ s\n")
        self.assertLess(float(re.search(r"median error ([\d.]+) m", run.stdout).group(1)), 3.0)
        for system in fieldwalk.systems():
            self.assertIn(f" {system} ", run.stdout)

    def test_the_examples_of_the_readmes_run(self):
        for readme in (BINDINGS / "README.md", BINDINGS.parent.parent / "README.md"):
            code = readme.read_text(encoding="utf-8").split("```python\n")[1].split("```")[0]
            code = code.replace('"mall.map"', repr(MAP)).replace('"walk.mcap"', repr(LOG))
            exec(compile(code, str(readme), "exec"), {})

    def test_everything_public_says_what_it_does(self):
        for name in fieldwalk.__all__:
            made = getattr(fieldwalk, name)
            self.assertTrue(made.__doc__ and made.__doc__.strip(), name)


if __name__ == "__main__":
    unittest.main()
