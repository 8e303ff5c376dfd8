// Opens pages in Chromium and says what it saw. Standard input: a JSON list of visits, each with
//   file     the page's path
//   width    of the window, px
//   dark     whether the reader likes the dark
//   picture  where to leave a picture of the whole page
//   steps    expressions, evaluated in the page one after the other; `keys` to press in one of them: {"key": "ArrowRight"}
// Standard output: a JSON list, one entry a visit, with
//   console     what the page wrote to the console, and what went wrong in it
//   overflow    by how many px it is wider than its window
//   violations  what an accessibility checker calls serious or critical
//   answers     the values of the steps
//   printed     length of the page as PDF, bytes, and the number of its sheets

import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { text } from "node:stream/consumers";
import { pathToFileURL } from "node:url";

const [modules] = process.argv.slice(2);
const load = createRequire(`${modules}/`);
const puppeteer = load("puppeteer-core");
const axe = readFileSync(load.resolve("axe-core/axe.min.js"), "utf8");

// Machines that do other things besides may take this long.
const PATIENCE_MS = 240_000;
const DRAWN = `[...document.querySelectorAll("[data-chart]")].every((place) => place.querySelector("svg"))`;

async function visit(browser, { file, width, dark, picture, steps }) {
  const page = await browser.newPage();
  page.setDefaultTimeout(PATIENCE_MS);
  const said = [];
  page.on("console", (message) => said.push(message.text()));
  page.on("pageerror", (error) => said.push(String(error)));
  page.on("requestfailed", (request) => said.push(`${request.url()} was asked for`));
  await page.setViewport({ width, height: 800, isMobile: width < 600, hasTouch: width < 600 });
  await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: dark ? "dark" : "light" }]);
  await page.goto(pathToFileURL(file).href);
  await page.waitForFunction(DRAWN);
  const answers = [];
  for (const step of steps) {
    if (step.key) await page.keyboard.press(step.key);
    answers.push(step.key ? null : await page.evaluate(step));
  }
  if (picture) await page.screenshot({ path: picture, fullPage: true });
  const overflow = await page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth");
  const heard = [...said];
  await page.evaluate(axe);
  const found = await page.evaluate("axe.run()");
  const serious = found.violations.filter((v) => ["serious", "critical"].includes(v.impact));
  const violations = serious.map((v) => `${v.id}: ${v.help}: ${v.nodes.slice(0, 3).map((node) => node.html).join(" | ")}`);
  const pdf = Buffer.from(await page.pdf()).toString("latin1");
  const printed = { bytes: pdf.length, sheets: pdf.match(/\/Type \/Page\b/g)?.length ?? 0 };
  await page.close();
  return { console: heard, overflow, violations, answers, printed };
}

const visits = JSON.parse(await text(process.stdin));
const browser = await puppeteer.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  // Tests run as root in containers, where Chromium has no sandbox.
  args: ["--no-sandbox", "--disable-dev-shm-usage", "--hide-scrollbars"],
  timeout: PATIENCE_MS,
  protocolTimeout: PATIENCE_MS,
});
const seen = [];
for (const asked of visits) seen.push(await visit(browser, asked));
await browser.close();
console.log(JSON.stringify(seen));
