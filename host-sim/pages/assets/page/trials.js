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

charts.map = (width, number) => {
  const points = (paths, kind) => paths.flatMap((path, i) => path.map(([x, y]) => ({ kind, path: `${kind} ${i}`, x, y })));
  const ends = (paths, kind) => paths.flatMap((path) => path.slice(-1)).map(([x, y]) => ({ kind, x, y }));
  const { expected, driven } = page.maps[number];
  const line = (strokeWidth) => ({ x: "x", y: "y", z: "path", stroke: "kind", strokeWidth });
  return Plot.plot({
    ...mapOf(page.room, width),
    ...kindScale(["expected", "the robot"], ["var(--simulator)", "var(--effects)"]),
    marks: [
      ...roomMarks(page.room),
      targetMark(page.room),
      Plot.line(points(expected, "expected"), line(1)),
      Plot.line(points(driven, "the robot"), line(2.5)),
      Plot.dot([...ends(expected, "expected"), ...ends(driven, "the robot")], {
        x: "x",
        y: "y",
        stroke: "kind",
        symbol: "kind",
        fill: "var(--paper)",
        r: 4,
        strokeWidth: 2,
      }),
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
      Plot.line(points, { x: "trial", y: "off", z: "kind", stroke: "kind", strokeOpacity: 0.6 }),
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
