// Runs exported programs in MicroPython: `node run.mjs CASES.json` prints one line per case. For a program on a scripted
// robot of a kit ("nxt", "ev3" or "spike") it is the printed lines with the times and powers of all motor commands; for
// networks it is the outputs for all inputs.
import { readFileSync } from "node:fs";
import { loadMicroPython } from "@micropython/micropython-webassembly-pyscript/micropython.mjs";

const HARNESS = `
import sys, json, math

sys.modules["umath"] = math

# Stubs of Pybricks' modules on a robot whose sensor follows a script. The constructors of devices that are missing raise an
# error, as on a hub.
class Module:
    pass

class Direction:
    CLOCKWISE = 1
    COUNTERCLOCKWISE = -1

class World:
    """Time, powers and readings of one case."""

    def __init__(self, readings, missing):
        self.readings = readings
        self.missing = missing
        # The first request comes before the start and takes no reading.
        self.requests = -1
        self.now_ms = 0
        self.powers = {}
        self.events = []

    def connect(self, port):
        if port in self.missing:
            raise OSError(19)

    def set_power(self, port, power):
        self.powers[port] = power
        # The program sets the right motor last.
        if port == self.right:
            self.events.append((self.now_ms, self.powers[self.left], power))

    def distance_mm(self):
        self.requests += 1
        reading = self.readings[max(0, self.requests - 1)]
        if reading == "dead":
            raise OSError(5)
        return self.no_echo_mm if reading == "none" else reading

def ports(names):
    port = Module()
    for name in names:
        setattr(port, name, "Port." + name)
    return port

def devices(world):
    class Motor:
        def __init__(self, port, positive_direction=Direction.CLOCKWISE):
            world.connect(port)
            self.port = port

        def dc(self, power):
            world.set_power(self.port, power)

        def brake(self):
            world.set_power(self.port, 0)

        def angle(self):
            return world.now_ms

    class UltrasonicSensor:
        def __init__(self, port):
            world.connect(port)

        def distance(self):
            return world.distance_mm()

    module = Module()
    module.Motor = Motor
    module.UltrasonicSensor = UltrasonicSensor
    return module

def install(kit, world):
    """Puts the modules of a kit in place of those of the last case."""
    for name in [name for name in sys.modules if name.startswith("pybricks")]:
        del sys.modules[name]

    class StopWatch:
        def time(self):
            return world.now_ms

    def wait(ms):
        world.now_ms += ms

    class ThisHub:
        def __init__(self):
            self.battery = Module()
            self.battery.voltage = lambda: 7654

    tools, parameters, hubs = Module(), Module(), Module()
    tools.StopWatch, tools.wait, hubs.ThisHub = StopWatch, wait, ThisHub
    parameters.Direction = Direction
    is_brick = kit != "spike"
    parameters.Port = ports(["A", "B", "C", "S1", "S2", "S3", "S4"] if is_brick else ["A", "B", "C", "D", "E", "F"])
    world.left, world.right = ("Port.B", "Port.C") if is_brick else ("Port.A", "Port.B")
    world.no_echo_mm = 2550 if is_brick else 2000
    nxt_sensors = Module()
    nxt_sensors.UltrasonicSensor = None
    kits = {
        "ev3": {"ev3devices": devices(world), "nxtdevices": nxt_sensors},
        "nxt": {"nxtdevices": devices(world), "pupdevices": devices(world)},
        "spike": {"pupdevices": devices(world)},
    }
    modules = {"tools": tools, "parameters": parameters, "hubs": hubs}
    modules.update(kits[kit])
    sys.modules["pybricks"] = Module()
    for name in modules:
        sys.modules["pybricks." + name] = modules[name]

def run_case(program, readings, kit, missing):
    world = World(json.loads(readings), json.loads(missing))
    install(kit, world)
    lines = []
    names = {
        "__name__": "__main__",
        "print": lambda *values, sep=" ": lines.append(sep.join(str(value) for value in values)),
    }
    exec(program, names)
    return json.dumps([lines, world.events])

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
for (const { program, readings, kit, missing, calls } of JSON.parse(readFileSync(process.argv[2], "utf8"))) {
  const run = () => runCase(program, JSON.stringify(readings), kit, JSON.stringify(missing ?? []));
  console.log(calls ? callAll(program, JSON.stringify(calls)) : run());
}
