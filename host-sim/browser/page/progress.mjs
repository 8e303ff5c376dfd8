// Shows a job while it runs: how far it is, and a button that stops it.

import { make } from "./elements.mjs";
import { start, Stopped } from "./jobs.mjs";

/** The job of each place. */
const jobs = new WeakMap();

/**
 * Runs a job with its progress in `place`, and returns the answer, or nothing if the job was stopped or failed; the reason is
 * then shown there. A job that is still running in the same place is stopped.
 */
export async function run(place, title, request, files) {
  const bar = make("progress", { max: 1, ariaLabel: title });
  const words = make("span", {}, title);
  const status = make("p", { role: "status" }, words);
  const job = start(request, files, (share, what) => {
    bar.value = share;
    words.textContent = `${title}: ${what}`;
  });
  jobs.get(place)?.stop();
  jobs.set(place, job);
  const stop = make("button", { type: "button", onclick: job.stop }, "Stop");
  place.replaceChildren(status, bar, stop);
  try {
    const answer = await job.answer;
    place.replaceChildren();
    return answer;
  } catch (why) {
    const said = why instanceof Stopped ? [{ role: "status" }, "Stopped."] : [{ role: "alert", className: "bad" }, why.message];
    if (jobs.get(place) === job) place.replaceChildren(make("p", ...said));
    return null;
  }
}
