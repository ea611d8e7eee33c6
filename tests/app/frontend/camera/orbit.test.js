import assert from "node:assert/strict"
import {test} from "node:test"

import {Orbit} from "../../../../app/frontend/camera/orbit.js"

const close = (a, b) => a.forEach((x, i) => assert.ok(Math.abs(x - b[i]) < 1e-9, `${a} and ${b}`))

function orbit() {
  const heard = {}
  const told = []
  const element = {
    clientHeight: 500, addEventListener: (type, act) => { heard[type] = act },
    setPointerCapture: () => {},
  }
  const act = (name) => (e) => told.push([name, e])
  const made = new Orbit(element, {
    changed: act("changed"), rested: act("rested"),
    clicked: act("clicked"), hovered: act("hovered"),
  })
  return {made, heard, told}
}

const pointer = (x, y, more) =>
  ({pointerId: 1, clientX: x, clientY: y, button: 0, buttons: 1, ...more})

test("it looks from where it was told, and comes back", () => {
  const {made} = orbit()
  made.setHome([1, 2, 5], [0, 1, 0])
  close(made.position, [1, 2, 5])
  assert.ok(made.atHome)
  made.look([4, 1, 0], [0, 0, 0])
  close(made.position, [4, 1, 0])
  assert.ok(!made.atHome)
  made.reset()
  close(made.position, [1, 2, 5])
})

test("a drag turns about the target, at the same distance", () => {
  const {made, heard} = orbit()
  made.setHome([0, 0, 4], [0, 0, 0])
  heard.pointerdown(pointer(100, 100))
  heard.pointermove(pointer(160, 100))
  assert.ok(made.position[0] < 0)
  assert.ok(Math.abs(Math.hypot(...made.position) - 4) < 1e-9)
  assert.deepEqual(made.target, [0, 0, 0])
})

test("with Shift it moves what is seen along with the pointer", () => {
  const {made, heard} = orbit()
  made.setHome([0, 0, 4], [0, 0, 0])
  heard.pointerdown(pointer(100, 100))
  heard.pointermove(pointer(150, 100, {shiftKey: true}))
  assert.ok(made.target[0] < 0)
  close([made.target[1], made.target[2]], [0, 0])
})

test("a press that stays in its place is a click, one that moves is none", () => {
  const {heard, told} = orbit()
  const clicks = () => told.filter(([name]) => name === "clicked").length
  heard.pointerdown(pointer(100, 100))
  heard.pointerup(pointer(102, 101))
  assert.equal(clicks(), 1)
  heard.pointerdown(pointer(100, 100))
  heard.pointerup(pointer(140, 100))
  assert.equal(clicks(), 1)
})

test("nobody gets lost: neither too near nor too far, nor over the top", () => {
  const {made} = orbit()
  made.setHome([0, 0, 4], [0, 0, 0])
  made.zoom(1e9)
  assert.equal(made.distance, 24)
  made.zoom(1e-9)
  assert.ok(Math.abs(made.distance - 0.16) < 1e-12)
  made.turn(0, 99)
  assert.ok(made.pitch < Math.PI / 2)
})

test("while weights are painted the right button turns, with Shift it moves", () => {
  const {made, heard} = orbit()
  made.setHome([0, 0, 4], [0, 0, 0])
  made.painting = true
  const drag = (more) => {
    heard.pointerdown(pointer(100, 100, more))
    heard.pointermove(pointer(160, 100, more))
    heard.pointerup(pointer(160, 100, more))
  }
  drag({button: 2, buttons: 2})
  close(made.target, [0, 0, 0])
  assert.notEqual(made.yaw, made.home.yaw)
  const {yaw} = made
  drag({button: 2, buttons: 2, shiftKey: true})
  drag({button: 1, buttons: 4})
  assert.equal(made.yaw, yaw)
  assert.ok(Math.hypot(...made.target) > 0.1)
})

test("a pointer that joins moves and zooms with the next", () => {
  const {made, heard} = orbit()
  made.setHome([0, 0, 4], [0, 0, 0])
  made.join(1, [100, 100])
  heard.pointerdown(pointer(200, 100, {pointerId: 2}))
  heard.pointermove(pointer(300, 100, {pointerId: 2}))
  close([made.distance], [2])
})

test("zoom keeps what is under the pointer where it is", () => {
  const {made} = orbit()
  made.setHome([1, 2, 5], [0, 1, 0])
  // Where a point beside the target is seen, in pixels from the target.
  const seen = (place) => {
    const out = made.position.map((x, i) => (x - made.target[i]) / made.distance)
    const right = [Math.cos(made.yaw), 0, -Math.sin(made.yaw)]
    const up = [0, 1, 2].map((i) => {
      const [j, k] = [(i + 1) % 3, (i + 2) % 3]
      return out[j] * right[k] - out[k] * right[j]
    })
    const from = place.map((x, i) => x - made.target[i])
    const dot = (v) => v.reduce((sum, x, i) => sum + x * from[i], 0)
    const scale = 500 / (2 * made.distance * Math.tan(15 * Math.PI / 180))
    return [scale * dot(right), -scale * dot(up)]
  }
  const place = [0.3, 1, -0.3 * Math.tan(made.yaw)]
  const before = seen(place)
  made.zoom(0.5, before)
  const after = seen(place)
  assert.ok(Math.abs(after[0] - before[0]) < 1e-6 && Math.abs(after[1] - before[1]) < 1e-6)
  made.setHome([1, 2, 5], [0, 1, 0])
  made.zoom(0.5)
  close(made.target, [0, 1, 0])
})
