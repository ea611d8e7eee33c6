import assert from "node:assert/strict"
import {test} from "node:test"

import {
  between, circle, corners, normalOf, PaintBrush,
} from "../../../../app/frontend/handles/brush.js"

const close = (a, b, more = 1e-9) => {
  assert.equal(a.length, b.length)
  a.forEach((x, i) => assert.ok(Math.abs(x - b[i]) < more, `${a} and ${b}`))
}
const POINTS = [0, 0, 0, 4, 0, 0, 0, 2, 0, 0, 0, 8]
const TRIANGLES = [3, 0, 1, 0, 1, 2]

test("a point of a triangle is what its corners count for", () => {
  const [a, b, c, ...shares] = corners(TRIANGLES, POINTS, 1, [1, 1, 0])
  assert.deepEqual([a, b, c], [0, 1, 2])
  close(shares, [0.25, 0.25, 0.5])
  close(corners(TRIANGLES, POINTS, 1, [4, 0, 0]).slice(3), [0, 1, 0])
  // Rounding leaves no point outside, and a triangle without any extent has a corner.
  for (const at of [[4 + 1e-7, -1e-7, 0], [-1e-7, 2, 0]]) {
    const found = corners(TRIANGLES, POINTS, 1, at).slice(3)
    assert.ok(found.every((share) => share >= 0 && share <= 1))
    close([found[0] + found[1] + found[2]], [1])
  }
  assert.deepEqual(corners([0, 0, 0], POINTS, 0, [0, 0, 0]), [0, 0, 0, 1, 0, 0])
})

test("the ring lies across the surface, as far around as the radius", () => {
  for (const normal of [[0, 1, 0], [0.36, 0.48, 0.8], normalOf(TRIANGLES, POINTS, 1)]) {
    for (const point of circle([1, 2, 3], normal, 0.5)) {
      const away = point.map((x, k) => x - [1, 2, 3][k])
      close([Math.hypot(...away), away.reduce((sum, x, k) => sum + x * normal[k], 0)], [0.5, 0])
    }
  }
  close(normalOf(TRIANGLES, POINTS, 1), [0, 0, 1])
})

test("a fast pointer leaves nothing out, and ends where it is", () => {
  const places = between([0, 0], [30, 40], 10)
  assert.equal(places.length, 5)
  close(places[0], [6, 8])
  close(places.at(-1), [30, 40])
  assert.deepEqual(between([1, 1], [1, 1], 10), [[1, 1]])
  assert.equal(between([0, 0], [1e6, 0], 1).length, 60)
})

const RENDERER = {
  project: ([x, y]) => [x, y, 1], projection: () => ([x, y]) => [x, y, 1], pixel: () => 1,
}

// A brush over a canvas whose left half shows a triangle that fills it.
function brush() {
  globalThis.document = {
    createElementNS: () => ({setAttribute() {}, append() {}, style: {}}),
  }
  const heard = {}
  const shown = []
  const canvas = {
    addEventListener: (type, act) => { heard[type] = act },
    getBoundingClientRect: () => ({left: 0, top: 0}), setPointerCapture() {}, focus() {},
  }
  const overlay = {canvas, root: {append() {}}, showPainting: (on) => shown.push(on), showBone() {}}
  const actor = {triangles: TRIANGLES, posed: () => POINTS, repaint: (what) => coloured.push(what)}
  const [told, handed, coloured] = [[], [], []]
  const made = new PaintBrush(overlay, RENDERER, {
    bodyAt: (x, y) => x < 100 ? {actor, triangle: 1, at: [x / 100, y / 100, 0]} : null,
    handOver: (...what) => handed.push(what), changed: () => { made.drawn += 1 },
    tell: (message) => told.push(message),
  })
  made.drawn = 0
  const send = (type, x, y, more) => {
    const e = {pointerId: 1, clientX: x, clientY: y, button: 0, buttons: 1, taken: false, ...more}
    Object.assign(e, {preventDefault() {}, stopImmediatePropagation() { e.taken = true }})
    heard[type](e)
    return e.taken
  }
  return {made, told, handed, coloured, actor, send, shown}
}

