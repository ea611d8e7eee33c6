import assert from "node:assert/strict"
import {test} from "node:test"

import {closedAtFirst, Forest} from "../../../../app/frontend/widgets/forest.js"

const LEVELS = [0, 1, 2, 2, 1, 0]
const rows = LEVELS.map((level, i) => ({joint: 10 + i, level}))

test("what is closed hides all below it, and nothing else", () => {
  assert.deepEqual(new Forest(rows, new Set()).seen(), [0, 1, 2, 3, 4, 5])
  assert.deepEqual(new Forest(rows, new Set([11])).seen(), [0, 1, 4, 5])
  assert.deepEqual(new Forest(rows, new Set([10, 11])).seen(), [0, 5])
})

test("parents and children are found by the levels", () => {
  const forest = new Forest(rows, new Set())
  assert.deepEqual(rows.map((_, i) => forest.parent(i)), [-1, 0, 1, 1, 0, -1])
  const parents = rows.map((_, i) => forest.hasChildren(i))
  assert.deepEqual(parents, [true, true, false, false, false, false])
})

test("a joint is revealed by opening all above it", () => {
  const forest = new Forest(rows, new Set([10, 11]))
  forest.reveal(13)
  assert.deepEqual(forest.seen(), [0, 1, 2, 3, 4, 5])
})

test("a large skeleton begins with its deep branches closed", () => {
  assert.equal(closedAtFirst(rows).size, 0)
  const many = Array.from({length: 400}, (_, i) => ({joint: i, level: i % 8}))
  const seen = new Forest(many, closedAtFirst(many)).seen()
  assert.equal(seen.length, 200)
})
