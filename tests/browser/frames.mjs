// frames.mjs MODULES PAGE...: how fast pages with a replay are in Chromium: until all is drawn after opening, and while the
// slider is dragged, a row a frame, through the run that is shown. MODULES is the folder that has puppeteer-core.

import { createRequire } from "node:module";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [modules, ...pages] = process.argv.slice(2);
const puppeteer = createRequire(`${resolve(modules)}/`)("puppeteer-core");
const DRAWN = `[...document.querySelectorAll("[data-chart]")].every((place) => place.querySelector("svg"))`;
const FRAMES = 300;

/** In the page: the times between frames, ms. */
async function drag(frames) {
  const slider = document.getElementById("moment");
  slider.scrollIntoView();
  const between = [];
  let last = await new Promise(requestAnimationFrame);
  for (let i = 0; i < frames; i++) {
    slider.value = i % (Number(slider.max) + 1);
    slider.dispatchEvent(new Event("input", { bubbles: true }));
    const now = await new Promise(requestAnimationFrame);
    between.push(now - last);
    last = now;
  }
  return between;
}

const at = (times, share) => times.toSorted((a, b) => a - b)[Math.floor(share * (times.length - 1))].toFixed(1);

const browser = await puppeteer.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--disable-dev-shm-usage"],
});
for (const file of pages) {
  const page = await browser.newPage();
  const devtools = await page.createCDPSession();
  // Processor time of the page's main thread: the same on a machine that does other things besides.
  await devtools.send("Performance.enable", { timeDomain: "threadTicks" });
  const worked_ms = async () => {
    const { metrics } = await devtools.send("Performance.getMetrics");
    return 1000 * metrics.find(({ name }) => name === "TaskDuration").value;
  };
  await page.setViewport({ width: 1280, height: 800 });
  await page.goto(pathToFileURL(resolve(file)).href);
  await page.waitForFunction(DRAWN);
  const opened_ms = await page.evaluate("performance.now()");
  const opening_ms = await worked_ms();
  const between = await page.evaluate(drag, FRAMES);
  const frames_s = 1000 / (between.reduce((sum, ms) => sum + ms, 0) / between.length);
  const dragging_ms = ((await worked_ms()) - opening_ms) / FRAMES;
  console.log(
    `${file}: drawn ${Math.round(opened_ms)} ms after opening, ${Math.round(opening_ms)} ms of them at work; ` +
      `${frames_s.toFixed(0)} frames a second while dragged (95 % within ${at(between, 0.95)} ms), ` +
      `${dragging_ms.toFixed(1)} ms at work for each`,
  );
  await page.close();
}
await browser.close();
