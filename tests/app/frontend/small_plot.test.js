import assert from "node:assert/strict"
import {test} from "node:test"

import {weightAt} from "../../../app/frontend/small_plot.js"

const plot = {distances: [0.1, 0.2, 0.4], diagonal: 2, alpha: 0.5}

test("the joints of a vertex share its weight, the nearest takes most", () => {
  const weights = plot.distances.map((distance) => weightAt(distance, plot))
  const sum = weights.reduce((a, b) => a + b)
  assert.ok(Math.abs(sum - 1) < 1e-12)
  assert.ok(weights[0] > weights[1] && weights[1] > weights[2])
})

test("a joint at distance zero has all the weight", () => {
  const touching = {...plot, distances: [0, 0.2]}
  assert.equal(weightAt(0, touching), 1)
  assert.ok(weightAt(0.2, touching) < 1e-9)
})

test("with alpha 1 the weight falls with the fourth power", () => {
  const steep = {...plot, alpha: 1}
  assert.ok(Math.abs(weightAt(0.1, steep) / weightAt(0.2, steep) - 16) < 1e-9)
})
