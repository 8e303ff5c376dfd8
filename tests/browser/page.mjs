// page.mjs MODULES PAGE FOLDER PICTURES: the browser page in Chromium, opened from disk as a user does. FOLDER holds the inputs,
// and in `expected` what the command made of them. MODULES is the folder that has puppeteer-core and axe-core.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [modules, page_file, folder, pictures] = process.argv.slice(2).map((path) => resolve(path));
const load = createRequire(`${modules}/`);
const puppeteer = load("puppeteer-core");
const axe = readFileSync(load.resolve("axe-core/axe.min.js"), "utf8");
const expected = (name) => readFileSync(join(folder, "expected", name), "utf8");
// Machines that do other things besides may take this long.
const PATIENCE_MS = 240_000;

/** Opens the page in a window of this width and calls `visit`; then checks what holds of every visit. */
async function visiting(browser, name, width, visit) {
  const page = await browser.newPage();
  page.setDefaultTimeout(PATIENCE_MS);
  const [said, requests] = [[], []];
  page.on("console", (message) => said.push(message.text()));
  page.on("pageerror", (error) => said.push(String(error)));
  page.on("request", (request) => requests.push(request.url()));
  await page.setViewport({ width, height: 800, isMobile: width < 600, hasTouch: width < 600 });
  await page.goto(pathToFileURL(page_file).href);
  await visit(page);
  await page.screenshot({ path: join(pictures, `${name}.png`), fullPage: true });
  const overflow = await page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth");
  assert.equal(overflow, 0, `${name}: the page is wider than its window`);
  assert.deepEqual(said, [], `${name}: nothing is written to the console`);
  const away = requests.filter((url) => !/^(file|blob|data|about):/.test(url));
  assert.deepEqual(away, [], `${name}: nothing is requested from the network`);
  await page.evaluate(axe);
  // The page of a diagnosis has tests of its own.
  const { violations } = await page.evaluate("axe.run({ exclude: ['iframe'] }, { iframes: false })");
  assert.deepEqual(violations.map((v) => `${v.id}: ${v.nodes[0].html}`), [], `${name}: accessible`);
  await page.close();
}

const text = (page, selector) => page.$eval(selector, (element) => element.textContent);
const choose = async (page, input, path) => (await page.$(input)).uploadFile(...[path].flat());

async function logs_are_checked_and_diagnosed(page) {
  await choose(page, "#files", join(folder, "simulator.json"));
  await choose(page, "#folder", join(folder, "worn"));
  await page.waitForSelector("#checks article");
  assert.match(await text(page, "#recognised"), /worn: logs, 6 runs.*simulator\.json: a simulator/);
  assert.equal(await text(page, "#checks pre"), expected("check.txt"));
  assert.equal((await page.$$("#checks svg path.robot:not(.start)")).length, 6);
  await page.click("#diagnosing button");
  await page.waitForSelector("#diagnosing progress");
  await page.waitForSelector("#diagnosing iframe");
  assert.equal(await text(page, "#diagnosing details pre"), expected("diagnosis.txt"));
  assert.equal(await page.$eval("#diagnosing iframe", (frame) => frame.srcdoc), expected("diagnosis.html"));
  assert.match(await text(page, "#diagnosing > div"), /mindgap diagnose simulator\.json worn --json diagnosis\.json/);
  const frame = await (await page.$("#diagnosing iframe")).contentFrame();
  await frame.waitForSelector("[data-chart] svg");
}

async function work_is_stopped_and_started_by_keyboard(page) {
  await choose(page, "#folder", join(folder, "worn"));
  await page.waitForSelector("#checks article");
  await page.focus("#diagnosing select");
  await page.keyboard.press("Tab");
  await page.keyboard.press("Enter");
  await page.waitForSelector("#diagnosing progress");
  await page.keyboard.press("Tab");
  await page.keyboard.press("Enter");
  await page.waitForFunction(`document.querySelector("#diagnosing .state").textContent === "Stopped."`);
  await page.focus("#diagnosing form button");
  await page.keyboard.press("Enter");
  await page.waitForSelector("#diagnosing progress");
}

async function tables_are_imported_and_measures_asked_for(page) {
  await choose(page, "#files", join(folder, "drive.csv"));
  await page.waitForSelector("#importing button");
  await page.click("#importing button");
  await page.waitForSelector("form.measures");
  await page.waitForSelector("#checks article");
  await page.$eval("form.measures input", (input) => (input.value = "5.6"));
  await page.click("form.measures button");
  await page.waitForFunction(`!document.querySelector("form.measures")`);
}

async function archives_are_unpacked(page) {
  await choose(page, "#files", join(folder, "worn.zip"));
  await page.waitForSelector("#checks article");
  assert.match(await text(page, "#recognised"), /worn: logs, 6 runs.*simulator\.json: a simulator/);
  assert.equal(await text(page, "#checks pre"), expected("check.txt"));
}

async function bad_logs_give_one_line(page) {
  await choose(page, "#files", ["robot.toml", "run-000.csv"].map((name) => join(folder, "worn", name)));
  await page.waitForSelector("#checking [role=alert]");
  assert.match(await text(page, "#checking"), /scene\.toml: cannot be read: no such file$/);
}

async function the_built_in_robot_drives(page) {
  await page.click("#play");
  await page.waitForSelector("#playing form button");
  await page.click("#playing form button");
  await page.waitForSelector("#playing svg");
}

const browser = await puppeteer.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  // Tests run as root in containers, where Chromium has no sandbox.
  args: ["--no-sandbox", "--disable-dev-shm-usage", "--hide-scrollbars"],
  timeout: PATIENCE_MS,
  protocolTimeout: PATIENCE_MS,
});
await visiting(browser, "empty", 360, async () => {});
await visiting(browser, "diagnosis", 1200, logs_are_checked_and_diagnosed);
await visiting(browser, "keyboard", 360, work_is_stopped_and_started_by_keyboard);
await visiting(browser, "import", 360, tables_are_imported_and_measures_asked_for);
await visiting(browser, "archive", 360, archives_are_unpacked);
await visiting(browser, "bad-logs", 360, bad_logs_give_one_line);
await visiting(browser, "robot", 1200, the_built_in_robot_drives);
await browser.close();
