// Validates GLB files with the Khronos glTF validator: node scripts/check_glb.mjs FILE...
// Prints a line per file and each error or warning; exits with 1 unless there is none.
import { readFile } from "node:fs/promises";
import validator from "gltf-validator";

const SEVERITIES = ["error", "warning"];
const paths = process.argv.slice(2);
if (paths.length === 0) {
  console.error("usage: node scripts/check_glb.mjs FILE...");
  process.exit(2);
}

let faults = 0;
for (const path of paths) {
  try {
    const bytes = new Uint8Array(await readFile(path));
    const { issues, info } = await validator.validateBytes(bytes, { uri: path, maxIssues: 100 });
    const { numErrors, numWarnings, numInfos } = issues;
    faults += numErrors + numWarnings;
    const { drawCallCount = 0, totalTriangleCount = 0, animationCount = 0 } = info ?? {};
    console.log(
      `${path}: ${numErrors} errors, ${numWarnings} warnings, ${numInfos} notes; ` +
        `${drawCallCount} draw calls, ${totalTriangleCount} triangles, ${animationCount} animations`,
    );
    for (const { severity, code, message, pointer } of issues.messages) {
      if (severity < SEVERITIES.length) {
        console.log(`  ${SEVERITIES[severity]} ${code} at ${pointer}: ${message}`);
      }
    }
  } catch (error) {
    faults += 1;
    console.log(`${path}: not validated: ${error.message ?? error}`);
  }
}
process.exit(faults === 0 ? 0 : 1);
