import assert from "node:assert/strict"
import {test} from "node:test"

import {Orbit} from "../../../app/frontend/orbit.js"

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
    changed: act("changed"), rested: act("rested"), clicked: act("clicked"), hovered: act("hovered"),
  })
  return {made, heard, told}
}

const pointer = (x, y, more) => ({pointerId: 1, clientX: x, clientY: y, button: 0, buttons: 1, ...more})

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
