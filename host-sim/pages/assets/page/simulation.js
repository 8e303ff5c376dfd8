"use strict";
// The charts of a controller's runs.

charts.runs = (width) => {
  const ENDS = { finished: "var(--third)", "timed out": "var(--simulator)", crashed: "var(--effects)" };
  const domain = Object.keys(ENDS).filter((end) => page.paths.some((p) => p.ending === end));
  const points = page.paths.flatMap((p) => p.x.map((x, i) => ({ run: p.run, ending: p.ending, x, y: p.y[i] })));
  const ends = page.paths.map((p) => ({ ending: p.ending, run: p.run, x: p.x.at(-1), y: p.y.at(-1) }));
  return Plot.plot({
    ...mapOf(page.room, width),
    ...kindScale(
      domain,
      domain.map((end) => ENDS[end]),
    ),
    marks: [
      ...roomMarks(page.room),
      Plot.line(points, { x: "x", y: "y", z: "run", stroke: "ending", strokeOpacity: 0.45 }),
      Plot.dot(ends, {
        x: "x",
        y: "y",
        stroke: "ending",
        symbol: "ending",
        fill: "var(--paper)",
        r: 4,
        strokeWidth: 2,
        title: (e) => `run ${e.run}`,
      }),
      targetMark(page.room),
    ],
  });
};

charts.turns = (width) => {
  const runs = [...new Set(page.turns.map((turn) => turn.run))];
  const tuples = [...new Set(page.turns.map((turn) => turn.tuple))].sort();
  return Plot.plot({
    width,
    height: Math.max(90, Math.min(520, 16 * runs.length + 70)),
    marginLeft: 34,
    marginTop: 30,
    marginBottom: 38,
    x: { label: "step →" },
    y: {
      type: "band",
      domain: runs,
      label: "run",
      labelAnchor: "top",
      ticks: runs.length > 30 ? [] : undefined,
      padding: runs.length > 30 ? 0 : 0.15,
    },
    // A tuple has one colour on every page; the darkest of the scheme is lost on a dark page.
    color: {
      type: "ordinal",
      domain: tuples,
      range: tuples.map((tuple) => d3.interpolateViridis(0.25 + 0.14 * (tuple - 1))),
      legend: true,
      label: "tuple",
    },
    marks: [
      Plot.barX(page.turns, {
        x1: "from",
        x2: "to",
        y: "run",
        fill: "tuple",
        title: (t) => `tuple ${t.tuple}, steps ${t.from} to ${t.to}`,
      }),
    ],
  });
};
