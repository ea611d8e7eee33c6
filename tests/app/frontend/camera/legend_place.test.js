import assert from "node:assert/strict"
import {test} from "node:test"

import {corners, freest, LegendPlace, meets} from "../../../../app/frontend/camera/legend_place.js"

const BOX = {left: 100, right: 900, top: 50, bottom: 650}
const HOME = {left: 116, right: 316, top: 574, bottom: 634, width: 200, height: 60}

test("all corners are as far from the edges", () => {
  assert.deepEqual(corners(HOME, BOX), {
    "bottom left": {left: 116, right: 316, top: 574, bottom: 634},
    "bottom right": {left: 684, right: 884, top: 574, bottom: 634},
    "top left": {left: 116, right: 316, top: 66, bottom: 126},
  })
})

test("it leaves its place for a far better one, and comes back when that is free", () => {
  assert.equal(freest([0, 0, 0], 1), 0)
  assert.equal(freest([10, 0, 3], 0), 1)
  assert.equal(freest([10, 6, 8], 0), 0)
  assert.equal(freest([10, 6, 2], 1), 2)
  assert.equal(freest([10, 6, 4], 1), 1)
  assert.equal(freest([5], 0), 0)
})

test("cards that touch do not meet", () => {
  assert.ok(!meets(HOME, {...HOME, left: 316, right: 400}))
  assert.ok(meets(HOME, {...HOME, left: 315, right: 400}))
})

function placed(points, cards = []) {
  const legend = {
    hidden: false, style: {}, getBoundingClientRect: () => {
      const [x, y] = place.shift
      const {left, right, top, bottom} = HOME
      return {left: left + x, right: right + x, top: top + y, bottom: bottom + y}
    },
  }
  const overlay = {
    legend, canvas: {getBoundingClientRect: () => BOX}, root: {querySelectorAll: () => []},
  }
  const renderer = {
    views: [1], projection: () => ([x, y]) => [x, y, 1],
    actors: new Map([["body", {visible: true, posed: () => points}]]),
  }
  const boxed = (box) => ({getBoundingClientRect: () => box})
  const place = new LegendPlace(overlay, renderer, () => cards.map(boxed))
  place.put()
  return {place, legend, renderer}
}

test("it goes where the body is not, and no card", () => {
  const behind = [50, 550, 0, 60, 560, 0]  // of the canvas: under the legend
  assert.equal(placed([400, 300, 0]).place.corner, "bottom left")
  const aside = placed(behind)
  assert.equal(aside.place.corner, "bottom right")
  assert.equal(aside.legend.style.transform, "translate(568px,0px)")
  aside.place.put()
  assert.deepEqual(aside.place.shift, [568, 0], "where it stands changes nothing")
  const card = {left: 800, right: 890, top: 500, bottom: 640, width: 90}
  assert.equal(placed(behind, [card]).place.corner, "top left")
  aside.renderer.actors.get("body").posed = () => [400, 300, 0]
  aside.place.put()
  assert.deepEqual([aside.place.corner, aside.legend.style.transform], ["bottom left", ""])
})
