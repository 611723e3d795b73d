// Where Chromium is, and how tests start it: without a screen, a graphics card or anything of its own to ask for.
import { existsSync } from "node:fs";
import { join } from "node:path";

export function skip(why) {
  console.log(`skipped: ${why}`);
  process.exit(77);
}

// Exits 77 where there is none.
export function browser_path() {
  const names = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];
  for (const folder of (process.env.PATH ?? "").split(":"))
    for (const name of names) if (existsSync(join(folder, name))) return join(folder, name);
  return skip("no chromium");
}

export const browser_options = () => ({
  executablePath: browser_path(), headless: true,
  args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-first-run", "--disable-background-networking"],
});
