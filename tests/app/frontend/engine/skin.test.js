import assert from "node:assert/strict"
import {test} from "node:test"

import {
  Clip, skinArrays, skinned, skinVertex, transformed, withRows,
} from "../../../../app/frontend/engine/skin.js"

const moved = (x, y, z) => [1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z, 0, 0, 0, 1]
const quarterTurn = [0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]

test("points go where their joints take them, in parts", () => {
  const pose = Float32Array.from([...moved(2, 0, 0), ...quarterTurn])
  const skin = {joints: [0, 1, 0, 1, 0, 1], weights: [1, 0, 0, 1, 0.5, 0.5], count: 2}
  const rest = Float32Array.from([1, 0, 0, 1, 0, 0, 1, 0, 0])
  assert.deepEqual([...skinned(skin, rest, pose)], [3, 0, 0, 0, 1, 0, 1.5, 0.5, 0])
})

test("some points follow other joints, more of them than before", () => {
  const skin = {joints: Uint16Array.of(7, 8, 9), weights: Float32Array.of(1, 1, 1), count: 1}
  const rows = {joints: Uint16Array.of(1, 2), weights: Float32Array.of(0.25, 0.75), count: 2}
  const found = withRows(skin, [1], rows)
  assert.equal(found.count, 2)
  assert.deepEqual([...found.joints], [7, 0, 1, 2, 9, 0])
  assert.deepEqual([...found.weights], [1, 0, 0.25, 0.75, 1, 0])
  const narrow = {joints: Uint16Array.of(5), weights: Float32Array.of(1), count: 1}
  assert.deepEqual([...withRows(found, [1], narrow).joints], [7, 0, 5, 0, 9, 0])
  assert.deepEqual([...skin.joints], [7, 8, 9], "the one before is as it was")
})

test("points that nothing holds stay", () => {
  const skin = {joints: [0], weights: [0], count: 1}
  const found = skinned(skin, Float32Array.from([4, 5, 6]), Float32Array.from(moved(1, 1, 1)))
  assert.deepEqual([...found], [4, 5, 6])
})

test("a point on a joint goes with it, and stays at rest", () => {
  const pose = Float32Array.from([...moved(0, 0, 0), ...moved(1, 2, 3)])
  assert.deepEqual(transformed([1, 1, 1], pose, 1), [2, 3, 4])
  assert.deepEqual(transformed([1, 1, 1], null, 1), [1, 1, 1])
})

test("influences go to the card four at a time", () => {
  const skin = {joints: [0, 1, 2, 3, 4], weights: [0.1, 0.2, 0.3, 0.4, 0.5], count: 5}
  const arrays = Object.fromEntries(skinArrays("skin", skin))
  const names = ["skinJoints0", "skinWeights0", "skinJoints1", "skinWeights1"]
  assert.deepEqual(Object.keys(arrays), names)
  assert.deepEqual([...arrays.skinJoints1], [4, 0, 0, 0])
  assert.deepEqual([...arrays.skinWeights1], [0.5, 0, 0, 0])
  const {declared} = skinVertex(2, 0)
  for (const name of Object.keys(arrays)) { assert.ok(declared.includes(`${name}MC`), name) }
})

test("a clip is read between its frames, and begins again", () => {
  const matrices = Float32Array.from([...moved(0, 0, 0), ...moved(4, 0, 0), ...moved(0, 0, 0)])
  const clip = new Clip({times: Float64Array.from([0, 1, 2]), matrices})
  for (const [time, x] of [[0, 0], [0.25, 1], [1, 4], [1.5, 2], [2, 0], [2.25, 1], [0.5, 2]]) {
    assert.equal(clip.at(time)[3], x, `at ${time} s`)
  }
  assert.equal(clip.duration, 2)
})
