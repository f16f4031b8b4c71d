#!/usr/bin/env python3
"""Tests of the program kjoint as a user meets it: words, streams, exit codes, signals.

usage: test_cli.py KJOINT [unittest arguments]
"""
import array
import fcntl
import gzip
import json
import math
import os
import pathlib
import pty
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import termios
import time
import unittest
import xml.etree.ElementTree

SOURCE = pathlib.Path(os.environ.get("KJOINT_SOURCE_DIR", pathlib.Path(__file__).parents[2]))
CASE = SOURCE / "tests" / "parity" / "REV01"
KJOINT = ""


class Program(unittest.TestCase):
    """Runs kjoint in a folder of its own, with a short deck REV01 in it."""

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)
        for name in ("REV01_0000.rad", "REV01_0001.rad"):
            shutil.copy(CASE / name, self.folder)
            (self.folder / name).chmod(0o644)
        self.starter = self.folder / "REV01_0000.rad"
        self.engine = self.folder / "REV01_0001.rad"
        self.short()

    def short(self):
        """End after ten samples instead of 250."""
        self.engine.write_text(self.engine.read_text().replace("\n0.5\n", "\n0.0199\n", 1))

    def kjoint(self, *words, code=0, **environment):
        done = subprocess.run([KJOINT, *words], cwd=self.folder, capture_output=True, text=True,
                              env={**os.environ, **environment}, timeout=1200, check=False)
        self.assertEqual(code, done.returncode, done.stdout + done.stderr)
        return done

    def deck_with(self, old, new):
        text = self.starter.read_text()
        self.assertIn(old, text)
        self.starter.write_text(text.replace(old, new, 1))


class Usage(Program):
    def test_without_words_it_shows_the_help(self):
        done = self.kjoint()
        self.assertIn("usage: kjoint COMMAND", done.stdout)
        self.assertEqual("", done.stderr)

    def test_version_is_that_of_the_project(self):
        version = os.environ.get("KJOINT_VERSION")
        self.assertEqual(f"kjoint {version}\n", self.kjoint("--version").stdout)
        self.assertRegex(self.kjoint("--version", "--verbose").stdout, rf"^kjoint {version}\nkernels \S+\n$")

    def test_every_command_of_the_help_has_a_help(self):
        lines = self.kjoint("help").stdout.split("Options of")[0].splitlines()
        commands = [line.split()[0] for line in lines if re.match(r"   \S", line)]
        self.assertIn("run", commands)
        for command in commands:
            self.assertIn(f"usage: kjoint {command}", self.kjoint("help", command).stdout)

    def test_unknown_words_are_usage_errors_with_a_guess(self):
        self.assertIn('did you mean "run"', self.kjoint("rum", code=2).stderr)
        done = self.kjoint("run", "a", "--untill", "1", code=2)
        self.assertIn('did you mean "--until"', done.stderr)
        self.assertEqual("", done.stdout)

    def test_tables_are_printed(self):
        types = [line.split()[:2] for line in self.kjoint("list", "joints").stdout.splitlines()[1:]]
        self.assertEqual([str(i) for i in range(1, len(types) + 1)], [number for number, _ in types])
        self.assertIn(["7", "oldham"], types)
        self.assertIn("/PROP/TYPE33", self.kjoint("list", "keywords").stdout)
        self.assertIn("rigid_body/orientation", self.kjoint("list", "channels").stdout)
        self.kjoint("list", "nothing", code=2)

    def test_tables_and_help_are_json_too(self):
        def told(*words):
            answer = json.loads(self.kjoint(*words, "--json").stdout)
            self.assertEqual(0, answer["exit_code"])
            return answer

        joints = {row["name"]: row for row in told("list", "joints")["joints"]}
        self.assertEqual((7, ["tx"], "mean"), (joints["oldham"]["type"], joints["translational"]["free"],
                                               joints["revolute"]["frame"]))
        for table, key in (("keywords", "keyword"), ("channels", "channel")):
            lines = self.kjoint("list", table).stdout.splitlines()[1:]
            self.assertEqual([line.split()[0].lstrip("/") for line in lines],
                             [row[key].lstrip("/") for row in told("list", table)[table]])
        commands = [row["command"] for row in told("help")["commands"]]
        self.assertIn("check", commands)
        for command in commands:
            page = self.kjoint("help", command).stdout
            for option in told("help", command)["options"]:
                self.assertIn(option["name"], page)
        self.assertIn({"card": 1, "first": 11, "last": 20, "name": "dir", "kind": "a", "dimension": "number",
                       "meaning": "direction: X, Y, Z"}, told("help", "/GRAV")["fields"])
        self.assertIn("cause", told("help", "KJ-0078"))
        for words in (["list", "nothing"], ["help", "nothing"], ["help", "/NOTHING"], ["convert", "none"]):
            done = subprocess.run([KJOINT, *words, "--json"], capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, json.loads(done.stdout)["exit_code"])
            self.assertGreater(done.returncode, 0)
        self.assertEqual("a.h5", told("convert", CASE / "REV01T01", "-o", "a.h5")["history"])

    def test_messages_are_explained(self):
        self.assertIn("cause", self.kjoint("help", "KJ-0078").stdout)
        self.assertIn("cause", self.kjoint("help", "kj-0078").stdout)
        self.kjoint("help", "KJ-12ab", code=2)


