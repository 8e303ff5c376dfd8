"use strict";
// The charts of a loop on the robot.

const TRIALS = [...new Set(page.chances.map((c) => c.trial))];
const WHEN = ["before the run", "after the run"];
const LEARNING = ["before learning", "after learning"];

/** Trials along x, each with a place for before and one beside it for after. */
const beside = (row) => row.trial + (row.kind === WHEN[0] ? -0.12 : 0.12);
const alongTrials = (more) => ({
  marginTop: 30,
  marginBottom: 40,
  x: {
    domain: [TRIALS[0] - 0.5, TRIALS.at(-1) + 0.5],
    label: "trial →",
    ticks: TRIALS.filter((_, i) => i % Math.ceil(TRIALS.length / 12) === 0),
    tickFormat: "d",
  },
  ...kindScale(WHEN, BEFORE_AFTER.slice(0, 2)),
  ...more,
});

charts.chances = (width) => {
  const driven = page.chances.filter((c) => c.kind === WHEN[0] && c.reached !== null);
  const end = (c) => (c.reached ? "✓ reached" : "✗ missed");
  return Plot.plot({
    ...alongTrials({ marginLeft: 46, marginTop: 46 }),
    width,
    height: 320,
    y: { domain: [0, 100], grid: true, label: "↑ chance of reaching the target (%)", ticks: 5 },
    marks: [
      Plot.ruleX(page.chances, {
        x: beside,
        y1: (c) => 100 * c.ci95[0],
        y2: (c) => 100 * c.ci95[1],
        stroke: "kind",
        strokeWidth: 3,
        strokeOpacity: 0.5,
      }),
      Plot.dot(page.chances, {
        x: beside,
        y: (c) => 100 * c.chance,
        stroke: "kind",
        symbol: "kind",
        fill: "var(--paper)",
        r: 6,
        strokeWidth: 2,
      }),
      Plot.text(driven, {
        x: "trial",
        frameAnchor: "top",
        dy: -12,
        text: (c) => (width / TRIALS.length < 70 ? end(c)[0] : end(c)),
        title: end,
        fontWeight: "bold",
      }),
    ],
  });
};

charts.trial = (width, number) => {
  const { predicted, real } = page.trials[number];
  const lines = predicted.flatMap((path, z) => path.map(([x, y]) => ({ kind: "expected", z, x, y })));
  const driven = real.map(([x, y]) => ({ kind: "the robot", x, y }));
  return Plot.plot({
    ...mapOf(page.room, width),
    ...kindScale(["expected", "the robot"], ["var(--simulator)", "var(--effects)"]),
    marks: [
      ...roomMarks(page.room),
      Plot.line(lines, { x: "x", y: "y", z: "z", stroke: "kind", strokeOpacity: 0.7 }),
      Plot.dot(
        predicted.filter((path) => path.length).map((path) => path.at(-1)),
        { x: (p) => p[0], y: (p) => p[1], stroke: "var(--simulator)", r: 3 },
      ),
      Plot.line(driven, { x: "x", y: "y", stroke: "kind", strokeWidth: 3 }),
      Plot.dot(driven.slice(-1), {
        x: "x",
        y: "y",
        stroke: "kind",
        symbol: "kind",
        fill: "var(--paper)",
        r: 6,
        strokeWidth: 2,
      }),
      targetMark(page.room),
    ],
  });
};

charts.gaps = (width, number) => {
  const { rows, unit } = page.gaps[number];
  const points = rows.flatMap(({ trial, before, after }) => [
    { trial, kind: LEARNING[0], off: before },
    { trial, kind: LEARNING[1], off: after },
  ]);
  return Plot.plot({
    ...alongTrials({ marginLeft: 52 }),
    width,
    height: 240,
    ...kindScale(LEARNING, BEFORE_AFTER.slice(0, 2)),
    y: { domain: [0, 1.1 * d3.max(points, (p) => p.off)], grid: true, label: `↑ a step is off by (${unit})`, ticks: 5 },
    marks: [
      Plot.line(points, { x: "trial", y: "off", stroke: "kind", strokeOpacity: 0.6 }),
      Plot.dot(points, {
        x: "trial",
        y: "off",
        stroke: "kind",
        symbol: "kind",
        fill: "var(--paper)",
        r: 5,
        strokeWidth: 2,
      }),
    ],
  });
};
