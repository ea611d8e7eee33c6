import assert from "node:assert/strict"
import {test} from "node:test"

import {Fit} from "../../../../app/frontend/camera/fit.js"
import {VIEW_ANGLE} from "../../../../app/frontend/camera/orbit.js"
import {bumpy} from "../engine/shapes.js"

const SLOPE = Math.tan(VIEW_ANGLE * Math.PI / 360)
const NOTHING = {left: 0, right: 0, top: 0, bottom: 0}

function fit(rest, width = 400, height = 400) {
  return new Fit({
    element: {clientHeight: height},
    tilesIn: () => [[0, 0, width, height]],
    taken: (insets) => insets,
    actors: new Map([
      ["body", {kind: "surface", rest}], ["marks", {kind: "lines", rest: [9, 9, 9]}],
    ]),
  })
}

test("all of the character is seen, and fills what there is", () => {
  const {points} = bumpy(30)
  for (const direction of [[0, 0, 1], [0.6, 0, 0.8], [0.36, 0.48, 0.8]]) {
    const one = fit(points)
    const distance = one.distance(direction, [0, 0, 0], NOTHING)
    let most = 0
    one.eachPoint(direction, [0, 0, 0], (aside, up, near) => {
      most = Math.max(most, Math.max(Math.abs(aside), Math.abs(up)) / (distance - near) / SLOPE)
    })
    assert.ok(most <= 1, `${most} of half the canvas`)
    assert.ok(most > 0.85, `${most} of half the canvas`)
  }
})

test("cards that take room send the eye farther away", () => {
  const {points} = bumpy(20)
  const away = (insets) => fit(points).distance([0, 0, 1], [0, 0, 0], insets)
  assert.ok(away({...NOTHING, right: 200}) > 1.5 * away(NOTHING))
  assert.ok(away({...NOTHING, top: 30, bottom: 30}) > away(NOTHING))
})

test("pixels are counted from the target, upwards", () => {
  const one = fit(Float32Array.from([1, 0, 0, 0, 1, 0]))
  const seen = []
  one.eachPixel([0, 0, 1], [0, 0, 0], 10, (aside, up) => seen.push([aside, up]))
  const pixels = 200 / SLOPE / 10
  assert.ok(Math.abs(seen[0][0] - pixels) < 1e-9 && Math.abs(seen[0][1]) < 1e-9)
  assert.ok(Math.abs(seen[1][1] - pixels) < 1e-9 && Math.abs(seen[1][0]) < 1e-9)
})
