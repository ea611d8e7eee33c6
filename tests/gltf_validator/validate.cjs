// Answers each line of standard input, the name of a file, by Khronos' report on it, a line of JSON.
const { readFileSync } = require("node:fs");
const { dirname, join } = require("node:path");
const { createInterface } = require("node:readline");
const { validateBytes } = require("gltf-validator");

async function main() {
  for await (const file of createInterface({ input: process.stdin })) {
    const beside = (uri) => new Uint8Array(readFileSync(join(dirname(file), decodeURIComponent(uri))));
    const report = await validateBytes(new Uint8Array(readFileSync(file)), {
      maxIssues: 0,
      externalResourceFunction: async (uri) => beside(uri),
    });
    console.log(JSON.stringify(report));
  }
}

main();
