"use strict";
// The charts of an evaluation.

charts.scatter = (width, number) => {
  const { name, unit, points } = page.scatter[number];
  const [low, high] = d3.extent(points.flat());
  const size = Math.min(width, 460);
  return Plot.plot({
    width: size,
    height: size,
    marginLeft: 52,
    marginTop: 30,
    marginBottom: 40,
    inset: 4,
    x: { domain: [low, high], label: `logged ${name} (${unit}) →`, nice: true, ticks: 5 },
    y: { domain: [low, high], label: `↑ predicted (${unit})`, grid: true, nice: true, ticks: 5 },
    marks: [
      Plot.link([0], { x1: low, y1: low, x2: high, y2: high, stroke: "currentColor", strokeOpacity: 0.6 }),
      Plot.dot(points, { x: (p) => p[0], y: (p) => p[1], r: 1.8, fill: "var(--simulator)", fillOpacity: 0.5 }),
    ],
  });
};

charts.reliability = (width) => {
  const size = Math.min(width, 460);
  return Plot.plot({
    width: size,
    height: size,
    marginLeft: 48,
    marginTop: 30,
    marginBottom: 40,
    x: { domain: [0, 1], label: "predicted probability of an echo →", ticks: 5 },
    y: { domain: [0, 1], label: "↑ share with an echo", grid: true, ticks: 5 },
    r: { range: [2, 12] },
    marks: [
      Plot.link([0], { x1: 0, y1: 0, x2: 1, y2: 1, stroke: "currentColor", strokeOpacity: 0.6 }),
      Plot.line(page.reliability, { x: "predicted", y: "observed", stroke: "var(--simulator)" }),
      Plot.dot(page.reliability, {
        x: "predicted",
        y: "observed",
        r: "n",
        fill: "var(--simulator)",
        title: (b) => `${b.n} samples`,
      }),
    ],
  });
};

const HATCH = `<pattern id="hatch" width="6" height="6" patternUnits="userSpaceOnUse" patternTransform="rotate(45)">
  <rect width="6" height="6" fill="var(--panel)"></rect><line y2="6" stroke="var(--quiet)" stroke-width="1.5"></line></pattern>`;

charts.surface = (width, number) => {
  const { name, range, size, cells } = page.surfaces[number];
  const cell = { x1: "distance", y1: "alpha", x2: (c) => c.distance + size[0], y2: (c) => c.alpha + size[1] };
  const title = (c) => `${said(c.distance)} cm, ${said(c.alpha)}°: ${c.known ? said(c.value) : "no data"}`;
  const chart = Plot.plot({
    width,
    height: Math.min(360, 0.6 * width + 60),
    marginLeft: 46,
    marginTop: 30,
    marginBottom: 40,
    x: { label: "distance D (cm) →" },
    y: { label: "↑ incidence angle α (°)" },
    color: { scheme: "viridis", domain: range, legend: true, label: name },
    marks: [
      Plot.rect(
        cells.filter((c) => c.known),
        { ...cell, fill: "value", title },
      ),
      Plot.rect(
        cells.filter((c) => !c.known),
        { ...cell, fill: "url(#hatch)", title },
      ),
    ],
  });
  // All charts of a page may use the one pattern.
  const defs = document.createElementNS("http://www.w3.org/2000/svg", "defs");
  defs.innerHTML = HATCH;
  if (number === 0) [...chart.querySelectorAll("svg")].at(-1).prepend(defs);
  return chart;
};

/** The sheet in space, with holes where there were no data. */
function sheet(place) {
  const number = Number(place.dataset.surface),
    { name, unit, range, size, cells } = page.surfaces[number];
  const colour = (variable) => getComputedStyle(place).getPropertyValue(variable).trim();
  const points = new vis.DataSet(
    cells.filter((c) => c.known).map((c) => ({ x: c.distance + size[0] / 2, y: c.alpha + size[1] / 2, z: c.value })),
  );
  const graph = new vis.Graph3d(place, points, {
    width: "100%",
    height: `${place.clientHeight}px`,
    style: "surface",
    keepAspectRatio: false,
    verticalRatio: 0.6,
    showPerspective: true,
    xLabel: "D (cm)",
    yLabel: "α (°)",
    zLabel: unit || "probability",
    zMin: range[0],
    zMax: range[1],
    showLegend: false,
    backgroundColor: colour("--paper"),
    axisColor: colour("--quiet"),
    gridColor: colour("--line"),
    axisFontSize: 22,
    // Seen from above, a sheet lies low in its picture.
    yCenter: "38%",
    colormap: Array.from({ length: 12 }, (_, i) => d3.color(d3.interpolateViridis(i / 11)).formatHex()),
  });
  const [turn, tilt] = ["turn", "tilt"].map((way) => document.querySelector(`[data-${way}="${number}"]`));
  const aim = () =>
    graph.setCameraPosition({
      horizontal: (turn.value * Math.PI) / 180,
      vertical: (tilt.value * Math.PI) / 180,
      distance: 1.9,
    });
  [turn, tilt].forEach((slider) => slider.addEventListener("input", aim));
  aim();
  addEventListener("resize", () => graph.redraw());
}

addEventListener("DOMContentLoaded", () => document.querySelectorAll(".turnable").forEach(sheet));
