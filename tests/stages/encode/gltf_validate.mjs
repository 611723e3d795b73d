// Runs the Khronos glTF validator on the files named; prints what it finds and exits 1 on any error
// or warning. Without files: exits 0 when the validator is there to run, 2 when it is not.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

let validator;
try {
  validator = createRequire(import.meta.url)("gltf-validator");
} catch {
  console.error("the npm package gltf-validator is not installed; run tests/npm_packages.sh");
  process.exit(2);
}
let failed = false;
for (const path of process.argv.slice(2)) {
  const report = await validator.validateBytes(new Uint8Array(readFileSync(path)), { uri: path });
  const { numErrors, numWarnings, messages } = report.issues;
  if (numErrors > 0 || numWarnings > 0) failed = true;
  for (const m of messages) console.log(`${path}: ${m.code} ${m.pointer ?? ""}: ${m.message}`);
}
process.exit(failed ? 1 : 0);
