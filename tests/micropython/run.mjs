// Runs exported programs in MicroPython: `node run.mjs CASES.json` prints one line per case. For a program on a scripted
// robot it is the ending with the times and powers of all motor commands; for networks it is the outputs for all inputs.
import { readFileSync } from "node:fs";
import { loadMicroPython } from "@micropython/micropython-webassembly-pyscript/micropython.mjs";

const HARNESS = `
import sys, json, math

sys.modules["umath"] = math

class Anything:
    def __getattr__(self, name):
        return Anything()

for name in ("pybricks", "pybricks.parameters", "pybricks.pupdevices", "pybricks.tools"):
    sys.modules[name] = Anything()

class Scripted:
    def __init__(self, readings):
        self.readings = readings
        self.requests = -1
        self.now_ms = 0
        self.events = []

    def set_motors(self, left, right):
        self.events.append((self.now_ms, left, right))

    def stop_motors(self):
        self.events.append((self.now_ms, 0, 0))

    def distance_mm(self):
        # The first request comes before the start and takes no reading.
        self.requests += 1
        reading = self.readings[max(0, self.requests - 1)]
        if reading == "dead":
            raise OSError(19)
        return None if reading == "none" else reading

    def time_ms(self):
        return self.now_ms

    def wait_ms(self, ms):
        self.now_ms += ms

def run_case(program, readings):
    names = {"__name__": "program"}
    exec(program, names)
    robot = Scripted(json.loads(readings))
    ending = names["run"](robot)
    return json.dumps([ending, robot.events])

def call_all(program, calls):
    names = {"__name__": "networks"}
    exec(program, names)
    calls = json.loads(calls)
    return json.dumps({name: [names[name](*inputs) for inputs in calls[name]] for name in calls})
`;

const micropython = await loadMicroPython({ heapsize: 8 * 1024 * 1024 });
micropython.runPython(HARNESS);
const runCase = micropython.globals.get("run_case");
const callAll = micropython.globals.get("call_all");
for (const { program, readings, calls } of JSON.parse(readFileSync(process.argv[2], "utf8"))) {
  console.log(calls ? callAll(program, JSON.stringify(calls)) : runCase(program, JSON.stringify(readings)));
}
