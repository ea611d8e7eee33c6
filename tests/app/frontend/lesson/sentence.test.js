import assert from "node:assert/strict"
import {test} from "node:test"

import {stopAfter, stopOf} from "../../../../app/frontend/lesson/sentence.js"

const stops = /** @type {[any, string][]} */ ([[6, "6"], [26, "26"], ["any", "any angle"]])

test("a value has the nearest stop", () => {
  assert.equal(stopOf(stops, 26), 1)
  assert.equal(stopOf(stops, "any"), 2)
  assert.equal(stopOf(stops, 20), 1)
  assert.equal(stopOf(stops, "none"), 0)
})

test("keys go to stops, and no farther than the last", () => {
  const expected = {ArrowRight: 51, ArrowDown: 49, PageUp: 60, Home: 0, End: 100, a: undefined}
  for (const [key, to] of Object.entries(expected)) { assert.equal(stopAfter(key, 50, 101), to) }
  assert.equal(stopAfter("ArrowLeft", 0, 3), 0)
  assert.equal(stopAfter("PageUp", 2, 3), 2)
})
