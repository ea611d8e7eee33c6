// Prints Khronos' validation report of each file named, as one JSON object a line.
const { readFileSync } = require("node:fs");
const { dirname, join } = require("node:path");
const { validateBytes } = require("gltf-validator");

async function main() {
  for (const file of process.argv.slice(2)) {
    const beside = (uri) => new Uint8Array(readFileSync(join(dirname(file), decodeURIComponent(uri))));
    const report = await validateBytes(new Uint8Array(readFileSync(file)), {
      maxIssues: 0,
      externalResourceFunction: async (uri) => beside(uri),
    });
    console.log(JSON.stringify(report));
  }
}

main();
