// Jobs in workers. Each has a worker of its own, which gives its memory back when it ends.

/** What a stopped job ends with. */
export class Stopped extends Error {}

let compiling;

/** The compiled module, which the page holds as base64 of gzip. */
function compiled() {
  compiling ??= (async () => {
    const packed = Uint8Array.from(atob(document.getElementById("module").textContent.trim()), (c) => c.charCodeAt(0));
    const plain = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    return WebAssembly.compile(await new Response(plain).arrayBuffer());
  })();
  return compiling;
}

/**
 * Starts a job. `watch(share, words)` follows it. Returns a promise of its answer, with the warnings on the way, and a
 * function that stops it.
 */
export function start(request, files, watch = () => {}) {
  const address = URL.createObjectURL(new Blob([document.getElementById("worker").textContent]));
  const worker = new Worker(address);
  const warnings = [];
  let stop;
  const answer = new Promise((resolve, reject) => {
    stop = () => reject(new Stopped());
    worker.onerror = ({ message }) => reject(new Error(message));
    worker.onmessage = ({ data }) => {
      if (data.progress) watch(...data.progress);
      if (data.warning) warnings.push(data.warning);
      if (data.error) reject(new Error(data.error));
      if (data.answer) resolve({ ...data.answer, warnings });
    };
    compiled().then((module) => worker.postMessage({ module, files, request }), reject);
  });
  const end = () => {
    worker.terminate();
    URL.revokeObjectURL(address);
  };
  answer.then(end, end);
  return { answer, stop };
}