class Run(Program):
    def test_a_run_ends_with_a_summary_and_a_history(self):
        done = self.kjoint("run", "--legacy", "REV01_0000.rad")
        for word in ("NORMAL TERMINATION", "cycles", "time step", "energy error", "slowest cost",
                     "joint-cycles/s", "REV01.h5"):
            self.assertIn(word, done.stdout)
        self.assertTrue((self.folder / "REV01.h5").exists())
        self.assertIn("NORMAL TERMINATION", self.kjoint("info", "REV01.h5").stdout)

    def test_formulations_are_chosen_by_name(self):
        plain = self.kjoint("run", "--json", "REV01_0000.rad", "-o", "a.h5")
        self.kjoint("run", "-q", "REV01_0000.rad", "-o", "b.h5", "--formulation", "consistent",
                    "--integrator", "split2", "--dt-rule", "safe")
        self.kjoint("diff", "a.h5", "b.h5", "--profile", "exact")
        # samples of the consistent formulation fall on their times, the end on Tstop
        self.assertEqual(0.0199, json.loads(plain.stdout)["time"])
        self.kjoint("run", "-q", "REV01_0000.rad", "-o", "c.h5", "--legacy")
        self.kjoint("run", "-q", "REV01_0000.rad", "-o", "d.h5", "--formulation", "legacy")
        self.kjoint("diff", "c.h5", "d.h5", "--profile", "exact")
        self.kjoint("diff", "a.h5", "c.h5", code=1)

    def test_names_that_do_not_go_together_are_refused(self):
        for words in (["--legacy", "--formulation", "consistent"], ["--formulation", "new"],
                      ["--integrator", "euler"], ["--dt-rule", "none"],
                      ["--legacy", "--dt-rule", "safe"], ["--legacy", "--integrator", "split2"]):
            self.kjoint("run", "REV01_0000.rad", *words, code=2)

    def test_a_smaller_scale_takes_more_cycles(self):
        cycles = [json.loads(self.kjoint("run", "--json", "REV01_0000.rad", "--dt-scale", scale)
                             .stdout)["cycles"] for scale in ("0.8", "0.2")]
        self.assertGreater(cycles[1], 3 * cycles[0])

    def test_an_energy_limit_ends_a_run_with_exit_1(self):
        done = self.kjoint("run", "--legacy", "REV01_0000.rad", "--energy-limit", "1e-9", code=1)
        self.assertIn("energy", done.stderr)
        self.assertIn("ERROR TERMINATION", done.stdout)
        self.assertIn("ERROR", self.kjoint("info", "REV01.h5").stdout)

    def test_a_loss_of_energy_counts_as_a_gain_does(self):
        # imposed displacement: T01 and kjoint lose up to 2 %, and never gain
        deck = CASE.parent / "IMD01" / "IMD01_0000.rad"
        self.kjoint("run", "--legacy", "-q", deck, "--energy-limit", "3")
        self.kjoint("run", "--legacy", "-q", deck, "--energy-limit", "1", code=1)

    def test_an_energy_that_is_not_a_number_passes_every_limit(self):
        # gravity on a mass of 1e200 kg: the square of its force is beyond the numbers
        self.deck_with("                 2.0      1003", "               1e200      1003")
        done = self.kjoint("run", "REV01_0000.rad", code=1)
        self.assertIn("not finite", done.stderr)

    def test_quiet_says_nothing(self):
        done = self.kjoint("run", "--legacy", "-q", "-i", "REV01_0000.rad", "-o", "a.h5")
        self.assertEqual(("", ""), (done.stdout, done.stderr))
        self.assertTrue((self.folder / "a.h5").exists())

    def test_json_is_one_object_on_stdout(self):
        done = self.kjoint("run", "--legacy", "--json", "REV01_0000.rad", "REV01_0001.rad")
        said = json.loads(done.stdout)
        self.assertEqual("NORMAL TERMINATION", said["status"])
        self.assertEqual(0, said["exit_code"])
        self.assertEqual(1, said["joints"])
        self.assertGreater(said["cycles"], 9)

    def test_a_pipe_gets_a_listing_line_every_print_cycles(self):
        """With -v; without, one at the start and every ten seconds, and as many in the file of --listing"""
        self.engine.write_text(self.engine.read_text().replace("/PRINT/-1000", "/PRINT/-100"))
        for words, least, most in ((["-v"], 5, 1000), ([], 1, 2), (["-q", "--listing", "list.txt"], 0, 0)):
            done = self.kjoint("run", "--legacy", "REV01_0000.rad", "--until", "1", *words)
            self.assertNotIn("\r", done.stderr)
            lines = re.findall(r"^ +\d+ +\d\.\d+E.* (?:node|body|joint) +\d+ .* %.*", done.stderr, re.M)
            self.assertTrue(least <= len(lines) <= most, done.stderr)
            if words == ["-v"]:
                listed = lines
        self.assertEqual((self.folder / "list.txt").read_text().splitlines()[1:], listed)
        self.kjoint("run", "--legacy", "REV01_0000.rad", "--listing", "REV01_0000.rad", code=2)

    def test_until_and_sample_stand_for_the_engine_deck(self):
        self.engine.unlink()
        done = self.kjoint("run", "--legacy", "REV01_0000.rad", code=2)
        self.assertIn("--until", done.stderr)
        done = self.kjoint("run", "--legacy", "REV01_0000.rad", "--until", "0.01", code=2)
        self.assertIn("--sample", done.stderr)
        done = self.kjoint("run", "--legacy", "--json", "REV01_0000.rad", "--until", "0.01",
                           "--sample", "0.002")
        self.assertEqual(0.01, json.loads(done.stdout)["t_stop"])
        self.assertIn(json.loads(done.stdout)["samples"], (6, 7))      # and the last state

    def test_until_keeps_the_rest_of_the_engine_deck(self):
        done = self.kjoint("run", "--legacy", "--json", "REV01_0000.rad", "--until", "0.0079")
        self.assertIn(json.loads(done.stdout)["samples"], (4, 5))      # /TFILE: 0.002

    def test_equal_runs_are_equal_bytes(self):
        for name in ("a.h5", "b.h5"):
            self.kjoint("run", "--legacy", "REV01_0000.rad", "--reproducible", "-o", name)
        self.assertEqual((self.folder / "a.h5").read_bytes(), (self.folder / "b.h5").read_bytes())

    def test_a_crlf_deck_gives_the_same_numbers(self):
        first = self.kjoint("run", "--legacy", "--json", "REV01_0000.rad").stdout
        self.starter.write_bytes(self.starter.read_bytes().replace(b"\n", b"\r\n"))
        second = self.kjoint("run", "--legacy", "--json", "REV01_0000.rad").stdout
        for key in ("cycles", "time", "time_step", "energy_error"):
            self.assertEqual(json.loads(first)[key], json.loads(second)[key])


