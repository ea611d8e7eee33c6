import assert from "node:assert/strict"
import {readFileSync} from "node:fs"
import {test} from "node:test"

import {shaderSwaps} from "../../../app/frontend/shade.js"

const NEEDS = ["", "values", "colors", "materials"].flatMap((by) =>
  [[0, 0], [1, 0], [2, 2]].map(([sets, otherSets]) => ({by, sets, otherSets})))

test("what is replaced in vtk.js' shaders is in the vtk.js that is served", () => {
  const bundle = readFileSync(process.env.VTK_JS, "utf8").replaceAll("\\n", "\n")
  // vtk.js writes the number of a light, and its own newlines, as it makes the text.
  const anchors = NEEDS.flatMap(shaderSwaps).map(({originalValue}) => originalValue.trim())
  assert.ok(new Set(anchors).size > 8)
  for (const anchor of new Set(anchors)) {
    assert.ok(anchor.split(/(?<=VC)\d/).every((part) => bundle.includes(part)), anchor)
  }
})