const ON = {radius: 12, mirror: null}

test("a stroke is told in pieces, one after the other, and ends", () => {
  const {made, told, coloured, actor, send, shown} = brush()
  assert.ok(!send("pointerdown", 10, 10), "without a brush the camera has the pointer")
  made.show(ON)
  assert.equal(shown.at(-1), true)
  assert.ok(send("pointerdown", 10, 10))
  const {first, done, mode, points} = told[0]
  assert.deepEqual([first, done, mode, points.length], [true, false, null, 6])
  assert.ok(send("pointermove", 40, 10))
  assert.ok(send("pointermove", 50, 10))
  assert.equal(told.length, 1, "the server has not answered")
  made.painted({vertices: [1], scalars: [0.5]}, actor)
  assert.equal(coloured.length, 1)
  const next = told[1]
  assert.deepEqual([next.first, next.points.length % 6], [false, 0])
  assert.ok(next.points.length > 30)
  send("pointermove", 60, 10)
  assert.ok(send("pointerup", 60, 10))
  assert.ok(told[2].done, "the end waits for no answer")
  assert.ok(told[2].points.length)
  assert.ok(!made.held)
  made.painted({vertices: [1], scalars: [0.6]}, actor)
  made.painted({vertices: [1], scalars: [0.6]}, actor)
  assert.equal(told.length, 3)
})

test("the scene is drawn again only when colours have come", () => {
  const {made, actor, send} = brush()
  made.show(ON)
  send("pointermove", 5, 10, {buttons: 0})
  send("pointerdown", 10, 10)
  send("pointermove", 40, 10)
  made.painted({}, actor)
  assert.equal(made.drawn, 0, "the ring is no part of it")
  made.painted({vertices: [1], scalars: [0.5]}, actor)
  assert.equal(made.drawn, 1)
})

test("beside the body, with other buttons and with Alt the camera has the pointer", () => {
  const {made, told, send} = brush()
  made.show(ON)
  assert.ok(!send("pointerdown", 150, 10))
  assert.ok(!send("pointerdown", 10, 10, {button: 2}))
  assert.ok(!send("pointerdown", 10, 10, {altKey: true}))
  assert.ok(!send("dblclick", 150, 10))
  assert.ok(send("dblclick", 10, 10), "two dabs are no wish to see the beginning")
  assert.deepEqual(told, [])
})

test("a key paints one point, where the cross is", () => {
  const {made, told} = brush()
  made.show(ON)
  made.dab([150, 10])
  assert.deepEqual(told, [])
  made.dab([10, 10])
  assert.deepEqual([told[0].first, told[0].done, told[0].points.length], [true, true, 6])
  assert.ok(!made.held)
})

test("Shift smooths, Ctrl takes away", () => {
  for (const [more, mode] of [[{shiftKey: true}, "smooth"], [{ctrlKey: true}, "subtract"]]) {
    const {made, told, send} = brush()
    made.show(ON)
    send("pointerdown", 10, 10, more)
    assert.equal(told[0].mode, mode)
  }
})

test("a second finger takes the stroke back, and both move the camera", () => {
  const {made, told, handed, send} = brush()
  made.show(ON)
  send("pointerdown", 10, 10)
  assert.ok(!send("pointerdown", 60, 60, {pointerId: 2}))
  assert.deepEqual(handed, [[1, [10, 10]]])
  assert.deepEqual(told.at(-1), {type: "paint", cancelled: true})
  assert.ok(!made.held)
  assert.ok(!send("pointermove", 20, 20), "and not the brush")
})

test("a stroke that the server does not know ends", () => {
  const {made, told, actor, send} = brush()
  made.show(ON)
  send("pointerdown", 10, 10)
  send("pointermove", 40, 10)
  made.painted({gone: true}, actor)
  assert.ok(!made.held)
  assert.equal(told.length, 1)
  made.show(null)
  assert.ok(!send("pointermove", 40, 10))
})
