// A headless Chromium, a server for the pages of this folder, for npm packages and for outputs, and what their
// pictures are held against. Exits 77 where there is no browser or a package is missing.
import { createReadStream, existsSync, statSync, writeFileSync } from "node:fs";
import http from "node:http";
import { createRequire } from "node:module";
import { dirname, extname, join, normalize } from "node:path";
import { fileURLToPath } from "node:url";
import { browser_options, skip } from "../pipeline/view/chromium.mjs";
import { decoded_png, share } from "../pipeline/view/picture.mjs";
import { missing_decoder } from "./glb.mjs";

const here = dirname(fileURLToPath(import.meta.url)), require = createRequire(import.meta.url);
const patience_ms = 600000;

export async function need(...packages) {
  const missing = await missing_decoder();
  if (missing) skip(missing);
  for (const name of ["puppeteer-core", ...packages])
    if (!existsSync(join(here, "../node_modules", name))) skip(`the npm package ${name} is not installed; run tests/npm_packages.sh`);
}

const types = {
  ".html": "text/html", ".js": "text/javascript", ".mjs": "text/javascript", ".json": "application/json",
  ".glb": "model/gltf-binary", ".wasm": "application/wasm", ".css": "text/css",
};

function serve(outputs) {
  const roots = { "/pages/": here, "/npm/": join(here, "../node_modules"), "/data/": outputs };
  const server = http.createServer((request, answer) => {
    const path = decodeURIComponent(new URL(request.url, "http://localhost").pathname);
    if (path === "/favicon.ico") return answer.writeHead(204).end();
    const [prefix, root] = Object.entries(roots).find(([start]) => path.startsWith(start)) ?? [];
    const file = root && join(root, normalize("/" + path.slice(prefix.length)));
    if (!file || !existsSync(file) || !statSync(file).isFile()) {
      answer.writeHead(404);
      return answer.end();
    }
    answer.writeHead(200, { "content-type": types[extname(file)] ?? "application/octet-stream" });
    return createReadStream(file).pipe(answer);
  });
  return new Promise((done) => server.listen(0, "127.0.0.1", () => done(server)));
}

// Calls test(page) with a page open: one of this folder, or an address; what the page complains of, but for `expected`,
// is a failure. script: for a page that has no window.client of its own.
export async function with_page(outputs, page_name, expected, test, script = "") {
  const puppeteer = require("puppeteer-core"), server = await serve(outputs);
  const browser = await puppeteer.launch({ ...browser_options(), protocolTimeout: patience_ms });
  const complaints = [];
  try {
    const page = await browser.newPage();
    page.on("console", (message) =>
      ["error", "warn", "warning"].includes(message.type()) && !expected.test(message.text()) && complaints.push(message.text()));
    page.on("pageerror", (error) => complaints.push(String(error)));
    page.on("response", (answer) => answer.status() >= 400 && complaints.push(`${answer.url()}: ${answer.status()}`));
    page.on("request", (request) => {
      if (!/^(http:\/\/127\.0\.0\.1:|blob:|data:)/.test(request.url())) complaints.push(`asks for ${request.url()}`);
    });
    await page.setViewport({ width: 900, height: 700 });
    await page.goto(new URL(page_name, `http://127.0.0.1:${server.address().port}/pages/`).href);
    await page.evaluate(script);
    await page.waitForFunction(() => window.client !== undefined, { timeout: patience_ms });
    await test(page);
  } finally {
    await browser.close();
    server.close();
  }
  return complaints;
}

const is_magenta = ([r, g, b]) => r > 250 && g < 5 && b > 250;

// What is seen of the page; returns how much of that is not background.
export async function save_picture(page, path, is_background = is_magenta) {
  const file = Buffer.from(await page.screenshot({ type: "png" }));
  writeFileSync(path, file);
  return 1 - share(decoded_png(file), is_background);
}

// Collects what fails; prints a line for each thing looked at.
export function checks(name) {
  const failures = [];
  return {
    say: (text) => console.log(text),
    check: (holds, text) => holds || (failures.push(text), console.log(`FAILED ${name}: ${text}`)),
    end(complaints) {
      for (const text of complaints) console.log(`FAILED ${name}: the page says: ${text}`);
      process.exit(failures.length + complaints.length > 0 ? 1 : 0);
    },
  };
}
