"use strict";
// The charts of a diagnosis.

charts.budget = (width) =>
  namedShares(page.budget, width, "share of the gap (%) →", [
    Plot.barX(page.budget, {
      x: (p) => 100 * p.share,
      y: (_, i) => i,
      fill: (p) => (p.named ? "var(--effects)" : p.id === "scatter" ? "var(--simulator)" : "var(--quiet)"),
    }),
    Plot.ruleY(page.budget, {
      x1: (p) => 100 * p.ci95[0],
      x2: (p) => 100 * p.ci95[1],
      y: (_, i) => i,
      strokeWidth: 2,
    }),
    Plot.tickX(
      page.budget.flatMap((p, i) => p.ci95.map((end) => ({ end, i }))),
      { x: (e) => 100 * e.end, y: "i", insetTop: 5, insetBottom: 5, strokeWidth: 2 },
    ),
  ]);

/** Logged minus predicted along a covariate, for one or two kinds of prediction. */
function residuals(width, { depends_on, unit }, kinds) {
  const points = kinds.flatMap(([kind, bins]) =>
    bins.map((bin) => ({ kind, middle: (bin.from + bin.to) / 2, ...bin })),
  );
  return Plot.plot({
    width,
    height: 260,
    marginLeft: 52,
    marginTop: 30,
    marginBottom: 40,
    ...kindScale(
      kinds.map(([kind]) => kind),
      BEFORE_AFTER,
    ),
    x: { label: `${depends_on} →`, nice: true },
    y: { label: `↑ logged − predicted (${unit})`, grid: true, nice: true, ticks: 5 },
    marks: [
      Plot.ruleY([0], { stroke: "currentColor", strokeOpacity: 0.6 }),
      Plot.line(points, { x: "middle", y: "off", stroke: "kind", strokeOpacity: 0.6 }),
      Plot.ruleX(points, {
        x: "middle",
        y1: (p) => p.off - 1.96 * p.error,
        y2: (p) => p.off + 1.96 * p.error,
        stroke: "kind",
      }),
      Plot.dot(points, {
        x: "middle",
        y: "off",
        stroke: "kind",
        symbol: "kind",
        fill: "var(--paper)",
        r: 5,
        strokeWidth: 2,
      }),
    ],
  });
}

charts.evidence = (width, number) => {
  const evidence = page.evidence[number];
  return residuals(width, evidence, [
    ["without the effect", evidence.without],
    ["with it", evidence.with],
  ]);
};

charts.profile = (width, number) =>
  residuals(width, page.profiles[number], [["what is left", page.profiles[number].shape]]);

charts.map = (width) => {
  const { side_cm, squares } = page.map;
  return Plot.plot({
    ...mapOf(page.room, width),
    color: {
      scheme: "viridis",
      legend: true,
      label: "gap, nats a row",
      domain: [
        0,
        Math.max(
          0.01,
          d3.quantile(squares, 0.95, (s) => s.nats),
        ),
      ],
      clamp: true,
    },
    marks: [
      Plot.rect(squares, {
        x1: "x_cm",
        y1: "y_cm",
        x2: (s) => s.x_cm + side_cm,
        y2: (s) => s.y_cm + side_cm,
        fill: "nats",
        stroke: "var(--line)",
        clip: true,
        title: (s) => `${said(s.nats)} nats a row, ${s.rows} rows`,
      }),
      ...roomMarks(page.room),
    ],
  });
};

charts.channels = (width) => {
  const ends = page.channels.flatMap((c) => [
    { ...c, kind: "without", nats: c.before },
    { ...c, kind: "with", nats: c.after },
  ]);
  return Plot.plot({
    width,
    height: 44 * page.channels.length + 70,
    marginLeft: 110,
    marginRight: 20,
    marginBottom: 42,
    ...kindScale(["without", "with"], BEFORE_AFTER),
    x: { label: "gap (nats a step) →", grid: true, zero: true, nice: true },
    y: { type: "point", label: null, domain: page.channels.map((c) => c.name), padding: 0.6 },
    marks: [
      Plot.link(page.channels, {
        x1: "before",
        x2: "after",
        y1: "name",
        y2: "name",
        stroke: "var(--quiet)",
        strokeWidth: 2,
      }),
      Plot.dot(ends, {
        x: "nats",
        y: "name",
        stroke: "kind",
        symbol: "kind",
        fill: "var(--paper)",
        r: 6,
        strokeWidth: 2.5,
      }),
    ],
  });
};

charts.paths = (width) => {
  const named = { before_cm: "without", after_cm: "with", floor_cm: "scatter alone" };
  const points = page.paths.flatMap((p) =>
    Object.keys(named).map((key) => ({ steps: p.steps, cm: p[key], kind: named[key] })),
  );
  return Plot.plot({
    width,
    height: 280,
    marginLeft: 46,
    marginTop: 30,
    marginBottom: 40,
    ...kindScale(KINDS, BEFORE_AFTER),
    x: { type: "point", label: "steps driven by the commands alone →", domain: page.paths.map((p) => p.steps) },
    y: { label: "↑ distance from where the robot was (cm)", grid: true, zero: true, nice: true },
    marks: [
      Plot.line(points, { x: "steps", y: "cm", stroke: "kind", strokeWidth: 2 }),
      Plot.dot(points, {
        x: "steps",
        y: "cm",
        stroke: "kind",
        symbol: "kind",
        fill: "var(--paper)",
        r: 5,
        strokeWidth: 2,
      }),
    ],
  });
};
