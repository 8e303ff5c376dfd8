// Enki: one differential drive with one forward range sensor in a walled room with four boxes, as in our
// four-obstacles room. Prints control steps of 400 ms per second, worked out in so many parts.
//   enki PARTS
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <random>

#include <enki/PhysicalEngine.h>
#include <enki/interactions/IRSensor.h>
#include <enki/robots/DifferentialWheeled.h>

struct Robot : Enki::DifferentialWheeled {
    Enki::IRSensor sensor;
    Robot() : DifferentialWheeled(11, 30, 0), sensor(this, Enki::Vector(9, 0), 5, 0, 250, 1, -1, 10) {
        addLocalInteraction(&sensor);
        setCylindric(9, 10, 600);
    }
};

int main(int argc, char** argv) {
    const int parts = argc > 1 ? std::atoi(argv[1]) : 1;
    const double boxes[4][4] = {{65, 55, 35, 30}, {175, 35, 30, 55}, {115, 145, 55, 25}, {225, 155, 30, 35}};
    Enki::World world(300, 220);
    for (const auto& [x, y, width, height] : boxes) {
        auto* box = new Enki::PhysicalObject;
        box->setRectangular(width, height, 20, -1);
        box->pos = Enki::Point(x + width / 2, y + height / 2);
        world.addObject(box);
    }
    auto* robot = new Robot;
    robot->pos = Enki::Point(130, 100);
    world.addObject(robot);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> speed(-10, 10);
    const long steps = 2000000 / parts;
    double sum = 0;
    const auto begin = std::chrono::steady_clock::now();
    for (long step = 0; step < steps; step++) {
        if (step % 10 == 0) {
            robot->leftSpeed = speed(random);
            robot->rightSpeed = speed(random);
        }
        for (int part = 0; part < parts; part++) world.step(0.4 / parts);
        sum += robot->sensor.getDist();
    }
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    std::printf("%.0f\n", steps / took.count());
    return sum > 0 ? 0 : 1;
}