class Trace(Program):
    """What --trace says of the bar on a hinge, against values worked out by hand."""

    DECK = SOURCE / "decks" / "revolute_pendulum_0000.rad"
    MASS, GRAVITY = 1.5, 9.81

    def trace(self, *words, ids="901,2", cycles="0:1", **how):
        return self.kjoint("run", self.DECK, "--until", "0.002", "--sample", "0.001", "--trace", ids,
                           "--trace-cycles", cycles, *words, **how)

    def records(self, *words, **how):
        """By kind and cycle; the last line is the summary."""
        *lines, summary = map(json.loads, self.trace("--json", *words, **how).stdout.splitlines())
        self.assertEqual(0, summary["exit_code"])
        return {(line["trace"], line["cycle"]): line for line in lines}

    def assert_near(self, wanted, got, tolerance):
        self.assertEqual(len(wanted), len(got))
        for a, b in zip(wanted, got):
            self.assertLessEqual(abs(a - b), tolerance, (wanted, got))

    def test_the_start(self):
        """Free fall under legacy. Under consistent the hinge bears the bar: F/m + F a^2/J = g, a = 0.5, J = 0.125"""
        borne = self.GRAVITY/(1/self.MASS + 0.5**2/0.125)
        for words, up in (([], borne), (["--legacy"], 0.0)):
            records = self.records(*words)
            self.assertEqual({("joint", 0), ("body", 0), ("joint", 1), ("body", 1)}, set(records))
            joint, body = records["joint", 0], records["body", 0]
            self.assertEqual(0.0, joint["time"])
            for name in ("rate", "friction"):
                self.assert_near([0.0]*6, joint[name], 1e-9)  # Kn 1e6 times rounding
            self.assert_near([0, -up, 0, 0, 0, 0], joint["force"], 2e-5*self.GRAVITY)
            self.assert_near([0, -up/1e6, 0, 0, 0, 0], joint["q"], 1e-9 if not up else 6e-6)
            self.assertEqual([(101, 1), (201, 2)], [(e["node"], e["carrier_id"]) for e in joint["ends"]])
            # axis of the hinge along y, towards the third node along z
            self.assert_near([0, 1, 0, 0, 0, 1, 1, 0, 0], joint["frame"], up/1e6 + 1e-12)
            self.assert_near([0.5, 0.0, 0.0], body["position"], up/1e6)
            self.assert_near([1, 0, 0, 0], body["attitude"], up/1e6)
            self.assert_near([0, 0, up/self.MASS - self.GRAVITY], body["acceleration"], 2e-5*self.GRAVITY)
            self.assert_near([0, 0, up - self.MASS*self.GRAVITY], body["force"], 2e-5*self.GRAVITY)
            self.assertEqual([901], body["joints"])

    def test_newton_holds_and_laws_add_up(self):
        for words in ([], ["--legacy"]):
            records = self.records(*words, cycles="5:6")
            for cycle in (5, 6):
                joint, body = records["joint", cycle], records["body", cycle]
                end = joint["ends"][1]
                self.assertGreater(end["force"][2], 0.0)      # the hinge holds the bar
                self.assert_near([self.MASS*a for a in body["acceleration"]],
                                 [f - w for f, w in zip(end["force"],
                                                        (0, 0, self.MASS*self.GRAVITY))], 1e-9)
                # about the centre, half a metre from the hinge; inertia 0.125
                self.assertLess(abs(end["moment"][1] - 0.5*end["force"][2]), 1e-6*end["force"][2])
                self.assertLess(abs(end["moment"][1] - 0.125*body["omega_dot"][1]), 1e-9)
                self.assert_near([-f for f in joint["ends"][0]["force"]], end["force"], 0.0)
                if words:
                    self.assertIsNone(joint["elastic"])
                    self.assertLess(joint["velocity_time"], joint["time"])
                    continue
                self.assert_near([sum(laws) for laws in zip(joint["elastic"], joint["damping"],
                                                            joint["friction"])],
                                 joint["force"], 1e-12)
                self.assert_near([1.0e6*q for q in joint["q"][:3]], joint["elastic"][:3], 1e-9)

    def test_the_bound_is_that_of_the_bar_about_its_length(self):
        joint = self.records()["joint", 0]                    # Kn 1e6 N m/rad on 0.002 kg m^2
        self.assertEqual("safe", joint["bound_rule"])
        self.assertLess(abs(joint["bound"]/(2.0/(1.0e6/0.002)**0.5) - 1.0), 0.004)
        self.assertEqual("nodal", self.records("--legacy")["joint", 0]["bound_rule"])

    def test_a_node_moves_with_its_body(self):
        for words in ([], ["--legacy"]):
            node = self.records(*words, ids="203", cycles="6:6")["node", 6]
            lead = node["lead"]
            self.assertEqual(("body", 2), (lead["carrier"], lead["carrier_id"]))
            self.assert_near([-0.5, 0.0, 0.1],
                             [a - b for a, b in zip(node["position"], lead["position"])],
                             1e-6 if words else 5e-6)         # the hinge bears the bar: it starts turned by 3e-6
            w = lead["omega"][1]                              # v = v0 + w x r
            self.assert_near([0.1*w, 0.0, 0.5*w],
                             [a - b for a, b in zip(node["velocity"], lead["velocity"])], 1e-8)

    def test_tables_fit_a_terminal_and_stand_alone_when_quiet(self):
        for words in (["-q"], ["-q", "--legacy"]):
            lines = self.trace(*words, ids="901,2,203", cycles="3:4").stdout.splitlines()
            self.assertLessEqual(max(map(len, lines)), 80)
            heads = [line.split()[:4] for line in lines if " cycle " in line]
            self.assertEqual([[kind, name, "cycle", cycle] for cycle in "34"
                              for kind, name in (("joint", "901"), ("body", "2"), ("node", "203"))],
                             heads)
            self.assertEqual(2, sum(" q       rate    elastic" in line for line in lines))

    def test_compliant_is_traced(self):
        lines = self.trace("-q", "--integrator", "compliant", ids="901").stdout.splitlines()
        self.assertEqual(2, sum(line.startswith("joint 901   cycle ") for line in lines))

    def test_springs_are_traced(self):
        self.DECK = SOURCE / "decks" / "spring_mount_0000.rad"
        hint = self.trace(ids="999999", code=2).stderr
        spring = re.search(r"springs (\d+)", hint)[1]
        self.assertIn(("spring", 0), self.records(ids=spring, cycles="0:0"))

    def test_the_history_is_the_same(self):
        for words in ([], ["--legacy"]):
            self.trace("-q", *words, "-o", "a.h5", cycles="3:40")
            self.kjoint("run", self.DECK, "--until", "0.002", "--sample", "0.001", "-q", *words,
                        "-o", "b.h5")
            self.kjoint("diff", "a.h5", "b.h5", "--profile", "exact")

    def test_what_is_not_there_is_a_usage_error(self):
        said = self.trace(ids="7", code=2).stderr
        self.assertIn("no joint, spring, body or node 7", said)
        self.assertIn("joints 901; bodies 1, 2; nodes 100", said)
        for ids, cycles, words in (("901,x", "0:1", "ids"), ("901,", "0:1", "ids"),
                                   ("901", "3", "A:B"), ("901", "5:2", "A <= B")):
            self.assertIn(words, self.trace(ids=ids, cycles=cycles, code=2).stderr)
        self.kjoint("run", self.DECK, "--trace-cycles", "0:1", code=2)
        self.trace("--islands", code=2)
        self.assertIn("nothing was traced", self.trace(cycles="90000:90001").stderr)


