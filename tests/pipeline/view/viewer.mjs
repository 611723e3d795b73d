// What the tests of the viewer's page share: the program, a folder of their own, a browser and its pictures.
// A test that imports this exits 77 where there is no Chromium, no puppeteer-core (tests/npm_packages.sh) or no
// viewer; and 0 where no program is given and puppeteer-core is there.
import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { browser_options, skip } from "./chromium.mjs";
import { decoded_png } from "./picture.mjs";

export { skip };

const [, , voxweld] = process.argv;
export const patience_ms = 60000;

let puppeteer;
try {
  puppeteer = createRequire(import.meta.url)("puppeteer-core");
} catch {
  skip("puppeteer-core is not installed; run tests/npm_packages.sh");
}
if (voxweld === undefined) process.exit(0);
const options = browser_options();
export const place = mkdtempSync(join(tmpdir(), "voxweld-page-"));
process.on("exit", () => rmSync(place, { recursive: true, force: true }));

export function run(...args) {
  const done = spawnSync(voxweld, args, { cwd: place, encoding: "utf8" });
  if (/has no viewer/.test(done.stderr)) skip(done.stderr.trim());
  assert.equal(done.status, 0, `voxweld ${args.join(" ")}: ${done.stderr}`);
}

async function serve(name) {
  const server = spawn(voxweld, ["view", name], { cwd: place, stdio: ["ignore", "pipe", "pipe"] });
  let said = "";
  server.stderr.on("data", (text) => (said += text));
  const ended = new Promise((done) => server.on("exit", (code) => done(code)));
  const url = await new Promise((done, failed) => {
    server.stdout.on("data", (text) => done(String(text).match(/http:\S+/)[0]));
    ended.then(() => (/has no viewer/.test(said) ? skip(said.trim()) : failed(new Error(said))));
  });
  return { url, stop: () => (server.kill("SIGINT"), ended) };
}

// A folder by a web server that knows nothing of voxweld.
async function serve_files(name) {
  const server = spawn("python3", ["-u", "-m", "http.server", "-b", "127.0.0.1", "-d", name, "0"],
    { cwd: place, stdio: ["ignore", "pipe", "ignore"] });
  const ended = new Promise((done) => server.on("exit", () => done(0)));
  let said = "";
  const url = await new Promise((done, failed) => {
    server.stdout.on("data", (text) => {
      const address = (said += text).match(/http:[^)\s]+(?=\))/);
      if (address) done(address[0]);
    });
    server.on("error", failed);
    ended.then(() => failed(new Error("python3 -m http.server ended")));
  });
  return { url, stop: () => (server.kill("SIGINT"), ended) };
}

// Of libraries, of what is tested here: 3d-tiles-renderer says it of every tileset of version 1.1.
const expected = /tiles versions at 1.1 or higher have limited support|DRACOLoader: Decoding failed/;

// A page that complains of nothing: not of requests either.
async function open_page(browser, url) {
  const page = await browser.newPage();
  const complaints = [];
  page.on("console", (message) =>
    ["error", "warn", "warning"].includes(message.type()) && !expected.test(message.text()) && complaints.push(message.text()));
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("requestfailed", (request) => complaints.push(`${request.url()}: ${request.failure()?.errorText}`));
  page.on("response", (answer) => answer.status() >= 400 && complaints.push(`${answer.url()}: ${answer.status()}`));
  page.on("request", (request) => {
    if (!/^(http:\/\/127\.0\.0\.1:|blob:|data:)/.test(request.url())) complaints.push(`asks for ${request.url()}`);
  });
  await page.setViewport({ width: 1000, height: 640 });
  await page.goto(url);
  await page.waitForFunction(() => ["ready", "error"].includes(window.voxweld?.state.status), { timeout: patience_ms });
  return { page, complaints };
}

// What the canvas shows, without what lies over it.
export async function picture(page) {
  const text = await page.evaluate(async () => {
    const blob = await window.voxweld.view.stage.picture();
    return new Promise((done) => {
      const reader = new FileReader();
      reader.onload = () => done(reader.result.split(",")[1]);
      reader.readAsDataURL(blob);
    });
  });
  return decoded_png(Buffer.from(text, "base64"));
}

export const look = (page, text) => page.evaluate(`{ const view = window.voxweld.view; ${text} }`);
export const triangles_of = (name) => JSON.parse(readFileSync(join(place, name, "manifest.json"))).counts.triangles;

// Each test gets visit(NAME): serves what is in the folder, and opens the page. What ends in .page is a folder of
// `voxweld view --export`.
export async function run_tests(tests) {
  const browser = await puppeteer.launch(options);
  let failures = 0;
  for (const [name, test] of Object.entries(tests)) {
    const opened = [];
    const visit = async (what) => {
      const { url, stop } = await (what.endsWith(".page") ? serve_files : serve)(what);
      const again = async (hash = "") => {
        const one = await open_page(browser, url + hash);
        opened.push({ ...one, what });
        return { ...one, again };
      };
      opened.push({ stop });
      return again();
    };
    try {
      await test(visit);
      for (const { complaints = [], what } of opened) assert.deepEqual(complaints, [], what);
      console.log(`ok ${name}`);
    } catch (error) {
      ++failures;
      console.log(`FAILED ${name}: ${error.stack}`);
      for (const { complaints = [] } of opened) if (complaints.length > 0) console.log(complaints.join("\n"));
    }
    for (const { page, stop } of opened) {
      await page?.close();
      if (stop) assert.equal(await stop(), 0, "Ctrl-C ends the server well");
    }
  }
  await browser.close();
  process.exit(failures > 0 ? 1 : 0);
}