class Check(Program):
    """What `kjoint check` tells of joints with limits: the numbers typed in the decks."""

    def report(self, deck):
        deck = SOURCE / deck
        report = json.loads(self.kjoint("check", "--json", deck).stdout)
        return report["joints"][0], self.kjoint("check", deck).stdout

    def test_stops_and_friction_of_the_door(self):
        joint, text = self.report("decks/door_hinge_0000.rad")
        self.assertEqual([{"direction": "rx", "lower_stop": -0.02, "upper_stop": 1.57, "combined": False,
                           "stop_stiffness": 4e4, "friction": 4.0, "friction_function": 0,
                           "friction_stiffness": 4e4}], joint["limits"])
        self.assertIsNone(joint["locked_from"])
        self.assertRegex(text, r"hinge \(901\)  rx +-2\.0000E-02 to 1\.5700E\+00 +4\.0000E\+04 +4\.0000E\+00 +4\.0000E\+04")

    def test_combined_stops_of_the_knee(self):
        joint, text = self.report("decks/knee_0000.rad")
        self.assertEqual([("rx", False), ("ry", True), ("rz", True)],
                         [(row["direction"], row["combined"]) for row in joint["limits"]])
        self.assertEqual({None}, {row["friction"] for row in joint["limits"]})
        self.assertIn("combined: one circle or sphere", text)

    def test_a_lock_and_a_function(self):
        joint, text = self.report("tests/parity45/KREV4/KREV4_0000.rad")
        self.assertEqual((0.1, None, []), (joint["locked_from"], joint["locked_to"], joint["limits"]))
        self.assertRegex(text, r"900\)? +locked from 1\.0000E-01")
        joint, text = self.report("tests/parity45/KTRA4/KTRA4_0000.rad")
        self.assertEqual(41, joint["limits"][0]["friction_function"])
        self.assertIn("6.0000E+00 * f 41", text)

    def test_the_nodal_rule_is_that_of_legacy(self):
        # two pieces of code; the first step of legacy, 0.9 of the rule, is that of OpenRadioss
        def compare(deck):
            rule = json.loads(self.kjoint("check", "--json", deck).stdout)["nodal_step"]
            first = json.loads(self.kjoint("run", "--legacy", "--json", deck, "--until", "1e-9").stdout)
            # its 0.9 has 32 bits
            self.assertLess(abs(first["time_step"]/(0.9*rule) - 1), 3e-8, deck)
            return rule

        for case in ("parity/FRE01", "parity/SPH01", "parity45/KREV1", "parity45/KFRE1", "springs/S402", "springs/S804",
                     "springs/P21", "springs/H441"):
            compare(SOURCE / "tests" / case / f"{case.split('/')[1]}_0000.rad")
        by_inertia = compare("REV01_0000.rad")
        self.deck_with("0.0262512168304855670.0473428526495739760.056405930519940466",
                       "                1e12                1e12                1e12")
        self.deck_with("                 0.3                 0.2                0.25",
                       "                1e12                1e12                1e12")
        by_mass = compare("REV01_0000.rad")
        self.assertGreater(by_mass, 1.01*by_inertia)
        # a third piece of code: consistent takes equal steps that are no longer than 0.9 of it
        told = json.loads(self.kjoint("run", "--json", "REV01_0000.rad", "--dt-rule", "nodal", "--until", "1", "--sample",
                                      "1", "-o", "nodal.h5").stdout)
        self.assertAlmostEqual(math.ceil(1/(0.9*by_mass)), 1/told["time_step"], 6)

    def test_joints_without_limits_have_no_such_table(self):
        self.assertNotIn("friction", self.kjoint("check", "REV01_0000.rad").stdout)

    def test_fields_of_a_joint_are_set_in_letters_of_either_case(self):
        deck = SOURCE / "decks" / "slider_crank_0000.rad"
        for name in ("Kn", "kn", "KN"):
            told = json.loads(self.kjoint("check", "--json", deck, "--joint", f"901.{name}=3e8").stdout)
            self.assertEqual(3e8, told["joints"][0]["blocking_translation"])
        self.assertIn('did you mean "Kn"?', self.kjoint("check", deck, "--joint", "901.Km=1", code=2).stderr)
        # an integer is no number to set: the type of a joint decides which fields it has
        self.assertIn("has no number type", self.kjoint("check", deck, "--joint", "901.type=3", code=2).stderr)

    def test_several_decks_are_checked_in_one_go(self):
        """An engine deck belongs to the starter deck before it; the exit code is the largest."""
        decks = [SOURCE / "decks" / f"{name}_0000.rad" for name in ("slider_crank", "knee", "door_hinge")]
        door_engine = SOURCE / "decks" / "door_hinge_0001.rad"
        self.deck_with("           1000000.0 ", "           1000O00.0 ")
        words = [decks[0], decks[1], "REV01_0000.rad", "REV01_0001.rad", decks[2], door_engine]
        done = self.kjoint("check", *words, "--junit", "all.xml", code=2)
        titles = ["slider-crank at 3000/min", "knee with combined stops", "door"]
        at = [done.stdout.index(title) for title in titles]
        self.assertEqual(sorted(at), at)
        self.assertIn("REV01_0000.rad:", done.stderr)
        self.assertEqual("4 decks, 1 refused", done.stdout.splitlines()[-1])
        suite = xml.etree.ElementTree.parse(self.folder / "all.xml").getroot()
        self.assertEqual(("4", "1"), (suite.get("tests"), suite.get("failures")))
        failed = [case.get("name") for case in suite if case.find("failure") is not None]
        self.assertEqual(["REV01_0000.rad"], failed)
        self.assertIn("1000O00.0", suite[2].find("failure").text)
        told = json.loads(self.kjoint("check", "--json", *words, code=2).stdout)
        self.assertEqual([0, 0, 2, 0], [deck["exit_code"] for deck in told["decks"]])
        self.assertEqual(2, told["exit_code"])
        self.assertEqual("main bearing (901)", told["decks"][0]["joints"][0]["name"])
        self.kjoint("check", decks[2], door_engine)             # two: a deck and its engine deck
        self.kjoint("check", "REV01_0000.rad", "none_0000.rad", code=3)
        self.kjoint("check", "REV01_0000.rad", "--junit", "REV01_0000.rad", code=2)

    def test_warnings_count_where_they_are_to(self):
        # text behind the last field of a card is one
        clean = self.kjoint("check", "--json", "--werror", "REV01_0000.rad").stdout
        self.assertEqual(0, json.loads(clean)["warnings"])
        lines = self.starter.read_text().splitlines(keepends=True)
        at = next(i for i, line in enumerate(lines) if line.startswith("/SPRING/")) + 1
        while lines[at].startswith("#"):
            at += 1
        lines[at] = lines[at].rstrip("\n").ljust(70) + "odd\n"
        self.starter.write_text("".join(lines))
        self.assertEqual(1, json.loads(self.kjoint("check", "--json", "REV01_0000.rad").stdout)["warnings"])
        self.kjoint("check", "--werror", "REV01_0000.rad", "--junit", "one.xml", code=2)
        self.assertEqual("1", xml.etree.ElementTree.parse(self.folder / "one.xml").getroot().get("failures"))

    def test_what_was_left_out_is_counted(self):
        # 300 elements that nothing defines: 200 warnings and notes are kept, errors to 400
        text = self.starter.read_text()
        request = "/TH/SPRING/77\nmany\nDEF\n" + "".join(f"{i:10}\n" for i in range(50001, 50601))
        self.starter.write_text(text.replace("/END", request + "/END"))
        told = json.loads(self.kjoint("check", "--json", "REV01_0000.rad", code=2).stdout)
        self.assertEqual(600, told["errors"])
        self.assertEqual(600, len(told["findings"]) + told["findings_left_out"])
        self.assertGreater(told["findings_left_out"], 0)

    def test_the_length_of_a_run_is_told(self):
        # REV01 to 0.0199 with samples every 0.002: one at 0 and ten after it
        report = json.loads(self.kjoint("check", "--json", "REV01_0000.rad").stdout)
        run = json.loads(self.kjoint("run", "--json", "REV01_0000.rad").stdout)
        self.assertAlmostEqual(11, report["samples"], delta=1)
        self.assertGreater(run["wall_start"], 0)               # the start is a part of the solver's time
        self.assertGreater(run["wall_solve"], run["wall_start"])
        self.assertLess(abs(report["cycles"] / run["cycles"] - 1), 0.2)
        self.assertLess(report["seconds"], 60)
        self.assertRegex(self.kjoint("check", "REV01_0000.rad").stdout,
                         r"run: about \d+ cycles, 11 samples of \d+ numbers; \d+\.\d s at the pace")

    def test_what_stops_a_run_at_once_stops_check(self):
        # KJOINT2 with Kn 0, and nothing that limits the step
        deck = SOURCE / "tests" / "cli" / "kn0_0000.rad"
        for words in ([], ["--legacy"]):
            self.assertIn("nothing limits that", self.kjoint("check", "-q", deck, *words, code=1).stderr)
            self.assertIn("nothing limits that", self.kjoint("run", "-q", deck, *words, code=1).stderr)
        self.assertEqual(1, json.loads(self.kjoint("check", "--json", deck, code=1).stdout)["exit_code"])

    def test_a_run_of_years_is_refused(self):
        for words in (["--sample", "1e-15"], ["--until", "1e14"], ["--until", "1e14", "--legacy"]):
            for command in ("check", "run"):
                said = self.kjoint(command, "-q", "REV01_0000.rad", *words, code=2).stderr
                self.assertRegex(said, r"KJ-9079.* would take +\d\.\dE\+\d\d cycles")
        # forced, it runs: until its listing is read
        run = subprocess.Popen([KJOINT, "run", "--force", "REV01_0000.rad", "--until", "1e14"],
                               cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        lines = [run.stderr.readline() for _ in range(2)]
        run.kill()
        run.communicate()
        self.assertRegex("".join(lines), r"takes about +\d\.\dE\+\d\d cycles, at this pace .* years")

    def test_findings_that_are_left_out_are_counted(self):
        # 1000 nodes with a letter in a coordinate
        self.deck_with("/NODE\n", "/NODE\n" + "".join(f"{n:10}                 X.0\n" for n in range(5000, 6000)))
        said = json.loads(self.kjoint("check", "--json", "REV01_0000.rad", code=2).stdout)
        self.assertEqual(1000, said["errors"])
        errors = [f for f in said["findings"] if f["severity"] == "error"]
        self.assertEqual(1000, len(errors) + said["findings_left_out"])


    def test_numbers_that_are_none_pass_no_limit(self):
        # the kinetic energy of a free node of 1e200 kg at 1e200 m/s overflows; two formulations have no limit of the energy
        self.deck_with("/END", "/NODE\n" + f"{90001:10}{'1e200':>20}{0.0:20}{0.0:20}\n" +
                       "/ADMAS/5/77\nfar\n               1e200     90001\n/GRNOD/NODE/90002\nfar\n     90001\n"
                       "/INIVEL/TRA/90003\nfast\n" + f"{'1e200':>20}{0.0:20}{0.0:20}{90002:10}\n/END")
        for words in ((), ("--legacy",), ("--integrator", "compliant"), ("--energy-limit", "1e300")):
            said = self.kjoint("run", "-q", *words, "REV01_0000.rad", code=1).stderr
            self.assertRegex(said, r"not finite any more in cycle \d+", words)

    def test_a_falling_curve_is_named_when_it_ends_a_legacy_run(self):
        # moment 100 N m per rad up to 0.1 rad, then falling; the arm swings past that
        text = self.starter.read_text()
        block = text[text.index("/PROP/"):]
        kn = block.splitlines()[4]
        self.deck_with(kn, kn[:20] + "                 1.0         7")
        self.deck_with("/END", "/FUNCT/7\nfalls\n" + "".join(f"{x:20}{y:20}\n" for x, y in (
            (-1.0, -1.0), (0.0, 0.0), (0.001, 0.1), (1.0, -1000.0))) + "/END")
        self.engine.write_text(self.engine.read_text().replace("\n0.0199\n", "\n5.0\n"))
        said = self.kjoint("run", "--legacy", "REV01_0000.rad", code=1).stderr
        self.assertRegex(said, r"not finite any more in cycle \d+")
        self.assertNotIn("--dt-scale", said)
        self.assertIn("has a stiffness curve that the legacy scheme cannot bear", said)


class Diff(Program):
    """The verdicts of diff on whole files; its numbers are tested in tests/diff and tests/unit."""

    def setUp(self):
        super().setUp()
        self.t01 = CASE / "REV01T01"
        self.kjoint("run", "--legacy", "-q", CASE / "REV01_0000.rad", "-o", "a.h5")

    def test_a_history_is_the_same_as_itself(self):
        done = self.kjoint("diff", "a.h5", "a.h5", "--profile", "exact")
        self.assertRegex(done.stdout.splitlines()[-1], r"^SAME: \d+ channels")
        self.assertRegex(self.kjoint("diff", self.t01, "a.h5").stdout, r"SAME: \d+ channels")

    def test_another_run_is_different(self):
        self.kjoint("run", "--legacy", "-q", "REV01_0000.rad", "-o", "b.h5")
        last = self.kjoint("diff", "a.h5", "b.h5", code=1).stdout.splitlines()[-1]
        self.assertRegex(last, r"^DIFFERENT: \d+ of \d+ channels")
        self.kjoint("diff", "a.h5", "b.h5", "--window", "0:0.01", "--profile", "solver")

    def test_the_verdict_has_other_forms(self):
        done = self.kjoint("diff", self.t01, "a.h5", "--json", "--junit", "verdict.xml",
                           "--metrics", "max,nrmse")
        self.assertEqual((0, "SAME"), tuple(json.loads(done.stdout)[key] for key in ("exit_code", "verdict")))
        suites = xml.etree.ElementTree.parse(self.folder / "verdict.xml").getroot()
        self.assertGreater(len(list(suites.iter("testcase"))), 20)

    def test_wrong_options_and_files_are_told_apart(self):
        self.kjoint("diff", "a.h5", "a.h5", "--profile", "nothing", code=2)
        self.kjoint("diff", "a.h5", "a.h5", "--window", "1:0", code=2)
        self.kjoint("diff", "a.h5", "a.h5", "--metrics", "beauty", code=2)
        self.kjoint("diff", "a.h5", "a.h5", "--rtol", "-1", code=2)
        self.kjoint("diff", "a.h5", "a.h5", "--rtol", "0")           # the smallest there is
        self.kjoint("diff", "a.h5", "nowhere.h5", code=3)
        self.kjoint("diff", "a.h5", "REV01_0000.rad", code=3)
        self.kjoint("diff", "a.h5", "a.h5", "--junit", "no/where.xml", code=3)

    def test_a_t01_converts_to_a_history(self):
        self.kjoint("convert", self.t01)
        self.kjoint("diff", self.t01, "REV01T01.h5", "--profile", "exact")
        self.kjoint("convert", self.t01, "-o", "c.h5")
        self.assertIn("joint/force", self.kjoint("info", "c.h5").stdout)
        self.kjoint("convert", "nowhere", code=3)
        self.assertIn("a history of kjoint already", self.kjoint("convert", "c.h5", code=3).stderr)


class Errors(Program):
    def test_missing_files_are_file_errors(self):
        self.assertIn("nowhere_0000.rad",
                      self.kjoint("run", "--legacy", "nowhere_0000.rad", code=3).stderr)
        self.kjoint("run", "--legacy", "REV01_0000.rad", "nowhere_0001.rad", code=3)
        self.kjoint("info", "nowhere.h5", code=3)
        self.kjoint("info", "REV01_0000.rad", code=3)

    def test_a_folder_that_cannot_be_written_is_a_file_error(self):
        self.kjoint("run", "--legacy", "REV01_0000.rad", "-o", "no/where.h5", code=3)

    def test_a_letter_in_a_number_is_pointed_at(self):
        self.deck_with("           1000000.0 ", "           1000O00.0 ")
        done = self.kjoint("run", "--legacy", "REV01_0000.rad", code=2)
        place = re.search(r"REV01_0000\.rad:(\d+):(\d+)-(\d+)", done.stderr)
        self.assertTrue(place, done.stderr)
        line = int(place.group(1))
        card = self.starter.read_text().splitlines()[line - 1]
        first, last = int(place.group(2)), int(place.group(3))
        self.assertEqual("1000O00.0", card[first - 1:last])
        self.assertIn("^" * 9, done.stderr)
        self.assertRegex(done.stderr, r"error\[KJ-\w{4}\]: ")
        self.assertEqual("", done.stdout)
        self.assertFalse((self.folder / "REV01.h5").exists())

    def test_a_bad_deck_leaves_the_old_history_alone(self):
        (self.folder / "REV01.h5").write_text("old")
        self.deck_with("       900       101       201", "       900       101       299")
        self.kjoint("run", "--legacy", "REV01_0000.rad", code=2)
        self.assertEqual("old", (self.folder / "REV01.h5").read_text())

    def test_a_deck_cut_in_a_joint_property_is_an_error(self):
        for case in ("REV01", "UNI01"):
            text = (SOURCE / "tests" / "parity" / case / f"{case}_0000.rad").read_text()
            first = text.index("/PROP/")
            last = text.index("\n/", first) + 1
            whole = text[:first] + text[last:text.index("/END")] + text[first:last]
            block = len(whole) - len(text[first:last])
            self.starter.write_text(whole)             # no /END, as Radioss takes it
            self.kjoint("check", "-q", "--until", "1", "--sample", "1", "REV01_0000.rad")
            lines = [block + i for i, c in enumerate(whole[block:]) if c == "\n"]
            # after the header or a card, at the end of a line without its end, in the last card
            for cut in [i + 1 for i in lines[1:-1]] + lines[1:] + [lines[-1] - 1, lines[-1] - 9]:
                self.starter.write_text(whole[:cut])
                said = self.kjoint("check", "-q", "--until", "1", "--sample", "1", "REV01_0000.rad", code=2)
                self.assertIn("KJ-9070", said.stderr, f"{case} cut at {cut - block}")

    def test_includes_end(self):
        for i in range(31):
            (self.folder / f"{i}.inc").write_text(f"#include {i + 1}.inc\n" * 2)
        (self.folder / "31.inc").write_text("# nothing\n")
        self.deck_with("/END", "#include 0.inc\n/END")
        self.assertIn("more than 10000 files", self.kjoint("check", "REV01_0000.rad", code=3).stderr)

    def test_what_is_no_text_of_lines_is_not_read(self):
        deck, engine = self.starter.read_bytes(), self.engine.read_bytes()
        for path, whole in ((self.starter, deck), (self.engine, engine)):
            text = whole.decode()
            for wrong, said in ((text.encode("utf-16"), "UTF-16"), (text.encode("utf-16-le"), "UTF-16"),
                                (gzip.compress(whole), "gzip"), (whole.replace(b"\n", b"\r"), "end in CR")):
                path.write_bytes(wrong)
                self.assertIn(said, self.kjoint("check", "REV01_0000.rad", code=3).stderr)
            # a byte order mark is none of the first line, here /RUN
            path.write_bytes(b"\xef\xbb\xbf" + whole)
            self.assertEqual("", self.kjoint("check", "REV01_0000.rad").stderr)
            path.write_bytes(whole)
        self.engine.write_bytes(b"\xef\xbb\xbf" + engine[engine.index(b"/RUN"):])
        self.assertEqual("", self.kjoint("check", "REV01_0000.rad").stderr)

    def test_what_is_no_regular_file_is_not_read(self):
        os.mkfifo(self.folder / "pipe.inc")
        self.deck_with("/END", "#include pipe.inc\n/END")
        self.assertIn("no regular file", self.kjoint("check", "REV01_0000.rad", code=3).stderr)
        for words in (["pipe.inc", "REV01_0001.rad"], ["/dev/zero", "REV01_0001.rad"]):
            self.assertIn("no regular file", self.kjoint("check", *words, code=3).stderr)

    def test_an_excerpt_of_a_long_card_is_cut(self):
        long = "7" * 3000000
        self.deck_with("/END", f"/RBODY/{long}x\n/{long}\n{long} {long}\n/END")
        self.assertLess(len(self.kjoint("check", "REV01_0000.rad", code=2).stderr), 20000)
        self.assertLess(len(self.kjoint("check", "--json", "REV01_0000.rad", code=2).stdout), 20000)

    def test_json_gives_findings_as_objects(self):
        self.deck_with("       900       101       201", "       900       101       299")
        done = self.kjoint("run", "--legacy", "--json", "REV01_0000.rad", code=2)
        errors = [f for f in json.loads(done.stdout)["findings"] if f["severity"] == "error"]
        self.assertTrue(errors[0]["file"].endswith("REV01_0000.rad"))
        self.assertEqual([28, 30], [errors[0]["first"], errors[0]["last"]])

    def test_unknown_keywords_are_errors_until_they_are_ignored(self):
        self.deck_with("/END", "/NONSENSE/1\ntitle\n/END")
        self.assertIn("NONSENSE", self.kjoint("run", "--legacy", "REV01_0000.rad", code=2).stderr)


class Streams(Program):
    """Output that does not arrive is an error of a file, whatever the command."""

    COMMANDS = (["--version"], ["help"], ["help", "run"], ["help", "KJ-0078"], ["list", "joints"],
                ["list", "keywords"], ["list", "channels"], ["check", "REV01_0000.rad"],
                ["check", "--json", "REV01_0000.rad"], ["run", "REV01_0000.rad", "-o", "b.h5"],
                ["run", "--json", "REV01_0000.rad", "-o", "b.h5"],
                ["run", "-q", "REV01_0000.rad", "-o", "b.h5", "--trace", "900"],
                ["info", "a.h5"], ["diff", "a.h5", "a.h5"], ["diff", "--json", "a.h5", "a.h5"],
                ["convert", CASE / "REV01T01"],
                ["study", "REV01_0000.rad", "--scales", "0.9", "--stiffness", "0.1"])

    def setUp(self):
        super().setUp()
        self.kjoint("run", "-q", "REV01_0000.rad", "-o", "a.h5")

    def with_stdout(self, words, place, code):
        done = subprocess.run(["sh", "-c", f'exec "$@" >{place}', "sh", KJOINT, *map(str, words)],
                              cwd=self.folder, capture_output=True, text=True, timeout=1200,
                              check=False)
        self.assertEqual(code, done.returncode, (words, done.stderr))
        return done.stderr

    def test_a_full_stdout_is_a_file_error(self):
        for words in self.COMMANDS:
            said = self.with_stdout(words, "/dev/full", 3)
            self.assertIn("cannot write the output: No space left on device", said)
        # the run itself went well
        self.kjoint("diff", "a.h5", "b.h5", "--profile", "exact")

    def test_a_worse_exit_code_stays(self):
        self.kjoint("run", "-q", "REV01_0000.rad", "-o", "c.h5", "--dt-scale", "0.4")
        self.with_stdout(["diff", "a.h5", "c.h5", "--profile", "exact"], "/dev/full", 1)
        self.with_stdout(["list", "nothing"], "/dev/full", 2)

    def test_a_closed_stdout_takes_no_file_of_ours(self):
        said = self.with_stdout(["run", "REV01_0000.rad", "-o", "c.h5"], "&-", 3)
        self.assertIn("cannot write the output", said)
        self.kjoint("diff", "a.h5", "c.h5", "--profile", "exact")
        self.with_stdout(["run", "-q", "REV01_0000.rad", "-o", "d.h5"], "&- 2>&- <&-", 0)
        self.kjoint("diff", "a.h5", "d.h5", "--profile", "exact")

    def test_a_full_stderr_changes_nothing(self):
        self.with_stdout(["run", "REV01_0000.rad", "-o", "c.h5"], "/dev/null 2>/dev/full", 0)
        self.with_stdout(["run", "nowhere_0000.rad"], "/dev/null 2>/dev/full", 3)

    def test_a_text_file_that_does_not_arrive_is_an_error(self):
        # no file may grow beyond 512 bytes, and nobody ends the program for it
        for words in (["diff", "a.h5", "a.h5", "--junit", "verdict.xml"],
                      ["study", "-q", "REV01_0000.rad", "--scales", "0.9", "--stiffness", "0.1"]):
            done = subprocess.run(["sh", "-c", 'trap "" XFSZ; ulimit -f 1; exec "$@"', "sh", KJOINT,
                                   *words], cwd=self.folder, capture_output=True, text=True,
                                  timeout=1200, check=False)
            self.assertEqual(3, done.returncode, done.stdout + done.stderr)
            self.assertIn("File too large", done.stderr)


class Learn(Program):
    """`kjoint help /KEYWORD` and `kjoint new`."""

    def test_every_keyword_that_is_read_has_a_page(self):
        rows = [line.split() for line in self.kjoint("list", "keywords").stdout.splitlines()[1:]]
        read = [row[0] for row in rows if row[1] == "read"]
        self.assertGreater(len(read), 60)
        for name in read:
            page = self.kjoint("help", name).stdout
            self.assertTrue(page.startswith(name + ": "), name)
            self.assertIn("\n" + name, page)              # the header of a block
        # and each that is read in some way shows a block of a shipped deck, which passes `kjoint check`
        shown = set()
        for row in rows:
            if row[1] in ("read", "aside", "full"):
                page = self.kjoint("help", row[0]).stdout
                deck, block = re.search(r"From (\w+)_0000.rad \(kjoint new \w+\):\n\n((?s:.*))$", page).groups()
                path = next((SOURCE / "decks").glob(f"**/{deck}_0000.rad"))
                self.assertIn(block.strip(), path.read_text(), row[0])
                shown.add(path)
        self.assertGreater(len(shown), 5)
        for path in shown:
            full = ["--mechanism"] if path.parent.name == "full" else []
            self.kjoint("check", *(full or ["--werror"]), path)
        grav = self.kjoint("help", "/grav").stdout
        self.assertRegex(grav, r"1 +11-20 +dir +direction: X, Y, Z")
        # names stand at the right end of their columns: dir ends in column 20, Ascale in 80
        ruler = next(line for line in grav.splitlines() if line.startswith("#"))
        self.assertEqual(("dir", "Ascale"), (ruler[17:20], ruler[74:80]))

    def test_an_example_is_a_block_of_a_deck_that_is_shipped(self):
        page = self.kjoint("help", "/RBODY").stdout
        deck = re.search(r"kjoint new (\w+)", page).group(1)
        block = page[page.index("kjoint new"):].split("\n\n", 1)[1].strip()
        self.assertIn(block, (SOURCE / "decks" / f"{deck}_0000.rad").read_text())

    def test_an_unknown_keyword_gets_its_neighbour(self):
        self.assertIn("did you mean /GRAV?", self.kjoint("help", "/GRAF", code=2).stderr)
        self.assertIn("did you mean /GRAV?", self.kjoint("help", "grav", code=2).stderr)

    def test_keywords_of_the_engine_deck_are_known(self):
        for word, meaning, status in (("/RUN", "run number and end of the run", "read"),
                                      ("/dt/noda", "factor and least value of the time step", "read"),
                                      ("/ANIM/DT", "animation files: not written", "has no effect here"),
                                      ("/IMPL", "implicit solution", "not supported")):
            page = self.kjoint("help", word).stdout
            self.assertTrue(page.startswith(f"{word.upper()} of the engine deck: {meaning}\n   {status}"), page)
            told = json.loads(self.kjoint("help", word, "--json").stdout)
            self.assertEqual((0, word.upper(), meaning), (told["exit_code"], told["keyword"], told["meaning"]))
        self.kjoint("help", "/RUNAWAY", code=2)

    def test_new_decks_are_those_that_are_shipped(self):
        kinds = [line.split()[0] for line in self.kjoint("new").stdout.splitlines()[1:]]
        shipped = sorted(p.name[:-9] for p in (SOURCE / "decks").glob("**/*_0000.rad"))
        self.assertEqual(shipped, sorted(kinds))
        self.kjoint("new", "door")                         # the begin of a name will do
        for end in ("_0000.rad", "_0001.rad"):
            self.assertEqual((SOURCE / "decks" / f"door_hinge{end}").read_bytes(),
                             (self.folder / f"door_hinge{end}").read_bytes())
        self.kjoint("check", "-q", "door_hinge_0000.rad")
        for word in ("four_bar", "slider_crank", *range(1, 10), "fixed"):       # number or name of a joint type
            self.folder.joinpath("rigid_weld_0000.rad").unlink(missing_ok=True)
            self.folder.joinpath("rigid_weld_0001.rad").unlink(missing_ok=True)
            deck = self.kjoint("new", str(word)).stdout.split()[-1]
            self.kjoint("check", "-q", deck)
            if isinstance(word, int):
                self.assertRegex((self.folder / deck).read_text(), rf"#     Type .*\n {{9}}{word} ")
        done = self.kjoint("new", "door_hinge", code=3)    # never over a file
        self.assertIn("there already", done.stderr)
        self.assertIn("did you mean", self.kjoint("new", "slidr_crank", code=2).stderr)

    def test_manual_pages_and_completions_know_every_command_and_option(self):
        subprocess.run([sys.executable, SOURCE / "tools" / "manual", KJOINT, self.folder / "share"], check=True)
        share = self.folder / "share"
        words = (share / "bash-completion/completions/kjoint").read_text()
        for name in ("run", "check", "diff", "new", "help"):
            page = gzip.decompress((share / f"man/man1/kjoint-{name}.1.gz").read_bytes()).decode()
            for option in re.findall(r"^ {3}(?:-\w, | {4})(--[\w-]+)", self.kjoint("help", name).stdout, re.M):
                self.assertIn(option.replace("-", "\\-"), page)
                self.assertIn(option, words)
        done = subprocess.run(["bash", "-c", f"source {share}/bash-completion/completions/kjoint; "
                               "COMP_WORDS=(kjoint run --kn-s); COMP_CWORD=2; _kjoint; echo ${COMPREPLY[@]}"],
                              capture_output=True, text=True, check=True)
        self.assertEqual("--kn-scale\n", done.stdout)

    def test_editors_know_every_keyword(self):
        subprocess.run([sys.executable, SOURCE / "tools" / "editors", KJOINT, self.folder], check=True)
        grammar = json.loads((self.folder / "vscode/radioss.tmLanguage.json").read_text())
        patterns = [(re.compile(row["match"]), row["name"]) for row in grammar["patterns"]]
        scopes = {}
        for deck in (SOURCE / "decks").glob("**/*_0000.rad"):
            for line in deck.read_text().splitlines():
                if line.startswith("/"):
                    scopes[line] = next(name for pattern, name in patterns if pattern.search(line))
        known = {row["keyword"]: row["status"] for row in
                 json.loads(self.kjoint("list", "keywords", "--json").stdout)["keywords"]}
        self.assertGreater(len(scopes), 150)
        for line, scope in scopes.items():
            name = next((line[:n] for n in range(len(line), 1, -1) if line[:n] in known), None)
            self.assertEqual({"noted": "comment.block", "unsupported": "invalid.illegal", None: "entity.name.tag"}
                             .get(known.get(name), "keyword.control"), scope, line)
        snippets = json.loads((self.folder / "vscode/snippets.json").read_text())
        grav = snippets["/GRAV"]["body"]
        self.assertEqual(("/GRAV/${1:1}", "${2:a title}", "$3"), (grav[0], grav[1], grav[-1]))
        self.assertLessEqual({name for name, status in known.items() if status in ("read", "full only", "aside")},
                             {one["prefix"] for one in snippets.values()})
        if shutil.which("vim"):                            # what vim makes of the lines of a deck
            deck = SOURCE / "decks" / "slider_crank_0000.rad"
            told = self.folder / "told"
            subprocess.run(["vim", "-u", "NONE", "-es", "--cmd", f"set rtp^={self.folder}/vim", "-c", "filetype plugin on",
                            "-c", "syntax on", "-c", f"e {deck}", "-c", f"redir! > {told}", "-c",
                            "g/^/echo synIDattr(synID(line('.'),1,1),'name') . ' ' . getline('.')[0:1]", "-c", "qa!"],
                           capture_output=True, check=False, timeout=60)
            groups = {tuple(line.split(None, 1)) for line in told.read_text().splitlines() if " /" in line or " #" in line}
            self.assertIn("radRead", {group for group, text in groups if text.startswith("/")})
            self.assertEqual({"radComment"}, {group for group, text in groups if text.startswith("#")})

    def test_the_pages_in_the_documents_are_those_of_the_program(self):
        cards = subprocess.run([sys.executable, SOURCE / "tools" / "cards", KJOINT, "-"],
                               capture_output=True, text=True, check=True).stdout
        self.assertEqual((SOURCE / "docs" / "cards.md").read_text(), cards,
                         "run tools/cards")


class Signals(Program):
    """A signal comes when a run says that it is under way: nothing hangs on how busy the machine is."""

    def check(self, formulation, number, code):
        words = [KJOINT, "run", "--formulation", formulation, "REV01_0000.rad", "--until", "1e4",
                 "--sample", "0.01"]
        run = subprocess.Popen(words, cwd=self.folder, stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True)
        for line in run.stderr:
            if re.match(r" +[1-9]\d* +\d\.\d+E", line):          # a listing line
                break
        run.send_signal(number)
        said, _ = run.communicate()
        self.assertEqual(code, run.returncode)
        self.assertIn("STOPPED BY USER", said)
        self.assertIn("STOPPED BY USER", self.kjoint("info", "REV01.h5").stdout)

    def test_a_second_signal_ends_at_once(self):
        # blocked, as nobody reads what it traces: the first signal waits for the run, the second not
        words = [KJOINT, "run", "-q", "REV01_0000.rad", "--until", "1e4", "--sample", "1", "--trace",
                 "900", "--trace-cycles", "0:1000000"]
        run = subprocess.Popen(words, cwd=self.folder, stdout=subprocess.PIPE)
        waiting = array.array("i", [0])
        while waiting[0] < 32768 and run.poll() is None:
            fcntl.ioctl(run.stdout, termios.FIONREAD, waiting)
            time.sleep(0.01)
        while run.poll() is None:
            run.send_signal(signal.SIGTERM)
            time.sleep(0.05)
        run.stdout.close()
        self.assertEqual(143, run.returncode)

    def test_interrupt_closes_the_history(self):
        self.check("legacy", signal.SIGINT, 130)

    def test_terminate_closes_the_history(self):
        self.check("consistent", signal.SIGTERM, 143)


class Terminal(Program):
    LINE = rb"\r *\d+\.\d %  t [^\r]*ETA[^\r]*"

    def on_a_terminal(self, pattern, count, *more, columns=0, **environment):
        """What a run prints on a terminal until a pattern has come some times; then it is
        interrupted. Also the seconds it took."""
        started = time.monotonic()
        pid, master = pty.fork()
        if pid == 0:
            fcntl.ioctl(0, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
            os.chdir(self.folder)
            words = [KJOINT, "run", "--legacy", "REV01_0000.rad", "--until", "1e4",
                     "--sample", "0.01", *more]
            os.execve(KJOINT, words, {**os.environ, "TERM": "xterm", **environment})
        said, sent = b"", False
        while True:
            try:
                part = os.read(master, 65536)
            except OSError:                            # as a terminal ends on Linux
                part = b""
            if not part:
                break
            said += part
            if not sent and len(re.findall(pattern, said)) >= count:
                os.kill(pid, signal.SIGINT)
                sent = True
        os.close(master)
        self.assertEqual(130, os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]))
        return said, time.monotonic() - started

    def test_a_line_is_written_over_at_most_five_times_a_second(self):
        said, seconds = self.on_a_terminal(self.LINE, 8)
        # the first after a second, the others at least 0.2 s apart
        self.assertLessEqual(len(re.findall(self.LINE, said)), 1 + (seconds - 1.0)/0.2)

    def shown(self, columns, *words):
        """What a terminal of so many columns gets of a command."""
        pid, master = pty.fork()
        if pid == 0:
            fcntl.ioctl(0, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
            os.chdir(self.folder)
            os.execve(KJOINT, [KJOINT, *words], {**os.environ, "TERM": "xterm"})
        said = b""
        while True:
            try:
                part = os.read(master, 65536)
            except OSError:
                part = b""
            if not part:
                break
            said += part
        os.close(master)
        os.waitpid(pid, 0)
        return said.decode()

    def test_tables_and_help_fit_the_terminal(self):
        def words_of(text):                                  # but for what the clock gives
            return re.sub(r"numbers;.*?at the pace", "numbers; at the pace", " ".join(text.split())).split()

        wide = self.kjoint("check", "REV01_0000.rad").stdout
        self.assertGreater(max(map(len, wide.splitlines())), 80)
        for columns in (60, 80):
            for words in (["help"], ["help", "run"], ["check", "REV01_0000.rad"], ["list", "joints"],
                          ["list", "channels"], ["list", "keywords"]):
                text = self.shown(columns, *words)
                longest = max(text.splitlines(), key=len)
                self.assertLessEqual(len(longest), columns, f"{words}: {longest}")
            text = self.shown(columns, "check", "REV01_0000.rad")
            self.assertEqual(words_of(wide), words_of(text))     # folded, nothing is lost

    def test_the_progress_line_does_not_wrap(self):
        for columns in (60, 80):
            said, _ = self.on_a_terminal(self.LINE, 3, "-o", f"{columns}.h5", columns=columns)
            lines = re.findall(rb"\r( *\d+\.\d %[^\r\x1b]*)", said)
            self.assertGreaterEqual(len(lines), 3, said)
            self.assertLess(max(map(len, lines)), columns)

    def test_a_dumb_terminal_gets_listing_lines(self):
        said, _ = self.on_a_terminal(rb"\n +[1-9]\d* +\d\.\d+E", 2, "-v", TERM="dumb")
        self.assertNotIn(b"\x1b", said)
        self.assertNotRegex(said, rb"\r(?!\n)")

    def test_colours_can_be_refused(self):
        self.deck_with("           1000000.0 ", "           1000O00.0 ")
        for environment, wanted in (({}, True), ({"NO_COLOR": "1"}, False),
                                    ({"TERM": "dumb"}, False)):
            pid, master = pty.fork()
            if pid == 0:
                os.chdir(self.folder)
                os.execve(KJOINT, [KJOINT, "run", "--legacy", "REV01_0000.rad"],
                          {**{k: v for k, v in os.environ.items() if k != "NO_COLOR"},
                           "TERM": "xterm", **environment})
            said = b""
            try:
                while part := os.read(master, 65536):
                    said += part
            except OSError:
                pass
            os.close(master)
            self.assertEqual(2, os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]))
            self.assertEqual(wanted, b"\x1b[" in said)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    KJOINT = str(pathlib.Path(sys.argv.pop(1)).resolve())
    unittest.main()
